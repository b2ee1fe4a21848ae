"""The filter of one channel, read from its noise.

An anti-alias filter passes the noise of a sensor as it passes the motion: above its corner the noise falls as
no slow noise of a sensor does, with the fourth power of frequency or steeper. The motion came late by the
filter's delay, and where the command did not pass the same filter, that delay looks like one of the actuator.
Whether it did, two displacements do not show. Noise of the converter, which comes after the filter, hides it.
"""

from dataclasses import dataclass

import numpy as np

from reliab.arrays import Array
from reliab.assessment.rebuilt_error.noise import CORNERS, level_of_residual
from reliab.signals import butterworth_delay, fit_levels, noise_shapes

_ORDERS = (2, 4, 8)
_TRIED = 32  # corners
_ROOM = 0.8  # of the Nyquist frequency: highest corner that is looked for
_INNER = 0.99
_PLATEAU = 3.0  # times the lowest frequency of the noise: lowest corner
_FEWEST = 12  # bins of noise
_CLEAR = 30.0  # logarithm of the likelihood ratio from which a filter is seen
_STANDING = (
    0.02  # share of samples that repeat the one before: of a reading with play, a converter, held ones
)
_UPDATES = 200


@dataclass(frozen=True, kw_only=True)
class NoiseFilter:
    """Low-pass filter of Butterworth's kind that the noise of a channel shows.

    >>> round(1e3 * NoiseFilter(corner=100.0, order=2).delay, 2)
    2.25
    """

    corner: float  # Frequency at which half of the power passes [Hz]
    order: int  # Order

    @property
    def delay(self) -> float:
        """Delay of slow motions [s]."""
        return butterworth_delay(self.corner, self.order)

    def passed(self, frequency: Array) -> Array:
        """Share of the power that passes at frequencies [Hz]."""
        return np.asarray(1.0 / (1.0 + (frequency / self.corner) ** (2 * self.order)))


def filter_of_noise(command: Array, measured: Array, time_step: float) -> NoiseFilter | None:
    """Find the filter through which the measured displacement was read; None where its noise shows none.

    `command`, `measured` [m]; `time_step` [s].

    >>> time = np.arange(0.0, 40.0, 0.001)
    >>> command = np.sin(6.0 * time) * np.sin(0.08 * time) ** 2
    >>> noise = 0.01 * np.random.default_rng(1).normal(size=time.size)
    >>> filter_of_noise(command, 0.99 * command + noise, 0.001) is None
    True
    >>> import scipy
    >>> coefficients = scipy.signal.butter(2, 80.0, fs=1000.0)
    >>> read = scipy.signal.lfilter(*coefficients, 0.99 * command + noise)
    >>> 60.0 < filter_of_noise(command, read, 0.001).corner < 100.0
    True
    """
    if np.mean(np.diff(measured) == 0.0) > _STANDING:
        return None
    frequency, level, count = level_of_residual(command, measured, time_step)
    highest = _ROOM * 0.5 / time_step
    inside = frequency < highest / _ROOM
    frequency, level, count = frequency[inside], level[inside], count[inside]
    if frequency.size < _FEWEST or not level.max() > 0.0 or not _PLATEAU * frequency[0] < highest:
        return None
    shapes = noise_shapes(frequency, 1.0 / time_step, CORNERS)

    def likelihood(parts: Array) -> Array:
        start = float(np.average(level, weights=count)) / parts.shape[1]
        floor = 1e-9 * float(level.min()) + np.finfo(float).tiny
        weights = fit_levels(parts, level, count, start=start, floor=floor, updates=_UPDATES)
        expected = (weights[:, np.newaxis] @ parts)[:, 0] + floor
        return np.asarray(-0.5 * np.sum(count * (np.log(expected) + level / expected), axis=1))

    def warped(f: Array) -> Array:  # by the bilinear transform, as a digital filter is
        return np.asarray(np.tan(np.pi * f * time_step) / (np.pi * time_step))

    tried, passed = [], []
    for order in _ORDERS:
        for corner in np.geomspace(_PLATEAU * frequency[0], highest, _TRIED).tolist():
            digital = NoiseFilter(corner=float(warped(np.asarray(corner))), order=order)
            tried.append(NoiseFilter(corner=corner, order=order))
            passed += [tried[-1].passed(frequency), digital.passed(warped(frequency))]
    *filtered, plain = likelihood(shapes * np.array([*passed, np.ones_like(frequency)])[:, np.newaxis])
    best = int(np.argmax(filtered))
    inner = tried[best // 2].corner < _INNER * highest  # noise that falls at the highest only: none
    return tried[best // 2] if inner and filtered[best] - plain > _CLEAR else None
