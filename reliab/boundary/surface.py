"""Error of the whole test over amplitude and delay, between the cells of a stored grid.

The logarithm of the squared error, which is smooth where the error itself has a tip (at the perfect
actuator) or grows beyond all bounds (beyond the critical delay), is a bicubic spline in coordinates
that are linear at the perfect actuator, logarithmic around it and linear again further out, where
the error saturates or grows exponentially. Many surfaces on one grid are evaluated together.
"""

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.arrays import Array
from reliab.compiled import compiled

_FLOOR = 3e-4  # errors below this are not resolved
_LARGEST_ERROR = 1e3


GAIN_SCALE, DELAY_SCALE = 0.2, 0.1
"""Shares of the largest |ln k_p| and delay beyond which the coordinates are linear."""


def stretched(value: Array, core: float, scale: float) -> Array:
    """Coordinate that is linear below the core, logarithmic up to the scale, and linear beyond.

    `value`: values, any shape and unit; `core`, `scale`: limits of the logarithmic part, in the unit of the
    values. Returns coordinate [-], odd and increasing in the value.
    """
    return np.arcsinh(value / core) + value / scale


class ErrorSurfaces:
    """Errors over one grid of gains and delays, interpolated.

    `gain`: gains k_p [-], increasing, with 1 among them, shape (kp,); `delay`: delays τ [s], increasing, with
    0 among them; negative for leads, shape (tau,); `error`: errors [-], shape (surfaces, kp, tau).
    """

    def __init__(self, gain: Array, delay: Array, error: Array) -> None:
        offset = np.log(gain)
        at_one = int(np.argmin(np.abs(offset)))
        self._cores = (max(offset[at_one + 1], -offset[at_one - 1]), delay[delay > 0.0][0])
        self._scales = (GAIN_SCALE * max(offset[-1], -offset[0]), DELAY_SCALE * delay[-1])
        self._ends = (gain[0], gain[-1], delay[0], delay[-1])
        bounded = np.minimum(np.nan_to_num(error, nan=np.inf), _LARGEST_ERROR)
        values = np.log(bounded.astype(np.float64) ** 2 + _FLOOR**2)
        self._edges = self._stretch(offset, 0), self._stretch(delay, 1)
        along_gain = scipy.interpolate.CubicSpline(self._edges[0], values, axis=1).c  # (4, kp, surface, tau)
        along_delay = scipy.interpolate.CubicSpline(
            self._edges[1], along_gain, axis=3
        ).c  # (4, tau, 4, kp, surface)
        self._patches = np.ascontiguousarray(along_delay.transpose(4, 3, 1, 2, 0))

    def _stretch(self, value: Array, axis: int) -> Array:
        return stretched(value, self._cores[axis], self._scales[axis])

    def error(self, amplitude: Array, delay: Array, surface: NDArray[np.int64]) -> Array:
        """Error of given actuators.

        `amplitude`, `delay`: gain [-] and delay [s], shape (cells,); `surface`: index of the surface for each
        actuator, shape (cells,). Returns error [-], shape (cells,); NaN outside the grid.
        """
        lowest, highest, earliest, latest = self._ends
        inside = (amplitude >= lowest * (1 - 1e-9)) & (amplitude <= highest * (1 + 1e-9))
        inside &= (delay >= earliest * (1 + 1e-9)) & (delay <= latest)
        offset = np.log(np.clip(amplitude, lowest, highest))
        place = self._stretch(offset, 0), self._stretch(np.clip(delay, earliest, latest), 1)
        value = _evaluate(*self._edges, self._patches, *place, surface)
        return np.where(inside, np.sqrt(np.maximum(np.exp(value) - _FLOOR**2, 0.0)), np.nan)


@compiled
def _evaluate(
    gain_edges: Array,
    delay_edges: Array,
    patches: Array,
    gain: Array,
    delay: Array,
    surface: NDArray[np.int64],
) -> Array:
    """Bicubic patches by Horner's scheme; shape of the patches (surface, kp, tau, 4, 4)."""
    errors = np.empty(gain.size)
    for cell in range(gain.size):
        i = min(max(np.searchsorted(gain_edges, gain[cell], side="right") - 1, 0), gain_edges.size - 2)
        j = min(max(np.searchsorted(delay_edges, delay[cell], side="right") - 1, 0), delay_edges.size - 2)
        x, y = gain[cell] - gain_edges[i], delay[cell] - delay_edges[j]
        patch = patches[surface[cell], i, j]
        total = 0.0
        for row in range(4):
            along = ((patch[row, 0] * y + patch[row, 1]) * y + patch[row, 2]) * y + patch[row, 3]
            total = total * x + along
        errors[cell] = total
    return errors
