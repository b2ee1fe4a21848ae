"""One clock for all channels of a test: where each begins, its steps, and what brings them together.

One rule. Each channel has a begin and times, of its own or of the test. Times may be rounded; where they are
uneven otherwise but no sample is missing, as of a clock that jitters, drifts or changes its rate, and where
channels have different clocks, all histories are interpolated at equal steps of the clock of the first. A gap
is refused, and so are channels that share less than nine tenths of their time.
"""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.significant_digits import significant
from reliab.core.stated_value import require_physical
from reliab.core.text_tables import missing_mark
from reliab.core.vocabulary import MILLI
from reliab.recordings.behaviour import Hold, find_hold
from reliab.recordings.naming import describe
from reliab.recordings.readers.columns import RATES, STEPS, Columns, plain, seconds_between
from reliab.recordings.recording import (
    DISPLACEMENTS,
    FEWEST_SAMPLES,
    LARGEST_READING,
    Channel,
    require_few_samples,
)
from reliab.recordings.words import TIMES, Measurand, Unit, unit_of, units_text

_FAULTY_SHARE: Final = (
    0.01  # share of unusual steps up to which they are faults, and not the rounding of the times
)
_GAP: Final = 0.5  # of a step, by which one that is such a fault differs from others
_MISSING: Final = 0.75  # of a step by which times jump where a sample is missing; a jitter of 0.45 does half
_LATE: Final = 1.35  # of the steps beside it, from which a step may hide a missing sample
_NEIGHBOURS: Final = 32  # samples on either side of which the clock is known, which makes 0.45 of jitter 0.5
_DIGITS: Final = 9
_ROUNDING: Final = 1e-9  # relative
_STEADY: Final = 0.05  # relative, up to which the rate of an uneven clock is one rate
_LARGEST_RATIO: Final = 20.0  # of two rates of one clock


@dataclass(frozen=True, kw_only=True, eq=False)
class Clock:
    """Times of a channel."""

    begin: float  # s, from the date `start` or another time that all channels of the test count from
    step: float  # s
    times: Array | None = None  # s, shape (n,), where they are not equally spaced
    start: np.datetime64 | None = None
    note: str = ""  # What is uneven about it, in a sentence

    def sample_times(self, size: int) -> Array:
        """Return the times of its samples [s]."""
        even = self.begin + self.step * np.arange(size, dtype=np.float64)
        return even if self.times is None else self.times

    def end(self, size: int) -> float:
        """Return the time of its last sample [s]."""
        return self.begin + self.step * (size - 1) if self.times is None else float(self.times[-1])

    def later(self, seconds: float) -> "Clock":
        """Return the clock that begins later."""
        times = None if self.times is None else self.times + seconds
        return replace(self, begin=self.begin + seconds, times=times)


def clock_of(columns: Columns, name: str, times: Array, factor: float) -> Clock:
    """Clock of times in a unit of `factor` [s]."""
    if times.size < FEWEST_SAMPLES:
        raise InputError(
            f"Only {times.size} samples; a test needs at least {FEWEST_SAMPLES}",
            remedy="Give the whole test",
            where=columns.location,
        )
    steps = np.diff(times)
    usual, mean = float(np.median(steps)), float((times[-1] - times[0]) / steps.size)
    odd = np.abs(steps - usual) > _EVEN * abs(usual)
    gaps = np.abs(steps - usual) > _GAP * abs(usual)
    if mean <= 0.0 or (gaps.any() and odd.mean() <= _FAULTY_SHARE):
        raise _no_equal_steps(columns, name, times, int(np.argmax(gaps) if gaps.any() else np.argmin(steps)))
    require_physical("time step", factor * mean, where=columns.location)
    latest = _latest(times)
    if latest <= max(_EVEN * mean, 1.01 * _rounding(times)):
        return Clock(begin=factor * float(times[0]), step=_round_rate(factor * mean))
    if (row := _first_jump(times)) is not None:
        raise _no_equal_steps(columns, name, times, row)
    return _uneven(columns, factor * times, latest / mean)


def _no_equal_steps(columns: Columns, name: str, times: Array, row: int) -> InputError:
    """Say where times are not evenly spaced, `row` before the sample that is early or late."""
    step = float(times[row + 1] - times[row])
    if step == 0.0:
        remedy = "Remove rows that repeat the time of the row before"
    elif step < 0.0:
        remedy = "Cut the file where the time goes back; another test may begin there"
    else:
        remedy = "Resample the test, or cut it where samples are missing"
    return InputError(
        f"The times do not increase by equal steps, here mostly of {np.median(np.diff(times)):.6g}",
        value=f"{times[row + 1]:.10g} after {times[row]:.10g}",
        remedy=remedy,
        where=columns.place(row + 1, name),
    )


def _first_jump(times: Array) -> int | None:
    """Find the sample after which one is missing, or times stand or go back; None where there is none.

    Lines through the samples before and after a step meet halfway, unless a sample is missing between them.
    """
    steps = np.diff(times)
    jumps = steps <= 0.0
    for reach in (_NEIGHBOURS // 2, _NEIGHBOURS):
        level, rise = _lines(times, reach)
        level_before, level_after = level + 0.5 * reach * rise, level - 0.5 * reach * rise
        size = np.maximum(rise[:-reach], rise[reach:])
        inner = slice(reach - 1, times.size - reach)
        level_change = level_after[reach:] - level_before[:-reach]
        jumps[inner] |= (level_change > _MISSING * size) & (steps[inner] > _LATE * size)
    return int(np.argmax(jumps)) if jumps.any() else None


def _lines(times: Array, reach: int) -> tuple[Array, Array]:
    """Fit lines to each `reach` times in a row: values at the middle and rises, shape (n - reach + 1,)."""
    mean = (times[-1] - times[0]) / (times.size - 1)
    even = times[0] + mean * np.arange(times.size)
    place = np.arange(reach) - 0.5 * (reach - 1)
    level = np.convolve(times - even, np.full(reach, 1.0 / reach), "valid")
    rise = np.convolve(times - even, place[::-1], "valid") / (place @ place)
    return level + even[: level.size] + mean * 0.5 * (reach - 1), rise + mean


def _uneven(columns: Columns, times: Array, off: float) -> Clock:
    """Clock of times [s] that jitter, drift or change their rate, by up to `off` steps."""
    rises = _lines(times, _NEIGHBOURS)[1]
    shortest, longest = float(rises.min()), float(rises.max())
    mean = float(times[-1] - times[0]) / (times.size - 1)
    if longest > _LARGEST_RATIO * shortest:
        raise InputError(
            f"The steps between samples range from {significant(shortest)} to {significant(longest)} s, "
            f"by more than a factor of {_LARGEST_RATIO:g}",
            remedy="Resample the test, or cut it where the rate changes",
            where=columns.location,
        )
    changes = longest > (1.0 + 2.0 * _STEADY) * shortest
    step = _round_rate(shortest) if changes else mean
    if changes:
        description = f"The step between samples changes between {shortest:.4g} and {longest:.4g} s"
    elif off > 1.0:
        description = f"The clock drifts by up to {significant(off)} steps"
    else:
        description = f"The clock jitters by up to {significant(off, 2)} of a step"
    note = f"{description}; the channels were interpolated at equal steps of {step:.6g} s."
    return Clock(begin=float(times[0]), step=step, times=times, note=note)


def _round_rate(step: float) -> float:
    """Step [s], without the rounding of the times where it is that of a whole number of hertz."""
    rate = round(1.0 / step)
    return 1.0 / rate if rate > 0 and abs(rate * step - 1.0) < _ROUNDING else step


def _latest(times: Array) -> float:
    """Largest distance of a time from the even clock that is nearest to all."""
    count = np.arange(times.size) - (times.size - 1) / 2.0
    late = times - times.mean()
    return float(np.abs(late - count * (count @ late) / (count @ count)).max())


def _rounding(times: Array) -> float:
    """One unit in the last decimal that the times have, or of their last binary digit."""
    largest = float(np.abs(times).max())
    for digits in range(_DIGITS + 1):
        if np.abs(times - times.round(digits)).max() <= 1e-12 * max(largest, 1.0):
            return float(10.0**-digits)
    return float(np.spacing(largest))


_EVEN: Final = 0.01  # relative, by which rates may differ and still be one
_LEAST_SHARED: Final = 0.9
_CLOCK_TOLERANCE: Final = 1e-3  # of a step, by which clocks may differ and still be one
_SHORTEST_TEST: Final = 0.25  # s, below which times without a unit may be in minutes, hours or days
_FASTEST: Final = 2e-5  # s, the same of a step
_STATED_UNIT: Final = re.compile(  # behind a name, of times, that no program here knows
    r"[\[(]\s*((?:[\d.e+*/x ^-]|[muµn]|milli|micro|nano|hundredths of )*"
    r"(?:s|secs?|sek|seconds?|ticks?|samples?|counts?|frames?|millis|micros))\s*[\])]\s*$",
    re.IGNORECASE,
)
_SLOWEST: Final = 0.5  # s, from which a step without a unit may be one of milliseconds or samples


@dataclass(frozen=True, kw_only=True, eq=False)
class AlignedHistories:
    """Histories of a test at one clock."""

    values: Mapping[str, Array]  # As read, by the keys of the channels, shape (n,)
    step: float  # s
    corrections: Mapping[str, tuple[str, ...]]  # What was done to each, in words
    notes: tuple[str, ...]  # What was done to all of them, in sentences
    has_rows: bool  # Whether the samples are the rows of the file


def pair_times(columns: Columns) -> Columns:
    """Give channels the times that stand beside each, where there are several columns of them.

    A column of times is that of the columns behind it, up to the next, where all bear one name; else that of
    the channels with the role in its name, where there are several roles.
    """
    meanings = describe(list(columns.series), columns.units)
    times = [name for name, meaning in meanings.items() if meaning.quantity is Measurand.TIME]
    time_of_role = {meanings[name].role: name for name in times if meanings[name].role is not None}
    owners: dict[str, str] = {}
    if len(times) > 1 and len({re.sub(r"[\W_]*\d*\W*$", "", name) for name in times}) == 1:
        for name in meanings:
            owners[name] = name if name in times else next(reversed(owners.values()), "")
    elif len(time_of_role) > 1:
        owners = {name: time_of_role.get(meaning.role, "") for name, meaning in meanings.items()}
    series = dict(columns.series)
    for name, owner in owners.items():
        if owner and name not in times and series[name].times is None:
            clock, unit = columns.series[owner], meanings[owner].unit
            text = unit.text if unit else ""
            series[name] = replace(series[name], times=clock.values, times_unit=text, start=clock.start)
    return replace(columns, series=series)


def align_clocks(
    columns: Columns,
    channels: Mapping[str, Channel],
    *,
    rate_hz: float | None,
    time_units: str | None,
) -> AlignedHistories:
    """Bring the channels of a test to the clock of the first one."""
    time = channels.get("time")
    values = {
        key: _readings(columns, channel.column, columns.values[channel.column])
        for key, channel in channels.items()
        if channel is not time
    }
    shared = _shared_clock(columns, time, rate_hz, time_units)
    size = next(iter(values.values())).size if time is None else columns.values[time.column].size
    clocks = _from_one_date(
        columns,
        {key: _clock_of(columns, channels[key].column, shared, size, time_units) for key in values},
        channels,
    )
    lead = next(iter(clocks))
    if rate_hz is not None and abs(clocks[lead].step * rate_hz - 1.0) > _EVEN:
        raise InputError(
            f"The times show {1.0 / clocks[lead].step:.6g} Hz, but the sampling rate is {rate_hz:g} Hz",
            remedy="Correct `rate`, or say with `time_units` in what unit the times are",
            where=columns.location,
        )
    return _interpolate(columns, channels, values, clocks)


def _readings(columns: Columns, name: str, values: Array) -> Array:
    """Take the samples or the times of a column, all of which must be finite numbers."""
    wrong = np.flatnonzero(~(np.abs(values) < LARGEST_READING))
    mark = None if wrong.size else missing_mark(values)
    if mark is not None:
        wrong = np.flatnonzero(values == mark)
    if wrong.size:
        first = values[wrong[0]]
        kind = "an empty cell, NaN or a sample marked as missing" if np.isnan(first) else first
        kind = kind if mark is None else f"{mark:g}, which marks missing samples"
        raise InputError(
            f"Not a finite number below {LARGEST_READING:g}",
            value=f"{kind}, {wrong.size} in all",
            remedy="Fill the gap, or cut the test there",
            where=columns.place(int(wrong[0]), name),
        )
    return values


def _from_one_date(
    columns: Columns, clocks: Mapping[str, Clock], channels: Mapping[str, Channel]
) -> dict[str, Clock]:
    """Count the times of all channels from the earliest date that one of them states."""
    dates = {key: clock for key, clock in clocks.items() if clock.start is not None}
    if not dates:
        return dict(clocks)
    if bare := [key for key in clocks if key not in dates]:
        raise InputError(
            f"{channels[next(iter(dates))].column!r} states when it begins, but "
            f"{channels[bare[0]].column!r} does not",
            remedy="Export them with one clock, or from the program that recorded both",
            where=columns.location,
        )
    first = min(clock.start for clock in dates.values() if clock.start is not None)
    return {key: clock.later(seconds_between(first, clock.start or first)) for key, clock in dates.items()}


def _interpolate(
    columns: Columns,
    channels: Mapping[str, Channel],
    values: Mapping[str, Array],
    clocks: Mapping[str, Clock],
) -> AlignedHistories:
    """Histories at equal steps of the first clock; those that have it are only cut."""
    first = next(iter(clocks))
    lead, size = clocks[first], values[first].size
    place, count = _common(columns, values, clocks)
    instants = lead.begin + lead.step * np.arange(place, place + count)
    histories, corrections = {}, {}
    for key, clock in clocks.items():
        hold = find_hold(values[key], clock.step) if channels[key].part in DISPLACEMENTS else None
        shift = (clock.begin - lead.begin) / lead.step
        is_cut = (
            hold is None and _is_parallel(clock, lead, size) and abs(shift - round(shift)) < _CLOCK_TOLERANCE
        )
        if is_cut:
            begin = place - round(shift)
            histories[key] = values[key][begin : begin + count]
        else:
            from reliab.signals.cubic_path import CubicPath

            nodes, samples = clock.sample_times(values[key].size), values[key]
            clipped_instants = np.clip(instants, nodes[0], nodes[-1])
            if hold is not None:
                nodes, samples = (nodes[hold.places] - hold.lateness * clock.step, samples[hold.places])
            histories[key] = CubicPath.interpolate(nodes, samples)(clipped_instants)
        has_own_clock = not is_cut and (lead.times is None or clock.times is not lead.times)
        corrections[key] = tuple(
            _describe_changes(clock, lead, hold, channels[first].column, is_interpolated=has_own_clock)
        )
    return AlignedHistories(
        values=histories,
        step=lead.step,
        corrections=corrections,
        notes=(lead.note,) if lead.note else (),
        has_rows=lead.times is None and (place, count) == (0, size),
    )


def _is_parallel(clock: Clock, lead: Clock, size: int) -> bool:
    """Whether two clocks have equal steps over a test, of which only the begins may differ."""
    even = clock.times is None and lead.times is None
    return even and abs(clock.step / lead.step - 1.0) * size < _CLOCK_TOLERANCE


def _describe_changes(
    clock: Clock, lead: Clock, hold: Hold | None, first: str, *, is_interpolated: bool
) -> Iterator[str]:
    """Say what was done to a channel to bring it to the clock of the first one, if it has another."""
    late = clock.begin - lead.begin
    if abs(late) > _CLOCK_TOLERANCE * lead.step:
        yield f"begins {significant(MILLI * abs(late), 5)} ms {'after' if late > 0.0 else 'before'} {first!r}"
    if hold is not None:
        yield f"interpolated, since it holds each value for {significant(hold.length)} samples"
    if abs(clock.step / lead.step - 1.0) > _EVEN:
        rates = 1.0 / clock.step, 1.0 / lead.step
        yield f"recorded at {rates[0]:.5g} Hz and interpolated at the {rates[1]:.5g} Hz of {first!r}"
    elif is_interpolated and hold is None:
        yield f"interpolated at the samples of {first!r}"


def _common(columns: Columns, values: Mapping[str, Array], clocks: Mapping[str, Clock]) -> tuple[int, int]:
    """First equal step of the leading clock that all channels have, and the number of those."""
    lead = next(iter(clocks.values()))
    ends = {key: (clock.begin, clock.end(values[key].size)) for key, clock in clocks.items()}
    begin, end = max(begin for begin, _ in ends.values()), min(end for _, end in ends.values())
    place = max(int(np.ceil((begin - lead.begin) / lead.step - _CLOCK_TOLERANCE)), 0)
    count = int(np.floor((end - lead.begin) / lead.step + _CLOCK_TOLERANCE)) - place + 1
    overlap = next(iter(ends.values()))
    size = int(np.floor((overlap[1] - overlap[0]) / lead.step + _CLOCK_TOLERANCE)) + 1
    if count < _LEAST_SHARED * size:
        raise InputError(
            f"The channels were not recorded at the same time: {max(count, 0)} of {size} samples in common",
            remedy="Cut the channels to the same time, or name those of one test",
            where=columns.location,
        )
    require_few_samples(count, columns.location)
    return place, count


def _clock_of(columns: Columns, name: str, shared: Clock | None, size: int, time_units: str | None) -> Clock:
    """Clock of a column: its own times, else those of the test."""
    series = columns.series[name]
    if series.times is not None:
        unit = _time_unit(columns, time_units or series.times_unit)
        times = _readings(columns, name, series.times)
        clock = clock_of(columns, name, times, 1.0 if unit is None else unit.factor)
        _require_unit(columns, name, clock, times.size, unit)
        return replace(clock, start=series.start)
    if series.values.size != size:
        raise InputError(
            f"Channels without times differ in length: {series.values.size} samples of {name!r} "
            f"and {size} of others",
            remedy="Export all channels at one rate, or with their times",
            where=columns.location,
        )
    if shared is not None:
        return shared if series.start is None else replace(shared, start=series.start)
    if not (step := _header_step(columns)):
        raise InputError(
            "No times and no sampling rate in the file",
            remedy="Name the column of times with `time`, or give the sampling rate with `rate`. "
            f"Columns in the file: {columns.names_text}",
            where=columns.location,
        )
    require_physical("time step", step, where=columns.location)
    if step >= _SLOWEST:
        raise InputError(
            f"The file states a sampling rate of {1.0 / step:.6g} Hz, which no test has",
            remedy="Give the rate with `rate`",
            where=columns.location,
        )
    return Clock(begin=0.0, step=step)


def _shared_clock(
    columns: Columns, time: Channel | None, rate_hz: float | None, time_units: str | None
) -> Clock | None:
    """Clock of all channels without their own: a column of times, else the rate that the user states."""
    if time is None:
        if rate_hz is not None:
            require_physical("time step", 1.0 / rate_hz, where=columns.location)
        return None if rate_hz is None else Clock(begin=0.0, step=1.0 / rate_hz)
    unit, file_unit = _time_unit(columns, time_units or time.unit), _time_unit(columns, time.unit)
    factor = time.factor
    if time_units is not None and unit is not None:
        factor *= unit.factor / (1.0 if file_unit is None else file_unit.factor)
    times = _readings(columns, time.column, columns.values[time.column])
    clock = clock_of(columns, time.column, times, factor)
    if rate_hz is None:
        _require_unit(columns, time.column, clock, times.size, unit)
    return replace(clock, start=columns.series[time.column].start)


def _time_unit(columns: Columns, text: str) -> Unit | None:
    """Read a unit of time; None where nothing states one."""
    unit = unit_of(text)
    if text and (unit is None or unit.quantity is not Measurand.TIME):
        raise InputError(
            f"Unknown unit of time: {text!r}",
            remedy=f"Choose among {units_text(TIMES)}, or export the channels over time",
            where=columns.location,
        )
    return unit


def _require_unit(columns: Columns, name: str, clock: Clock, size: int, unit: Unit | None) -> None:
    """Ask for a unit where a test in seconds would be shorter or slower than any."""
    stated_unit = _STATED_UNIT.search(name)
    if unit is None and stated_unit is not None:
        raise InputError(
            f"Unknown unit of the times: {stated_unit[1]}",
            remedy=f"State it with `time_units`: {units_text(TIMES)}",
            where=columns.location,
        )
    if unit is None and not (_FASTEST <= clock.step < _SLOWEST and clock.step * size >= _SHORTEST_TEST):
        raise InputError(
            f"{name!r} has steps of {clock.step:.6g} without a unit: hardly seconds",
            remedy="State the unit with `time_units`, such as ms or d, or give the sampling rate with `rate`",
            where=columns.location,
        )


def _header_step(columns: Columns) -> float:
    """Step [s] that the file states beside its columns; 0 where it states none."""
    for names, invert in ((STEPS, False), (RATES, True)):
        for name, value in columns.scalars.items():
            if plain(name.rpartition(".")[2]) in names and value > 0.0:
                return 1.0 / value if invert else value
    return 0.0
