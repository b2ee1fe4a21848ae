"""Measures of intensity and duration, exact for a record that is linear between its samples.

References
----------
Arias, A. (1970). A measure of earthquake intensity. In *Seismic design for nuclear power plants*, 438-483.
Trifunac, M. D. and Brady, A. G. (1975). A study on the duration of strong earthquake ground motion.
*Bulletin of the Seismological Society of America* 65(3), 581-626.
Rathje, E. M., Abrahamson, N. A. and Bray, J. D. (1998). Simplified frequency content estimates of earthquake
ground motions. *Journal of Geotechnical and Geoenvironmental Engineering* 124(2), 150-159.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import ArrayLike

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.vocabulary import STANDARD_GRAVITY
from reliab.motions.motion import Motion

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
