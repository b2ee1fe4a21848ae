"""Rows of a test that is followed, as a monitor takes them: at equal steps, without skew, about zero."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from itertools import chain
from typing import Any, Final

import numpy as np

from reliab.core.arrays import Array
from reliab.core.errors import InputError, naming
from reliab.core.significant_digits import counted, significant
from reliab.core.stated_value import require_physical
from reliab.core.vocabulary import MILLI
from reliab.recordings.behaviour import extent_of_test, find_hold, zero_of
from reliab.recordings.following import Rows
from reliab.recordings.recording import DISPLACEMENTS

_ROWS_FOR_STEP = 64
_GAP = 0.6  # of a step that a sample may come late or early after the one before
_LOOK: Final = 1 << 13  # rows in which a channel of a slower clock is looked for
_WHOLE_RATE = 1e-4  # relative distance up to which a rate is a whole number of hertz
_SHARED = 0.5  # of another zero: distance between the means of two channels that share it
_LONGEST_BUFFER: Final = 1 << 14  # samples of a test that is followed, by which its zero is told


def rows_without_skew(rows: Iterator[Rows], samples: float) -> Iterator[Rows]:
    """Take a skew off, positive where the measured displacement was recorded later [samples].

    Commands wait for the reading that belongs to them, which is a cubic through the four next samples; the
    last commands, whose reading never comes, are left out. Before its first sample a reading stands still.

    >>> time = np.arange(9.0)
    >>> late = Rows(time=time, command=time**2, measured=(time - 1.5) ** 2)
    >>> (moved,) = rows_without_skew(iter([late]), 1.5)
    >>> moved.measured.tolist() == moved.command.tolist() == [0.0, 1.0, 4.0, 9.0, 16.0, 25.0]
    True
    """
    ahead = int(np.floor(samples))
    weights = _cubic(samples - ahead)
    first = 1 - ahead  # sample of the command whose cubic begins with the first reading
    waiting: Rows | None = None
    read = np.empty(0)
    for part in rows:
        if waiting is None:
            read = np.repeat(part.measured[..., :1], max(first, 0), axis=-1)
        read = np.concatenate([read, part.measured], axis=-1)
        waiting = part if waiting is None else _join(waiting, part)
        if first < 0:
            lost_samples = min(-first, read.shape[-1])
            read, first = read[..., lost_samples:], first + lost_samples
        ready = min(read.shape[-1] - weights.size + 1, waiting.command.shape[-1]) if first >= 0 else 0
        if ready > 0:
            nodes = np.lib.stride_tricks.sliding_window_view(read, weights.size, axis=-1)
            shifted_rows = nodes[..., :ready, :] @ weights
            yield replace(waiting.part(slice(ready)), measured=shifted_rows)
            waiting, read = waiting.part(slice(ready, None)), read[..., ready:]


def _cubic(place: float) -> Array:
    """Weights of samples at −1, 0, 1 and 2 for a cubic at a place between 0 and 1 (Lagrange)."""
    nodes = np.array([-1.0, 0.0, 1.0, 2.0])
    other_nodes = [np.delete(nodes, k) for k in range(nodes.size)]
    return np.array([np.prod((place - o) / (node - o)) for node, o in zip(nodes, other_nodes, strict=True)])


def _join(first: Rows, second: Rows) -> Rows:
    def follow(name: str) -> Any:  # noqa: ANN401 - arrays, or none
        pair = getattr(first, name), getattr(second, name)
        return None if pair[0] is None or pair[1] is None else np.concatenate(pair, axis=-1)

    names = ("time", "command", "measured", "force", "ground", "lines")
    return replace(second, **{name: follow(name) for name in names})


def step_of_rows(rows: Iterator[Rows], rate: float | None) -> tuple[float, Iterator[Rows]]:
    """Step between samples, from the rate or the first times.

    `rate` [Hz]; returns step [s].
    """
    if rate is not None:
        return 1.0 / rate, rows
    first: list[Rows] = []
    count = 0
    for part in rows:
        first.append(part)
        count += part.command.shape[-1]
        if count > _ROWS_FOR_STEP:
            break
    name = first[0].name if first else ""
    if any(part.time is None for part in first):
        raise InputError(
            "No times and no sampling rate",
            remedy="Add a column time, or give the sampling rate with `rate`",
            where=name,
        )
    if count <= _ROWS_FOR_STEP:
        raise InputError(
            f"Only {counted(count, 'row')} so far; more than {_ROWS_FOR_STEP} are needed",
            remedy="Wait until the test runs, or wait longer with `wait`",
            where=name,
        )
    times = np.concatenate([part.time for part in first if part.time is not None])
    step = float(times[-1] - times[0]) / (times.size - 1)
    if not step > 0.0:
        raise InputError(
            "The times do not increase",
            value=f"{times[-1]:g} s after {times[0]:g} s",
            remedy="Check the column of the times",
            where=first[-1].place(-1),
        )
    require_physical("time step", step, where=name)
    whole_rate = round(1.0 / step)
    if whole_rate > 0 and abs(whole_rate * step - 1.0) < _WHOLE_RATE:
        step = 1.0 / whole_rate
    return step, chain(first, rows)


def rows_at_equal_steps(rows: Iterator[Rows], step: float) -> Iterator[Rows]:
    """Pass rows on while their times follow at equal steps, and each is a new sample.

    A time may come 0.6 of a step early or late after the one before it, which rounded times do; a missing
    sample does more.

    `step` [s].
    """
    begin: float | None = None
    count, drift = 0, 0.0
    recent, since = np.empty((2, 0)), 0
    for part in rows:
        if part.time is not None:
            begin = float(part.time[0]) if begin is None else begin
            due = begin + step * np.arange(count, count + part.time.size)
            # what a clock may drift from the nominal rate counts as no gap; a missing sample does
            late = part.time - due
            gap = np.flatnonzero(
                np.abs(np.diff(late, prepend=late[0] if count == 0 else drift)) > _GAP * step
            )
            if gap.size:
                row = int(gap[0])
                raise InputError(
                    f"The steps are not equal: sample {count + row + 1} is at {part.time[row]:.10g} s, at "
                    f"steps of {step:.6g} s",
                    remedy="Judge the test in pieces afterwards: a test that is followed needs equal steps",
                    where=part.place(row),
                )
            drift = float(late[-1])
        count += part.command.shape[-1]
        displacements = np.stack([np.atleast_2d(rows)[0] for rows in (part.command, part.measured)])
        recent, since = (
            np.concatenate([recent, displacements], axis=1)[:, -_LOOK:],
            since + displacements.shape[1],
        )
        if since >= _LOOK // 8:
            _require_new_samples(recent, step, part.place(-1))
            since = 0
        yield part


def _require_new_samples(recent: Array, step: float, location: str) -> None:
    """Refuse channels of a slower clock, whose values stand for several rows; `recent` of shape (2, n)."""
    for part, values in zip(DISPLACEMENTS, recent, strict=True):
        hold = find_hold(values, step)
        if hold is not None:
            raise InputError(
                f"The {part} displacement holds each value for {significant(hold.length)} rows",
                remedy="Write a row for each new value, or judge the test afterwards, when it can be "
                "interpolated",
                where=location,
            )


def rows_about_zero(rows: Iterable[Rows], time_step: float) -> Iterator[Rows]:
    """Pass rows on; refuse them at their end where both channels oscillated about another value than zero.

    A loop that felt an offset of its sensor from before the first row moves the command alone. `time_step`
    [s].
    """
    buffers: list[tuple[_Decimator, _Decimator]] = []
    name = ""
    for part in rows:
        name = part.name
        channels = np.stack([np.atleast_2d(part.command), np.atleast_2d(part.measured)], axis=1)
        buffers = buffers or [(_Decimator(), _Decimator()) for _ in channels]
        for pair, histories in zip(buffers, channels, strict=True):
            for decimator, history in zip(pair, histories, strict=True):
                decimator.add(history)
        yield part
    for command_buffer, measured_buffer in buffers:
        command, reading = (np.array(buffer.samples) for buffer in (command_buffer, measured_buffer))
        with naming(name):
            _require_rest_at_zero(command, reading, time_step * command_buffer.every)


def _require_rest_at_zero(command: Array, measured_displacement: Array, time_step: float) -> None:
    """Refuse histories about another value than zero, and a move before or after a test."""
    begin, end = extent_of_test(command, time_step)
    zero = zero_of(command[begin:end])
    if end - begin < command.size:
        value = (
            f"a command that also moves by {significant(MILLI * _length_of_moves(command, begin, end))} mm"
        )
        remedy = (
            "Write the rows of the test only, from where the command stands before it, and follow it again"
        )
    elif zero and abs(float(measured_displacement.mean() - command.mean())) < _SHARED * abs(zero):
        value = f"a command that oscillates about {significant(MILLI * zero)} mm"
        remedy = (
            "State the reading of both channels at rest, as `zero` of a file `channels`, and follow it again"
        )
    else:
        return
    raise InputError(
        f"The channels do not count from the rest position, so that the error would seem too small: {value}",
        remedy=f"{remedy}; `reliab assess` finds it by itself",
    )


def _length_of_moves(command: Array, begin: int, end: int) -> float:
    """Largest distance of the position before or after a test from the first or last sample."""
    return float(max(abs(command[begin] - command[0]), abs(command[-1] - command[end - 1])))


@dataclass(kw_only=True)
class _Decimator:
    """Every so many samples of a history that grows."""

    every: int = 1
    seen: int = 0
    samples: list[float] = field(default_factory=list)

    def add(self, history: Array) -> None:
        """Take further samples, shape (n,)."""
        self.samples += history[-self.seen % self.every :: self.every].tolist()
        self.seen += history.size
        while len(self.samples) > _LONGEST_BUFFER:
            self.samples, self.every = self.samples[::2], 2 * self.every
