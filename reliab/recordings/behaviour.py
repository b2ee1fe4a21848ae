"""What channels do: move alike, follow, jump, rest at another zero, are noisy or of a slower clock.

A linear structure oscillates about the position in which it rests. An error over a peak that is counted from
elsewhere would be too small, and so would one whose peak is that of a move before the test.
"""

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Final

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.recordings.recording import LARGEST_READING, Recording

_MOST_SAMPLES: Final = 1 << 16  # that are looked at, where the first history moves most
_LONGEST_LAG: Final = 0.125  # of them
_COPY_TOLERANCE: Final = 1e-6  # of the larger range, up to which two histories are copies
_LEAST_CORRELATION, _LARGEST_RATIO = 0.9, 2.0
_FEWEST: Final = 16


@dataclass(frozen=True, kw_only=True)
class Likeness:
    """How a second history moves beside a first one."""

    correlation: float  # Largest absolute normalised cross-correlation
    lag: float  # Samples by which the second follows
    ratio: float  # Its RMS over that of the first
    noise_ratio: float  # Its noise over that of the first, each as a share of its RMS
    copies: bool  # Whether both are the same but for rounding

    @property
    def is_pair(self) -> bool:
        """Whether both may be the same motion in the same unit."""
        return self.correlation >= _LEAST_CORRELATION and 1.0 / _LARGEST_RATIO <= self.ratio <= _LARGEST_RATIO


def rises(values: Array) -> bool:
    """Whether a history rises by steps that are not whole numbers, which a counter has."""
    if not (np.abs(values) < LARGEST_READING).all():
        return False
    steps = np.diff(values)
    return bool(steps.size and steps.mean() > 0.0 and (steps >= 0.0).all() and steps.mean() != 1.0)


def moves(values: Array) -> bool:
    """Whether a history of numbers moves."""
    numbers = values[np.abs(values) < LARGEST_READING]
    return bool(numbers.size and np.ptp(numbers) > 1e-9 * np.abs(numbers).max())


def compare(first: Array, second: Array) -> Likeness:
    """Compare two histories, shape (n,), of equal steps; values that are no readings count as no motion."""
    x, y = (_centre(values) for values in _strongest(first, second))
    sizes = [float(np.sqrt(np.mean(values**2))) for values in (x, y)]
    if min(sizes) <= 0.0 or x.size < _FEWEST:
        return Likeness(correlation=0.0, lag=0.0, ratio=np.inf, noise_ratio=1.0, copies=False)
    correlation, lag = _peak(x / sizes[0], y / sizes[1])
    noises = [_noise(values) / size for values, size in zip((x, y), sizes, strict=True)]
    return Likeness(
        correlation=correlation,
        lag=lag,
        ratio=sizes[1] / sizes[0],
        noise_ratio=(noises[1] + 1e-15) / (noises[0] + 1e-15),
        copies=bool(np.abs(x - y).max() <= _COPY_TOLERANCE * max(np.ptp(x), np.ptp(y))),
    )


def share_explained(force: Array, displacement: Array) -> float:
    """Share of a force that its displacement, velocity and acceleration explain linearly."""
    force, displacement = (_centre(values) for values in _strongest(force, displacement))
    velocity = np.gradient(displacement)
    motion = np.column_stack([np.ones(force.size), displacement, velocity, np.gradient(velocity)])
    scales = np.abs(motion).max(axis=0)
    motion = motion / np.where(scales > 0.0, scales, 1.0)
    remainder = force - motion @ np.linalg.lstsq(motion, force)[0]
    spread = float(np.var(force))
    return 1.0 - float(np.var(remainder)) / spread if spread > 0.0 else 0.0


def _centre(values: Array) -> Array:
    """Take the mean from readings; zero stands where a value is none."""
    are_readings = np.abs(values) < LARGEST_READING
    deviation = np.zeros(values.shape)
    if are_readings.any():
        deviation[are_readings] = values[are_readings] - values[are_readings].mean()
    return deviation


def _strongest(first: Array, second: Array) -> tuple[Array, Array]:
    """Take the part of two histories in which the first moves most."""
    size = min(first.size, second.size)
    first, second = first[:size], second[:size]
    if size <= _MOST_SAMPLES:
        return first, second
    travel = np.abs(np.diff(_centre(first))).cumsum()
    begin = int(np.argmax(travel[_MOST_SAMPLES:] - travel[:-_MOST_SAMPLES]))
    return first[begin : begin + _MOST_SAMPLES], second[begin : begin + _MOST_SAMPLES]


def _peak(x: Array, y: Array) -> tuple[float, float]:
    """Largest absolute cross-correlation of two histories of unit RMS, and its lag [samples]."""
    points = 1 << (2 * x.size - 1).bit_length()
    correlation = np.fft.irfft(np.conj(np.fft.rfft(x, points)) * np.fft.rfft(y, points), points) / x.size
    longest_lag = max(int(_LONGEST_LAG * x.size), 2)
    near = np.abs(np.concatenate([correlation[-longest_lag:], correlation[: longest_lag + 1]]))
    place = int(np.argmax(near))
    shift = 0.0
    if 0 < place < near.size - 1:
        value_before, peak, value_after = near[place - 1 : place + 2]
        curvature = value_before - 2.0 * peak + value_after
        shift = 0.5 * float(value_before - value_after) / float(curvature) if curvature < 0.0 else 0.0
    return min(float(near[place]), 1.0), place - longest_lag + shift


def _noise(values: Array) -> float:
    """Estimate what changes from sample to sample, by third differences."""
    return float(np.sqrt(np.mean(np.diff(values, 3) ** 2)))


def white_noise(values: Array) -> float:
    """Root mean square of white noise, from fourth differences, in which no motion is left; shape (n,)."""
    return float(np.median(np.abs(np.diff(values, 4))) / (0.6745 * np.sqrt(70.0)))


_FEWEST_CHANGES: Final = 50  # changes from which the clock of a channel is known
_CLEAR: Final = 4.0  # smallest changes of a change that no rounding makes after a repeated value
_SHARE: Final = 0.75  # of the clear changes, before which a value was repeated
_LONGEST: Final = 0.1  # s that a value stands; what stands longer is a step of the test
_MOST_PHASES: Final = 16


@dataclass(frozen=True, kw_only=True, eq=False)
class Hold:
    """The samples at which a channel takes a new value."""

    places: NDArray[np.intp]  # shape (k,)
    length: float  # samples that a value stands, on average
    # samples by which a value came on average before the row that shows it first, where the clocks have no
    # whole ratio
    lateness: float


def find_hold(values: Array, time_step: float) -> Hold | None:
    """Find that a history, shape (n,), holds each value for several samples; None where it does not.

    Rounding repeats values only where the history hardly moves, and the next change is small.

    >>> time = np.arange(4000) / 1000.0
    >>> hold = find_hold(np.repeat(np.sin(6.0 * time[::8]), 8), 1e-3)
    >>> (hold.length, hold.places[:3].tolist()), find_hold(np.sin(6.0 * time).round(2), 1e-3)
    ((8.0, [0, 8, 16]), None)
    """
    sizes = np.abs(np.diff(values))
    changes = np.flatnonzero(sizes) + 1
    if changes.size < _FEWEST_CHANGES:
        return None
    clear = sizes[changes - 1] >= _CLEAR * sizes[changes - 1].min()
    lengths = np.diff(changes, prepend=0)[clear]
    if lengths.size < _FEWEST_CHANGES or (lengths > 1).mean() < _SHARE:
        return None
    usual = round(float(np.median(lengths)))
    if usual * time_step > _LONGEST:
        return None
    length = float(lengths[lengths <= usual + 1].mean())
    phases = Fraction(length).limit_denominator(_MOST_PHASES).denominator
    bounds = np.concatenate([[0], changes, [values.size]])
    samples = np.arange(values.size)
    stretch = np.searchsorted(bounds, samples, side="right")
    samples_in_stretch, remaining = samples - bounds[stretch - 1], bounds[stretch] - samples
    is_new = (samples_in_stretch == 0) | (
        (samples_in_stretch % usual == 0) & (remaining >= usual)
    )  # a value may come again
    return Hold(places=np.flatnonzero(is_new), length=length, lateness=0.5 * (1.0 - 1.0 / phases))


_QUANTILE = 0.995  # of the steps between samples, nearly the largest one of a history that moves
_JUMP = 4.0  # times that step
_SMALLEST_JUMP = 0.01  # share of the peak
_LONGEST_SPIKE = 8  # samples
_JUMP_REMAINDER = 0.5  # share of the jump by which the history may differ after it


def spikes(values: Array) -> NDArray[np.bool_]:
    """Mark the samples of spikes and dropouts.

    Returns whether a sample belongs to a stretch of at most eight that a jump leads into and another jump, of
    about the same size and the other sign, leads out of, shape (n,).

    >>> history = np.sin(np.arange(0.0, 40.0, 0.05))
    >>> history[300] += 3.0
    >>> np.flatnonzero(spikes(history)).tolist()
    [300]
    """
    steps = np.diff(values)
    size = np.abs(steps)
    usual = float(np.quantile(size, _QUANTILE))
    peak = float(np.quantile(np.abs(values), _QUANTILE))
    jumps = np.flatnonzero(size > max(_JUMP * usual, _SMALLEST_JUMP * peak))
    is_spike = np.zeros(values.size, dtype=np.bool_)
    for place, begin in enumerate(jumps):
        for end in jumps[place + 1 :]:
            if end - begin > _LONGEST_SPIKE:
                break
            remaining = abs(float(values[end + 1] - values[begin]))
            if remaining <= _JUMP_REMAINDER * size[begin] and steps[begin] * steps[end] < 0.0:
                is_spike[begin + 1 : end + 1] = True
                break
    return is_spike


def remove_spikes(recording: Recording) -> tuple[Recording, NDArray[np.bool_], NDArray[np.bool_]]:
    """Bridge the spikes of both histories by straight lines.

    Returns the test without spikes, the same object where it has none, and which samples of command and
    measured displacement were spikes, each shape (n,).
    """
    command_spikes, measured_spikes = spikes(recording.command), spikes(recording.measured)
    if not (command_spikes.any() or measured_spikes.any()):
        return recording, command_spikes, measured_spikes
    return (
        replace(
            recording,
            command=_bridge(recording.command, command_spikes),
            measured=_bridge(recording.measured, measured_spikes),
        ),
        command_spikes,
        measured_spikes,
    )


def _bridge(values: Array, is_spike: NDArray[np.bool_]) -> Array:
    places = np.arange(values.size)
    return np.interp(places, places[~is_spike], values[~is_spike])


_SMALLEST_ZERO = 0.02  # of the command's span: another zero below which nothing is said
_FIRST_STEP_SHARE = 0.05  # of the largest step between samples: a first step of a command that begins at rest
_NEAR = 0.05  # of the span: distance of the mean from the first sample that may be motion
_PIECES, _STEADY = 8, 0.25  # of a command about another zero, and the scatter of their means over the mean
_MOVE: Final = 0.05  # of the span of a command: a move before or after a test, at least
_DWELL: Final = 0.2  # s that a command stands between a move and a test, at least
_STANDING: Final = 0.1  # of the mean speed of a move, up to which a command stands
_RETURN_SHARE: Final = 0.01  # of the span by which a command goes back when it no longer moves to a position
_ABOUT: Final = 0.1  # of the span of a test: distance of its mean along its path from the position before it
_NOISE: Final = 6.0  # of its standard deviation, which the difference of two samples hardly exceeds


def zero_of(command: Array) -> float:
    """Value about which a command oscillates, shape (n,); 0 where that is zero, or cannot be told.

    >>> time = np.arange(0.0, 20.0, 0.01)
    >>> zero_of(0.1 + 0.003 * np.sin(time) ** 3), zero_of(np.cos(time))
    (0.1, 0.0)
    """
    first, mean, span = float(command[0]), float(command.mean()), float(np.ptp(command))
    steps = np.abs(np.diff(command))
    if steps[0] <= _FIRST_STEP_SHARE * steps.max():
        oscillates = abs(mean - first) <= abs(first) / 2.0
        zero = first if abs(mean - first) <= _NEAR * span else mean
    else:
        means = [float(piece.mean()) for piece in np.array_split(command, _PIECES)]
        steady = float(np.std(means)) < _STEADY * abs(mean)
        oscillates = steady or command.min() > 0.0 or command.max() < 0.0
        zero = mean
    return zero if oscillates and abs(zero) > _SMALLEST_ZERO * span else 0.0


def extent_of_test(command: Array, time_step: float) -> tuple[int, int]:
    """Find the first sample of a test and the one behind its last, without moves to and from its position.

    A move goes one way, and the command stands before the test oscillates about where it ended. `time_step`
    [s].

    >>> time = np.arange(0.0, 30.0, 0.01)
    >>> test = 0.05 * np.clip(time / 5.0, 0.0, 1.0) + 0.02 * np.sin(6.0 * np.clip(time - 6.0, 0.0, 20.0))
    >>> extent_of_test(test, 0.01), extent_of_test(np.sin(time), 0.01)
    ((499, 3000), (0, 3000))
    """
    begin = _end_of_move(command, time_step)
    return begin, command.size - _end_of_move(command[begin:][::-1], time_step)


def _end_of_move(command: Array, time_step: float) -> int:
    """Find where a command stands after a move that begins with its first sample; 0 without such a move."""
    span, noise = float(np.ptp(command)), _NOISE * white_noise(command)
    stand = max(round(_DWELL / time_step), 8)
    first = float(np.median(command[:stand]))
    travel = command - first
    away = np.abs(travel) > _MOVE * span
    if not away.any():
        return 0
    travel = travel * np.sign(travel[np.argmax(away)])
    has_turned = np.maximum.accumulate(travel) - travel > _RETURN_SHARE * span + noise
    travel = travel[: int(np.argmax(has_turned))] if has_turned.any() else travel
    if stand >= travel.size:
        return 0
    mean_speed = travel / np.arange(1, travel.size + 1)
    ends = {"size": stand + 1, "origin": -((stand + 1) // 2)}  # of windows that begin with each sample
    ranges = scipy.ndimage.maximum_filter1d(travel, **ends) - scipy.ndimage.minimum_filter1d(travel, **ends)
    stands = ranges[:-stand] <= _STANDING * stand * mean_speed[:-stand] + noise
    places = np.flatnonzero(stands & away[: stands.size])
    runs = np.split(places, np.flatnonzero(np.diff(places) > 1) + 1)
    for run in sorted(runs, key=len, reverse=True) if places.size else ():
        level, test = float(np.median(command[run])), command[run[-1] :]
        path = np.abs(np.diff(test))
        oscillates = path.sum() > abs(level - first)
        if oscillates and abs(path @ (test[1:] - level)) <= _ABOUT * float(np.ptp(test)) * path.sum():
            near = np.abs(command[run] - level) <= _STANDING * _SMALLEST_ZERO * span + noise
            return int(run[np.argmax(near)])
    return 0
