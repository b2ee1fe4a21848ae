"""Removal of spurious long-period content, and zero velocity and displacement at the end."""

from math import ceil
from typing import Final

import numpy as np
import scipy

from reliab.arrays import Array

_ORDER: Final = 4


def corner_frequency(magnitude: float) -> float:
    """Corner frequency of the high-pass filter, 10^(1.4071 − 0.3452 M) (Dabaghi & Der Kiureghian 2018).

    Returns [Hz].

    >>> round(corner_frequency(7.0), 4)
    0.0979
    """
    return float(10.0 ** (1.4071 - 0.3452 * magnitude))


def padding(magnitude: float, time_step: float) -> int:
    """Return the number of zeros that the filter needs at either end, three periods of its corner."""
    return ceil(0.75 * _ORDER / corner_frequency(magnitude) / time_step)


def high_pass(acceleration: Array, magnitude: float, time_step: float) -> Array:
    """Remove the content below the corner frequency, without a phase shift.

    The amplitude response of the Butterworth filter is √(r / (1 + r)) with r = (f/f_c)⁸, so that neither the
    velocity nor the displacement keeps a residual.

    `acceleration` (..., n); `time_step` [s]; returns (..., n).
    """
    count = acceleration.shape[-1]
    length = scipy.fft.next_fast_len(count, real=True)
    ratio = (scipy.fft.rfftfreq(length, time_step) / corner_frequency(magnitude)) ** (2 * _ORDER)
    spectrum = scipy.fft.rfft(acceleration, length) * np.sqrt(ratio / (1.0 + ratio))
    filtered: Array = scipy.fft.irfft(spectrum, length)[..., :count]
    return filtered


def settle(acceleration: Array) -> Array:
    """Subtract the smallest straight line that leaves no velocity or displacement at the end.

    `acceleration` (..., n); returns (..., n).

    >>> bool(np.abs(settle(np.array([1.0, 1.0, 1.0, 1.0]))).max() < 1e-14)
    True
    """
    count = acceleration.shape[-1]
    weights = _weights_of_rest(count)
    line = np.stack([np.ones(count), np.linspace(-1.0, 1.0, count)])
    residuals = np.sum(acceleration[..., np.newaxis, :] * weights, axis=-1)
    effects = np.sum(weights[:, np.newaxis, :] * line, axis=-1)
    slopes = np.linalg.solve(effects, residuals[..., np.newaxis])[..., 0]
    settled: Array = acceleration - np.sum(slopes[..., np.newaxis] * line, axis=-2)
    return settled


def _weights_of_rest(count: int) -> Array:
    """Weights of the samples in the last velocity (over Δt) and the last displacement (over Δt²)."""
    velocity = np.ones(count)
    velocity[[0, -1]] = 0.5
    displacement = np.arange(count - 1, -1, -1, dtype=np.float64)
    displacement[0] = (count - 1) / 2 - 1 / 6
    displacement[-1] = 1 / 6
    return np.stack([velocity, displacement])
