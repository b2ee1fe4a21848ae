"""What channels do: which two move alike, which of them follows, which is noisy, or of a slower clock."""

from dataclasses import dataclass
from fractions import Fraction
from typing import Final

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.recordings.recording import LARGEST_READING

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
