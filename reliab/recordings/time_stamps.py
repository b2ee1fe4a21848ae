"""Time stamps of a channel: the step between samples, and what is uneven about them."""

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.physical_range import require_physical
from reliab.core.significant_digits import significant
from reliab.recordings.readers.columns import Columns
from reliab.recordings.recording import FEWEST_SAMPLES

_EVEN: Final = 0.01  # share of a step by which a time may be off and still count as equal
_FEW: Final = 0.01  # share of unusual steps up to which they are faults, and not the rounding of the times
_GAP: Final = 0.5  # of a step, by which one that is such a fault differs from others
_MISSING: Final = 0.75  # of a step by which times jump where a sample is missing; a jitter of 0.45 does half
_LATE: Final = 1.35  # of the steps beside it, from which a step may hide a missing sample
_BESIDE: Final = 32  # samples on either side of which the clock is known, which makes 0.45 of jitter 0.5
_DIGITS: Final = 9
_ROUNDED: Final = 1e-9  # relative
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

    def at(self, size: int) -> Array:
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
            where=columns.where,
        )
    steps = np.diff(times)
    usual, mean = float(np.median(steps)), float((times[-1] - times[0]) / steps.size)
    odd = np.abs(steps - usual) > _EVEN * abs(usual)
    gaps = np.abs(steps - usual) > _GAP * abs(usual)
    if mean <= 0.0 or (gaps.any() and odd.mean() <= _FEW):
        raise _no_equal_steps(columns, name, times, int(np.argmax(gaps) if gaps.any() else np.argmin(steps)))
    require_physical("time step", factor * mean, where=columns.where)
    latest = _latest(times)
    if latest <= max(_EVEN * mean, 1.01 * _rounding(times)):
        return Clock(begin=factor * float(times[0]), step=_of_whole_rate(factor * mean))
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
    for reach in (_BESIDE // 2, _BESIDE):
        level, rise = _lines(times, reach)
        before, after = level + 0.5 * reach * rise, level - 0.5 * reach * rise
        size = np.maximum(rise[:-reach], rise[reach:])
        inner = slice(reach - 1, times.size - reach)
        apart = after[reach:] - before[:-reach]
        jumps[inner] |= (apart > _MISSING * size) & (steps[inner] > _LATE * size)
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
    rises = _lines(times, _BESIDE)[1]
    shortest, longest = float(rises.min()), float(rises.max())
    mean = float(times[-1] - times[0]) / (times.size - 1)
    if longest > _LARGEST_RATIO * shortest:
        raise InputError(
            f"The steps between samples range from {significant(shortest)} to {significant(longest)} s, "
            f"by more than a factor of {_LARGEST_RATIO:g}",
            remedy="Resample the test, or cut it where the rate changes",
            where=columns.where,
        )
    changes = longest > (1.0 + 2.0 * _STEADY) * shortest
    step = _of_whole_rate(shortest) if changes else mean
    if changes:
        what = f"The step between samples changes between {shortest:.4g} and {longest:.4g} s"
    elif off > 1.0:
        what = f"The clock drifts by up to {significant(off)} steps"
    else:
        what = f"The clock jitters by up to {significant(off, 2)} of a step"
    note = f"{what}; the channels were interpolated at equal steps of {step:.6g} s."
    return Clock(begin=float(times[0]), step=step, times=times, note=note)


def _of_whole_rate(step: float) -> float:
    """Step [s], without the rounding of the times where it is that of a whole number of hertz."""
    rate = round(1.0 / step)
    return 1.0 / rate if rate > 0 and abs(rate * step - 1.0) < _ROUNDED else step


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
