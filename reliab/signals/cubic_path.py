"""Cubic spline through samples, whose third derivative is continuous at the second and last but one."""

from dataclasses import dataclass
from typing import Any, Self

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.compiled import compiled

_FEWEST = 4

_Numbers = NDArray[np.floating[Any]]


@dataclass(frozen=True, kw_only=True, eq=False)
class CubicPath:
    """A function of time between samples, and beyond them the polynomial of the nearest pair."""

    times: _Numbers  # Instants of the samples, increasing, shape (n,)
    coefficients: Array  # Of the powers three to zero of the time since the sample before, shape (4, n - 1)

    @classmethod
    def interpolate(cls, times: _Numbers, values: _Numbers) -> Self:
        """Lay the path through two or more samples, shape (n,) each; a line or parabola through two or three.

        >>> path = CubicPath.interpolate(np.arange(6.0), np.arange(6.0) ** 3)
        >>> round(float(path(np.array([2.5]))[0]), 12), round(float(path(np.array([2.5]), 1)[0]), 12)
        (15.625, 18.75)
        """
        if times.size < _FEWEST:
            return cls(times=times, coefficients=scipy.interpolate.CubicSpline(times, values).c)
        steps = np.diff(times)
        rises = np.diff(values) / steps
        slopes = _slopes(steps, rises)
        bend = (slopes[:-1] + slopes[1:] - 2.0 * rises) / steps
        square = (rises - slopes[:-1]) / steps - bend
        return cls(times=times, coefficients=np.stack([bend / steps, square, slopes[:-1], values[:-1]]))

    def __call__(self, instants: _Numbers, derivative: int = 0) -> Array:
        """Read the path, or a derivative of it, at instants in any order."""
        return np.asarray(self.read(instants, (derivative,))[0])

    def read_samples(self) -> Array:
        """Read the path and its first two derivatives at its samples, as `read` does, shape (3, n)."""
        _, square, slope, value = self.coefficients
        motion = np.empty((3, self.times.size))
        motion[:, :-1] = value, slope, 2.0 * square
        motion[:, -1:] = self.read(self.times[-1:], (0, 1, 2))
        return motion

    def read_delayed(self, delay: float) -> Array:
        """Read an evenly sampled path at its samples less a delay, shape (n,); it stands still at both ends.

        >>> path = CubicPath.interpolate(np.arange(5.0), np.arange(5.0) ** 2)
        >>> path.read_delayed(1.5).round(12).tolist(), path.read_delayed(-1.0).round(12).tolist()
        ([0.0, 0.0, 0.25, 2.25, 6.25], [1.0, 4.0, 9.0, 16.0, 16.0])
        """
        step = float(self.times[1] - self.times[0])
        samples = int(np.ceil(delay / step))
        since = samples * step - delay
        cubic, square, slope, value = self.coefficients
        delayed_values = value + since * (slope + since * (square + since * cubic))
        first, last = self(self.times[[0, -1]])
        places = np.arange(1, self.times.size + 1) - samples
        return np.concatenate([[first], delayed_values, [last]])[np.clip(places, 0, self.times.size)]

    def read(self, instants: _Numbers, derivatives: tuple[int, ...]) -> Array:
        """Read several derivatives of the path at instants, shape (derivatives, instants)."""
        return _read(self.times, self.coefficients, instants, np.array(derivatives))


@compiled
def _read(times: _Numbers, coefficients: Array, instants: _Numbers, derivatives: NDArray[np.int64]) -> Array:
    """Read derivatives of a path, which may be zero to two, shape (derivatives, instants)."""
    values = np.empty((derivatives.size, instants.size))
    last = times.size - 2
    place = 0
    for k in range(instants.size):
        instant = instants[k]
        if place < last and instant >= times[place + 1]:  # instants in their order are near the one before
            place += 1
        if instant < times[place] or (place < last and instant >= times[place + 1]):
            place = _place_before(times, instant, last)
        cubic, square, slope = coefficients[0, place], coefficients[1, place], coefficients[2, place]
        since = instant - times[place]
        for row in range(derivatives.size):
            if derivatives[row] == 0:
                value = coefficients[3, place] + since * (slope + since * (square + since * cubic))
            elif derivatives[row] == 1:
                value = slope + since * (2.0 * square + 3.0 * since * cubic)
            else:
                value = 2.0 * square + 6.0 * since * cubic
            values[row, k] = value
    return values


@compiled
def _place_before(times: _Numbers, instant: float, last: int) -> int:
    """Find the last of the first `last` + 1 samples that is not after an instant; the first before all.

    A search of NumPy's would load Numba's linear algebra at the start of every command.
    """
    low, high = 0, last
    while low < high:
        middle = (low + high + 1) // 2
        if times[middle] <= instant:
            low = middle
        else:
            high = middle - 1
    return low


@compiled
def _slopes(steps: _Numbers, rises: _Numbers) -> Array:
    """Slopes at the samples, at which the second derivative is continuous.

    Each row of the equations is eliminated from the next one, and slopes follow backwards: no pivot is
    needed, because no multiplier exceeds one but in the last row.
    """
    last = steps.size
    diagonal, upper, slopes = np.empty(last + 1), np.empty(last), np.empty(last + 1)
    begin, end = steps[0] + steps[1], steps[last - 2] + steps[last - 1]
    diagonal[0], upper[0] = steps[1], begin
    slopes[0] = ((steps[0] + 2.0 * begin) * steps[1] * rises[0] + steps[0] ** 2 * rises[1]) / begin
    for k in range(1, last):
        factor = steps[k] / diagonal[k - 1]
        diagonal[k] = 2.0 * (steps[k - 1] + steps[k]) - factor * upper[k - 1]
        upper[k] = steps[k - 1]
        right = 3.0 * (steps[k] * rises[k - 1] + steps[k - 1] * rises[k])
        slopes[k] = right - factor * slopes[k - 1]
    factor = end / diagonal[last - 1]
    right = steps[last - 1] ** 2 * rises[last - 2]
    right += (2.0 * end + steps[last - 1]) * steps[last - 2] * rises[last - 1]
    slopes[last] = right / end - factor * slopes[last - 1]
    slopes[last] /= steps[last - 2] - factor * upper[last - 1]
    for k in range(last - 1, -1, -1):
        slopes[k] = (slopes[k] - upper[k] * slopes[k + 1]) / diagonal[k]
    return slopes
