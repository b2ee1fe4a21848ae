"""The step between the rows of a test that is still written, and whether they follow at it."""

from collections.abc import Iterator
from itertools import chain

import numpy as np

from reliab.errors import InputError
from reliab.recordings.following import Rows

_ROWS_FOR_STEP = 64
_GAP = 0.6  # of a step that a sample may come late or early after the one before
_WHOLE_RATE = 1e-4  # relative distance up to which a rate is a whole number of hertz


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
    if any(part.time is None for part in first):
        raise InputError(
            "A test that is followed needs times or a sampling rate",
            remedy="Add a column time, or give the sampling rate with `rate`",
        )
    if count <= _ROWS_FOR_STEP:
        raise InputError(
            f"A test that is followed needs more than {_ROWS_FOR_STEP} rows",
            value=count,
            remedy="Wait until the test runs, or wait longer with `wait`",
        )
    times = np.concatenate([part.time for part in first if part.time is not None])
    step = float(times[-1] - times[0]) / (times.size - 1)
    if not step > 0.0:
        raise InputError("Times must grow", value=f"{times[-1]:g} s after {times[0]:g} s")
    whole = round(1.0 / step)
    if whole > 0 and abs(whole * step - 1.0) < _WHOLE_RATE:
        step = 1.0 / whole
    return step, chain(first, rows)


def rows_at_equal_steps(rows: Iterator[Rows], step: float) -> Iterator[Rows]:
    """Pass rows on while their times, where there are any, follow at equal steps.

    A time may come 0.6 of a step early or late after the one before it, which rounded times do; a missing
    sample does more.

    `step` [s].
    """
    begin: float | None = None
    count, drift = 0, 0.0
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
                    f"Samples must follow each other at equal steps, here of {step:.6g} s",
                    value=f"{part.time[row]:.10g} s for sample {count + row + 1}",
                    remedy="A test with missing samples cannot be followed; assess it in pieces afterwards",
                )
            drift = float(late[-1])
        count += part.command.shape[-1]
        yield part
