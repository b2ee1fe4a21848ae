"""Sums over the error of a running test, which go on when its samples are forgotten."""

import numpy as np

from reliab.arrays import Array
from reliab.compiled import compiled


class RunningSums:
    """Sums over the error r = x_m − x_I of a test, and over x_I.

    `size`: Samples so far, with those of a rest before that were forgotten.
    `values`: Σr², half the square of its first value, max|r|, max|x_I|, r of the last sample, max|x_I| when
    it last doubled, and the number of the sample at which it did, shape (7,).
    """

    def __init__(self, rest: int = 0) -> None:
        self.size, self.values = rest, np.zeros(7)

    def add(self, error: Array, ideal: Array) -> None:
        """Add the next samples of r and x_I [m], shape (k,) each."""
        _add_all(self.values, error, ideal, self.size)
        self.size += error.size

    @property
    def latest(self) -> float:
        """Error of the last sample [m]."""
        return float(self.values[4])

    @property
    def mean_square(self) -> float:
        """Mean square of r over the whole test so far [m²], by the trapezoidal rule."""
        inner = self.values[0] - self.values[1] - 0.5 * self.values[4] ** 2
        return max(float(inner), 0.0) / max(self.size - 1, 1)

    @property
    def rms(self) -> float:
        """RMS^R so far [-]; zero while nothing moves."""
        ideal = float(self.values[3])
        return float(np.sqrt(self.mean_square)) / ideal if ideal > 0.0 else 0.0

    @property
    def mte(self) -> float:
        """MTE^R so far [-]; zero while nothing moves."""
        peak, ideal = self.values[2:4].tolist()
        return peak / ideal if ideal > 0.0 else 0.0

    @property
    def calm(self) -> float:
        """Samples since the peak of x_I last doubled."""
        return self.size - 1 - float(self.values[6])


@compiled
def _add_all(sums: Array, error: Array, ideal: Array, first: int) -> None:
    """Add samples to the sums, in place; `first`: number of the first of them."""
    for i in range(error.size):
        _add(sums, error[i], ideal[i], first + i)


@compiled
def _add(sums: Array, error: float, ideal: float, number: int) -> None:
    """Add a sample to the sums, in place."""
    if number == 0:
        sums[1] = 0.5 * error * error
    sums[0] += error * error
    sums[2] = max(sums[2], abs(error))
    sums[3] = max(sums[3], abs(ideal))
    sums[4] = error
    if sums[3] > 2.0 * sums[5]:
        sums[5], sums[6] = sums[3], number
