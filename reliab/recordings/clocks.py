"""One clock for all channels of a test: the step between samples, and what happens where clocks differ.

One rule. Times may be rounded, and may be off equal steps by half a step, as those of a jittering clock are:
then the histories are interpolated at equal steps. A channel of another rate is interpolated at the times of
the command. A longer gap is refused, and so are channels that share less than nine tenths of their time.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from reliab.arrays import Array
from reliab.errors import InputError
from reliab.recordings.readers import Columns
from reliab.recordings.recording import FEWEST_SAMPLES, LARGEST_READING, Channel
from reliab.recordings.units import TIMES, unit_of
from reliab.recordings.words import Quantity
from reliab.signals import CubicPath
from reliab.significant import significant

_JITTER: Final = 0.01  # share of a step by which a time may be off and still count as equal
_LARGEST_JITTER: Final = 0.5
_FEW: Final = 0.01  # share of unusual steps up to which they are faults, and not the rounding of the times
_LEAST_SHARED: Final = 0.9
_DIGITS: Final = 9
_ROUNDED: Final = 1e-9  # relative
_LARGEST_RATIO: Final = 20.0  # of two rates
_SLOWEST: Final = 0.5  # s, from which a step without a unit may be one of milliseconds or samples
_STEP_NAMES: Final = ("dt", "timestep", "timesteps", "step", "samplingperiod", "sampleperiod", "ts", "deltat")
_RATE_NAMES: Final = (
    *("rate", "ratehz", "fs", "samplingrate", "samplerate"),
    *("samplingratehz", "samplingfrequency", "sampleratehz"),
)


@dataclass(frozen=True, kw_only=True, eq=False)
class Clock:
    """Times of a channel."""

    begin: float  # s
    step: float  # s
    times: Array | None  # s, shape (n,), where they are not equally spaced

    def at(self, size: int) -> Array:
        """Return the times of its samples [s]."""
        even = self.begin + self.step * np.arange(size, dtype=np.float64)
        return even if self.times is None else self.times


def finite(columns: Columns, name: str) -> Array:
    """Take the samples of a column, all of which must be finite numbers."""
    return _readings(columns, name, columns.values[name])


def _readings(columns: Columns, name: str, values: Array) -> Array:
    wrong = np.flatnonzero(~(np.abs(values) < LARGEST_READING))
    if wrong.size:
        first = values[wrong[0]]
        raise InputError(
            f"Every value must be a finite number below {LARGEST_READING:g}",
            value=f"{'an empty cell or NaN' if np.isnan(first) else first}, {wrong.size} in all",
            remedy="Repair the recording; a gap cannot be left empty",
            where=columns.place(int(wrong[0]), name),
        )
    return values


def at_one_clock(
    columns: Columns,
    channels: Mapping[str, Channel],
    *,
    rate_hz: float | None,
    time_units: str | None,
) -> tuple[dict[str, Array], float, list[str]]:
    """Bring the channels of a test to the clock of the first one.

    Returns histories as read, by the keys of `channels`, shape (n,); step [s]; what was done, in sentences.
    """
    time = channels.get("time")
    histories = {
        key: finite(columns, channel.column) for key, channel in channels.items() if channel is not time
    }
    first = next(iter(histories))
    size = (histories[first] if time is None else columns.values[time.column]).size
    shared = (
        None if rate_hz is not None and time is None else _shared_clock(columns, time, rate_hz, time_units)
    )
    clocks = {key: _clock_of(columns, channels[key].column, shared, size, rate_hz) for key in histories}
    lead, notes = clocks[first], []
    if lead.times is not None:
        notes.append(
            f"The clock jitters by up to {significant(_jitter(lead.times, lead.step), 2)} of a step; the "
            f"channels were interpolated at equal steps of {lead.step:.6g} s."
        )
    return _interpolated(columns, channels, histories, clocks, notes), lead.step, notes


def _interpolated(
    columns: Columns,
    channels: Mapping[str, Channel],
    read: Mapping[str, Array],
    clocks: Mapping[str, Clock],
    notes: list[str],
) -> dict[str, Array]:
    """Histories at the times of the first one; those that have its clock are only cut."""
    histories, first = dict(read), next(iter(read))
    lead = clocks[first]
    begins = [clock.begin for clock in clocks.values()]
    ends = [clock.at(histories[key].size)[-1] for key, clock in clocks.items()]
    places, count = _common(columns, lead, histories[first].size, max(begins), min(ends))
    for key, clock in clocks.items():
        if (
            clock.times is None
            and clock.begin == lead.begin
            and clock.step == lead.step
            and lead.times is None
        ):
            histories[key] = histories[key][places : places + count]
            continue
        at = lead.begin + lead.step * np.arange(places, places + count)
        times = clock.at(histories[key].size)
        histories[key] = CubicPath.through(times, histories[key])(np.clip(at, times[0], times[-1]))
        if abs(clock.step / lead.step - 1.0) > _JITTER:
            notes.append(
                f"{channels[key].column!r} was recorded at {1.0 / clock.step:.5g} Hz and interpolated at the "
                f"{1.0 / lead.step:.5g} Hz of {channels[first].column!r}."
            )
    return histories


def _common(columns: Columns, lead: Clock, size: int, begin: float, end: float) -> tuple[int, int]:
    """First sample of the leading clock that all channels have, and the number of those."""
    slack = 1e-6
    first = max(int(np.ceil((begin - lead.begin) / lead.step - slack)), 0)
    last = min(int(np.floor((end - lead.begin) / lead.step + slack)), size - 1)
    if last - first + 1 < _LEAST_SHARED * size:
        raise InputError(
            "The channels of a test must be recorded at the same time",
            value=f"{max(last - first + 1, 0)} of {size} samples in common",
            remedy="Cut the channels to the same time, or name those of one test",
            where=columns.where,
        )
    return first, last - first + 1


def _clock_of(columns: Columns, name: str, shared: Clock | None, size: int, rate_hz: float | None) -> Clock:
    """Clock of a column: its own times, else those of the test."""
    if name in columns.clocks:
        return _clock(columns, name, _readings(columns, name, columns.clocks[name]), 1.0)
    count = columns.values[name].size
    if count != size:
        raise InputError(
            "Channels without times of their own must have the same length",
            value=f"{count} samples of {name!r} and {size} of others",
            remedy="Export all channels at one rate, or with their times",
            where=columns.where,
        )
    if shared is not None:
        return shared
    return Clock(begin=0.0, step=1.0 / rate_hz if rate_hz else _stated_step(columns), times=None)


def _shared_clock(
    columns: Columns, time: Channel | None, rate_hz: float | None, time_units: str | None
) -> Clock | None:
    if time is None:
        return None
    unit = unit_of(time_units or time.unit)
    if time_units is not None and (unit is None or unit.quantity is not Quantity.TIME):
        raise InputError(
            "The unit must be one of time", value=time_units, remedy=f"Choose among {', '.join(TIMES)}"
        )
    times = finite(columns, time.column)
    clock = _clock(columns, time.column, times, unit.factor if unit else 1.0)
    if unit is None and rate_hz is None and clock.step >= _SLOWEST:
        raise InputError(
            "Times must state their unit where they may not be in seconds",
            value=f"steps of {clock.step:g} in {time.column!r}",
            remedy="Say it with `time_units`, or give the sampling rate with `rate`",
            where=columns.where,
        )
    if rate_hz is not None and abs(clock.step * rate_hz - 1.0) > _JITTER:
        raise InputError(
            "The times must agree with the sampling rate",
            value=f"{1.0 / clock.step:.6g} Hz against {rate_hz:g} Hz",
            remedy="Correct `rate`, or say with `time_units` in what unit the times are",
            where=columns.where,
        )
    return clock


def _stated_step(columns: Columns) -> float:
    """Step [s] that the file states beside its columns."""
    for names, invert in ((_STEP_NAMES, False), (_RATE_NAMES, True)):
        for name, value in {**columns.scalars, **_numbers(columns.header)}.items():
            if name.rpartition(".")[2].lower().replace("_", "").replace(" ", "") in names and value > 0.0:
                return 1.0 / value if invert else value
    raise InputError(
        "A test's file must say at what times the samples were taken",
        value=columns.listed,
        remedy="Add a column time, name it with `time`, or give the sampling rate with `rate`",
        where=columns.where,
    )


def _numbers(header: Mapping[str, str]) -> dict[str, float]:
    """Numbers that a header states, without units but hertz and seconds."""
    numbers = {}
    for name, text in header.items():
        try:
            numbers[name] = float(text.removesuffix("Hz").removesuffix("s"))
        except ValueError:
            continue
    return numbers


def _clock(columns: Columns, name: str, times: Array, scale: float) -> Clock:
    """Clock of times in a unit of `scale` [s]; they may be rounded or jitter by half a step."""
    if times.size < FEWEST_SAMPLES:
        raise InputError(
            f"A test must have at least {FEWEST_SAMPLES} samples",
            value=times.size,
            remedy="Give the whole test",
            where=columns.where,
        )
    steps = np.diff(times)
    usual, mean = float(np.median(steps)), float((times[-1] - times[0]) / steps.size)
    off = np.abs(steps - usual) > _JITTER * abs(usual)
    if off.mean() > _FEW:  # the step is no multiple of what the times are rounded to
        off = np.abs(steps - mean) > 1.01 * _rounding(times) + _JITTER * abs(mean)
    if not off.any() and mean > 0.0:
        return Clock(begin=scale * float(times[0]), step=_of_whole_rate(scale * mean), times=None)
    if mean > 0.0 and off.mean() > _FEW and _jitters(times, steps, mean):
        return Clock(begin=scale * float(times[0]), step=scale * mean, times=scale * times)
    row = int(np.flatnonzero(off)[0] if off.any() else np.argmin(steps)) + 1
    raise InputError(
        f"Samples must follow each other at equal steps, here mostly of {usual:.6g}",
        value=f"{times[row]:.10g} after {times[row - 1]:.10g}",
        remedy=_remedy(float(steps[row - 1])),
        where=columns.place(row, name),
    )


def _jitters(times: Array, steps: Array, mean: float) -> bool:
    """Tell times of which no sample is missing, though none is where it should be."""
    largest = _jitter(times, mean)
    near = bool((steps > 0.0).all()) and largest < _LARGEST_JITTER  # a missing sample is half a step at least
    return near or (largest <= 1.0 and bool((np.abs(steps - mean) <= _LARGEST_JITTER * mean).all()))


def _remedy(step: float) -> str:
    """Say what to do about a step between samples that is not like the others."""
    if step == 0.0:
        return "Leave out rows that repeat the time of the row before"
    if step < 0.0:
        return "Cut the file where its time goes back, as where another test begins, and name one test"
    return "Resample the test, or cut it where samples are missing"


def _of_whole_rate(step: float) -> float:
    """Step [s], without the rounding of the times where it is that of a whole number of hertz."""
    rate = round(1.0 / step)
    return 1.0 / rate if rate > 0 and abs(rate * step - 1.0) < _ROUNDED else step


def _jitter(times: Array, step: float) -> float:
    """Largest distance of a time from the even clock that is nearest to all, in steps."""
    count = np.arange(times.size) - (times.size - 1) / 2.0
    late = times - times.mean()
    return float(np.abs(late - count * (count @ late) / (count @ count)).max() / step)


def _rounding(times: Array) -> float:
    """One unit in the last decimal that the times have."""
    for digits in range(_DIGITS + 1):
        if np.abs(times - times.round(digits)).max() <= 1e-12 * max(np.abs(times).max(), 1.0):
            return float(10.0**-digits)
    return 0.0
