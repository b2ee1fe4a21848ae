"""One ground motion: an acceleration record at equal time steps, its changes, and its intensity.

References
----------
Arias, A. (1970). A measure of earthquake intensity. In *Seismic design for nuclear power plants*, 438-483.
Trifunac, M. D. and Brady, A. G. (1975). A study on the duration of strong earthquake ground motion.
*Bulletin of the Seismological Society of America* 65(3), 581-626.
Rathje, E. M., Abrahamson, N. A. and Bray, J. D. (1998). Simplified frequency content estimates of earthquake
ground motions. *Journal of Geotechnical and Geoenvironmental Engineering* 124(2), 150-159.
"""

import hashlib
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.stated_value import require_physical
from reliab.core.vocabulary import STANDARD_GRAVITY

MOST_SAMPLES = 2_000_000
"""Largest number of samples of a motion; its simulation then takes about 1.5 GB on each processor."""

PEAK_LIMIT_G = 5.0
"""Largest peak accepted [g]; the strongest record so far has about 4 g, a larger one means wrong units."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Motion:
    """One component of ground acceleration, sampled at equal steps and linear in between.

    Two motions are equal when their names, events, sets and checksums are.

    Parameters
    ----------
    name : str
        Unique name within a suite, for example ``"KOBE/NIS000"``.
    acceleration : array of float, shape (n,)
        Ground acceleration [m/s²], finite, 2 ≤ n ≤ 2 million, peak at most 5 g. It is copied and
        made read-only.
    time_step : float
        Interval between samples [s], positive.
    event : str, optional
        The earthquake; if empty, the motion counts as a separate event with the motion's name.
    set_name : str, optional
        The set of a catalogue that the motion belongs to.

    Raises
    ------
    InputError
        If the samples or the step break one of the rules above.

    Examples
    --------
    >>> motion = Motion(name="pulse", acceleration=[0.0, 2.0, 0.0], time_step=0.5)
    >>> motion.duration, motion.peak_acceleration, motion.event
    (1.0, 2.0, 'pulse')
    """

    name: str
    acceleration: Array
    time_step: float
    event: str = ""
    set_name: str = ""

    def __post_init__(self) -> None:
        if not self.name:
            raise InputError("A motion must have a name", remedy="Name it, by its record for example")
        require_short(np.size(self.acceleration), self.name)
        object.__setattr__(self, "acceleration", _check_samples(self.acceleration, self.name))
        require_physical("time step", self.time_step, where=self.name)
        object.__setattr__(self, "time_step", float(self.time_step))
        object.__setattr__(self, "event", self.event or self.name)

    def load(self) -> "Motion":
        """Return the motion itself, which is an entry of a suite that needs no reading."""
        return self

    @property
    def duration(self) -> float:
        """Time between the first and the last sample [s]."""
        return (self.acceleration.size - 1) * self.time_step

    @cached_property
    def peak_acceleration(self) -> float:
        """Largest absolute acceleration [m/s²]."""
        return float(np.abs(self.acceleration).max())

    @property
    def times(self) -> Array:
        """Times of the samples, from zero [s], shape (n,)."""
        return np.arange(self.acceleration.size, dtype=np.float64) * self.time_step

    @cached_property
    def checksum(self) -> str:
        """SHA-256 of the step and the samples as little-endian doubles, the same on every platform."""
        digest = hashlib.sha256(np.float64(self.time_step).astype("<f8").tobytes())
        digest.update(self.acceleration.astype("<f8").tobytes())
        return digest.hexdigest()

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Motion):
            return NotImplemented
        return self._identity() == other._identity()

    def __hash__(self) -> int:
        return hash(self._identity())

    def _identity(self) -> tuple[str, str, str, str]:
        return self.name, self.event, self.set_name, self.checksum


def require_short(samples: int, name: str) -> None:
    """Refuse a motion whose simulation would not fit in memory.

    >>> require_short(10_000_000, "long")
    Traceback (most recent call last):
    ...
    reliab.core.errors.InputError: long: Too many samples, above 2,000,000; found 10,000,000. Keep the
    strong part of the record, or resample it.
    """
    if samples > MOST_SAMPLES:
        raise InputError(
            f"Too many samples, above {MOST_SAMPLES:,}",
            value=f"{samples:,}",
            remedy="Keep the strong part of the record, or resample it",
            where=name,
        )


def _check_samples(samples: Array, name: str) -> Array:
    samples_copy = np.array(samples, dtype=np.float64)
    if samples_copy.ndim != 1 or samples_copy.size < 2:  # noqa: PLR2004 - two samples make the shortest record
        raise InputError(
            "A motion must be a one-dimensional array of at least two samples",
            value=f"shape {samples_copy.shape}",
            where=name,
            remedy="Give the accelerations of one component",
        )
    if not np.isfinite(samples_copy).all():
        first = int(np.flatnonzero(~np.isfinite(samples_copy))[0])
        raise InputError(
            "Not a finite number",
            value=f"{samples_copy[first]} at sample {first}",
            remedy="Repair or leave out the record",
            where=name,
        )
    peak = float(np.abs(samples_copy).max()) / STANDARD_GRAVITY
    if peak > PEAK_LIMIT_G:
        raise InputError(
            f"Implausible peak, above {PEAK_LIMIT_G:g} g",
            value=f"{peak:.4g} g",
            remedy="Check the units; a motion is in m/s²",
            where=name,
        )
    samples_copy.flags.writeable = False
    return samples_copy


_STEP_TOLERANCE = 1e-9  # a fraction of a step below which a time counts as lying on a sample


def resample(motion: Motion, rate_hz: float = 1024.0) -> Motion:
    """Interpolate a motion linearly at another rate.

    The paper interpolates every record to 1024 Hz. Linear interpolation changes nothing between the
    samples of a rate above the record's own, but a lower rate drops what lies between its samples.

    `motion`: the record, n samples at its own step; `rate_hz`: new sampling rate [Hz], positive. Returns
    samples at k / rate_hz for every k that lies within the record; at most one new step shorter. Raises
    InputError if the rate is not positive or leaves fewer than two samples.

    >>> slow = Motion(name="ramp", acceleration=[0.0, 1.0, 0.0], time_step=0.5)
    >>> resample(slow, rate_hz=4.0).acceleration.tolist()
    [0.0, 0.5, 1.0, 0.5, 0.0]
    """
    require_physical("sampling rate", rate_hz)
    steps = math.floor(motion.duration * rate_hz + _STEP_TOLERANCE)
    if steps < 1:
        raise InputError(
            "At this sampling rate fewer than two samples are left",
            value=f"{rate_hz} Hz over {motion.duration} s",
            where=motion.name,
            remedy="Choose a higher rate",
        )
    times = np.arange(steps + 1) / rate_hz
    samples = np.interp(times, motion.times, motion.acceleration)
    return replace(motion, acceleration=samples, time_step=1.0 / rate_hz)


_CORNER = 4.0  # Hz, above which filters and time steps of two versions of a record differ
_SAMPLING_SHARE = 0.4  # the same as a share of the sampling rate, for long steps
_REACH = 3.0  # s, on either side of the strongest swing
_POINTS = 151
_BITS = 256
_MOST_DIFFERENT_BITS = (
    36  # bits that may differ in a copy; the most alike of 200 unrelated records differ in 46
)


def outline_of(acceleration: Array, time_step: float) -> str:
    """Describe the strongest swing of a record in 64 hexadecimal digits, whatever its scale and length.

    `acceleration` (n,) [m/s²]; `time_step` [s].

    >>> t = np.arange(0.0, 30.0, 0.01)
    >>> record = np.sin(t**1.5) * np.exp(-(((t - 12.0) / 4.0) ** 2))
    >>> outline, outline_of_copy = (outline_of(values, 0.01) for values in (record, -1.7 * record[500:2300]))
    >>> are_copies([outline], [outline_of_copy]).tolist()
    [[True]]
    """
    rate = 1.0 / time_step
    low_pass = scipy.signal.butter(2, min(_CORNER, _SAMPLING_SHARE * rate), fs=rate, output="sos")
    swings = scipy.signal.sosfilt(low_pass, acceleration)
    times = time_step * np.arange(swings.size)
    place = int(np.abs(swings).argmax())
    around = times[place] + np.linspace(-_REACH, _REACH, _POINTS)
    stretch = np.interp(around, times, swings, left=0.0, right=0.0) * np.sign(swings[place])
    return np.packbits(_patterns() @ stretch > 0.0).tobytes().hex()


def are_copies(outlines: Iterable[str], other_outlines: Iterable[str]) -> NDArray[np.bool_]:
    """Whether records are copies of others by their outlines, shape (records, others)."""
    bits, other_bits = (
        np.frombuffer(bytes.fromhex("".join(texts)), np.uint8).reshape(-1, _BITS // 8)
        for texts in (outlines, other_outlines)
    )
    different_bits = np.bitwise_count(bits[:, np.newaxis] ^ other_bits).sum(axis=2)
    return np.asarray(different_bits <= _MOST_DIFFERENT_BITS)


@cache
def _patterns() -> Array:
    """Patterns without likeness to each other, the same on every machine, shape (bits, points)."""
    number, place = np.arange(1, _BITS + 1)[:, None], np.arange(1, _POINTS + 1)[None, :]
    return np.asarray(np.cos(np.pi * np.sqrt(number + 1.0) * place**2))


_PERIOD_BAND = (0.25, 20.0)  # Hz, Rathje and others (1998)
_FREQUENCY_INTERVAL = 0.05  # Hz, the largest that they allow


@dataclass(frozen=True, kw_only=True)
class Intensity:
    """Measures of one motion."""

    peak_acceleration: float  # Largest absolute acceleration [m/s²]
    arias_intensity: float  # Arias intensity [m/s]
    significant_duration: float  # Time from 5 % to 95 % of the Arias intensity [s]
    mean_period: float  # Mean period [s]


def measure(motion: Motion) -> Intensity:
    """Measure the intensity of a motion.

    `motion`: the motion; not all zeros.
    """
    acceleration, time_step = motion.acceleration, motion.time_step
    return Intensity(
        peak_acceleration=motion.peak_acceleration,
        arias_intensity=arias_intensity(acceleration, time_step),
        significant_duration=significant_duration(acceleration, time_step),
        mean_period=mean_period(acceleration, time_step),
    )


def arias_intensity(acceleration: ArrayLike, time_step: float) -> float:
    """Arias intensity, π/2g times the integral of the squared acceleration.

    `acceleration` (n,) [m/s²]; `time_step` [s]; returns [m/s].

    >>> round(arias_intensity([3.0, 3.0, 3.0], 0.5), 4)  # π/2g · 9 m²/s⁴ · 1 s
    1.4416
    """
    energies = _segment_energies(np.asarray(acceleration, dtype=np.float64), time_step)
    return float(math.pi / (2 * STANDARD_GRAVITY) * energies.sum())


def arias_times(acceleration: ArrayLike, time_step: float, fractions: Sequence[float]) -> Array:
    """Find the times at which fractions of the Arias intensity are reached.

    Within a step the squared acceleration is a parabola and its integral a cubic, inverted in closed form.

    `acceleration`: samples [m/s²], linear in between; not all zeros; `time_step`: interval between samples
    [s]; `fractions`: fractions from 0 to 1. Returns first time at which each is reached, from the first
    sample [s]. Raises InputError if a fraction lies outside of [0, 1] or the record is all zeros.

    >>> arias_times([2.0, 2.0, 2.0], 0.5, [0.0, 0.25, 1.0]).tolist()
    [0.0, 0.25, 1.0]
    """
    samples = np.asarray(acceleration, dtype=np.float64)
    shares = np.asarray(fractions, dtype=np.float64)
    if not ((shares >= 0) & (shares <= 1)).all():
        raise InputError(
            "Fractions of the Arias intensity must lie in [0, 1]", value=fractions, remedy="Give 0.05 for 5 %"
        )
    samples = samples / (np.abs(samples).max() or 1.0)
    cumulative_energy = np.concatenate([[0.0], np.cumsum(_segment_energies(samples, time_step))])
    if not cumulative_energy[-1] > 0:
        raise InputError(
            "The record is zero throughout, so that it has no Arias intensity",
            remedy="Leave the record out, or choose another window",
        )
    target = shares * cumulative_energy[-1]
    segment = np.clip(np.searchsorted(cumulative_energy, target, side="left") - 1, 0, samples.size - 2)
    energy = (target - cumulative_energy[segment]) / time_step
    times: Array = time_step * (segment + _share_of_segment(samples[segment], samples[segment + 1], energy))
    return times


def significant_duration(
    acceleration: ArrayLike, time_step: float, *, start: float = 0.05, end: float = 0.95
) -> float:
    """Time between two fractions of the Arias intensity, D5-95 by default.

    `acceleration` (n,) [m/s²]; `time_step` [s]; returns [s].

    >>> round(significant_duration([1.0, 1.0], 20.0), 9)
    18.0
    """
    first, last = arias_times(acceleration, time_step, [start, end])
    return float(last - first)


def mean_period(acceleration: ArrayLike, time_step: float) -> float:
    """Mean period T_m = Σ(C²/f) / ΣC², C the Fourier amplitudes at frequencies f from 0.25 to 20 Hz.

    The record is followed by zeros until frequencies lie 0.05 Hz apart or closer, as Rathje and others
    require.

    `acceleration` (n,) [m/s²]; `time_step` [s]; returns [s].

    >>> times = 0.01 * np.arange(4000)
    >>> round(mean_period(np.sin(2 * np.pi * 2.0 * times), 0.01), 9)
    0.5
    """
    samples = np.asarray(acceleration, dtype=np.float64)
    count = max(samples.size, math.ceil(1.0 / (_FREQUENCY_INTERVAL * time_step)))
    frequencies = scipy.fft.rfftfreq(count, time_step)
    low, high = _PERIOD_BAND
    is_in_band = (frequencies >= low) & (frequencies <= high)
    power = np.abs(scipy.fft.rfft(samples / (np.abs(samples).max() or 1.0), count)[is_in_band]) ** 2
    total = float(power.sum())
    if not total > 0:
        raise InputError(
            "The mean period needs a record with content from 0.25 to 20 Hz",
            value="none",
            remedy="Check the time step of the record",
        )
    return float((power / frequencies[is_in_band]).sum() / total)


def _segment_energies(samples: Array, time_step: float) -> Array:
    """Integral of the squared acceleration over each step, shape (n - 1,)."""
    start, end = samples[:-1], samples[1:]
    return time_step / 3.0 * (start * start + start * end + end * end)


def _share_of_segment(start: Array, end: Array, energy: Array) -> Array:
    """Share x of a step in which the integral of (start + (end - start) x)² reaches an energy.

    With v the acceleration at x, v³ = start³ + 3 (end - start) energy, and
    x = 3 energy / (v² + v start + start²), which holds even where start and end are equal.
    """
    value = np.cbrt(start**3 + 3.0 * (end - start) * energy)
    denominator = value * value + value * start + start * start
    share = np.divide(3.0 * energy, denominator, out=np.zeros_like(energy), where=denominator > 0)
    return np.clip(share, 0.0, 1.0)
