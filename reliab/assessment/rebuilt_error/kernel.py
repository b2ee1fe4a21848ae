"""Smooth kernels that take derivatives of histories without differentiating them."""

from dataclasses import dataclass

import numpy as np

from reliab.arrays import Array
from reliab.signals import convolved

_PERIODS_OF_KERNEL = 0.5
_PER_PERIOD = 24.0  # samples of the equation in a period


@dataclass(frozen=True, kw_only=True, eq=False)
class Kernel:
    """φ and its first two derivatives, and the sampling of the convolved histories."""

    values: tuple[Array, Array, Array]
    time_step: float
    every: int

    @classmethod
    def of_frequency(cls, frequency: float, step: float) -> "Kernel":
        """Make the kernel of half a period of a natural frequency [Hz] for a step [s]."""
        reach = max(round(_PERIODS_OF_KERNEL / (frequency * step)), 8)
        u = np.arange(-reach, reach + 1) / reach
        # φ = (1 − u²)⁶ and its derivatives by u
        flank = 1.0 - u**2
        first = -12.0 * u * flank**5
        second = -12.0 * flank**5 + 120.0 * u**2 * flank**4
        per_time = 1.0 / (reach * step)
        return cls(
            values=(flank**6 / reach, first * per_time / reach, second * per_time**2 / reach),
            time_step=step,
            every=max(int(1.0 / (_PER_PERIOD * frequency * step)), 1),
        )

    def seen(self, history: Array, order: int) -> Array:
        """Convolve a history with φ⁽ᵏ⁾, which gives its smoothed k-th derivative."""
        return convolved(history, self.values[order])[:: self.every]

    def sum_seen(self, history: Array, weights: tuple[float, float, float]) -> Array:
        """Weighted sum of a history's smoothed derivatives, from none to the second, by one convolution."""
        return convolved(history, np.tensordot(weights, np.array(self.values), 1))[:: self.every]
