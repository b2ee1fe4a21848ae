"""Equations of motion seen through smooth kernels, which take derivatives without differentiating.

Their least squares have correlated residuals: standard errors are those of the sandwich of generalised least
squares, with the residuals' own autocovariance over the kernel's length.
"""

from dataclasses import dataclass

import numpy as np

from reliab.core.arrays import Array
from reliab.signals.spectra import convolve_valid

_PERIODS_OF_KERNEL = 0.5
_SAMPLES_PER_PERIOD = 24.0  # samples of the equation in a period


@dataclass(frozen=True, kw_only=True, eq=False)
class SmoothingKernel:
    """φ and its first two derivatives, and the sampling of the convolved histories."""

    values: tuple[Array, Array, Array]
    time_step: float
    every: int

    @classmethod
    def from_frequency(cls, frequency: float, step: float) -> "SmoothingKernel":
        """Make the kernel of half a period of a natural frequency [Hz] for a step [s]."""
        reach = max(round(_PERIODS_OF_KERNEL / (frequency * step)), 8)
        u = np.arange(-reach, reach + 1) / reach
        # φ = (1 − u²)⁶ and its derivatives by u
        flank = 1.0 - u**2
        first = -12.0 * u * flank**5
        second = -12.0 * flank**5 + 120.0 * u**2 * flank**4
        rate = 1.0 / (reach * step)
        return cls(
            values=(flank**6 / reach, first * rate / reach, second * rate**2 / reach),
            time_step=step,
            every=max(int(1.0 / (_SAMPLES_PER_PERIOD * frequency * step)), 1),
        )

    def smooth_derivative(self, history: Array, order: int) -> Array:
        """Convolve a history with φ⁽ᵏ⁾, which gives its smoothed k-th derivative."""
        return convolve_valid(history, self.values[order])[:: self.every]


def fit_equation(columns: Array, target: Array, kernel: SmoothingKernel) -> tuple[Array, Array, Array]:
    """Fit an equation that was seen through a kernel.

    Returns `values, covariance, residual`: coefficients, shape (k,), their covariance, shape (k, k), and what
    is left over, shape (n,).
    """
    scale = np.maximum(np.sqrt((columns**2).mean(axis=1)), np.finfo(float).tiny)
    rows = columns / scale[:, np.newaxis]
    normal = rows @ rows.T
    values = np.linalg.lstsq(normal, rows @ target, rcond=1e-13)[0]
    residual = target - values @ rows
    freedom = max(residual.size - rows.shape[0], 1)
    lags = min(kernel.values[0].size // kernel.every, target.size // 4)
    meat = normal * float(residual @ residual) / freedom
    for lag in range(1, lags + 1):
        common = float(residual[lag:] @ residual[:-lag]) / freedom
        cross = rows[:, lag:] @ rows[:, :-lag].T
        meat += common * (cross + cross.T)
    bread = np.linalg.pinv(normal, rcond=1e-13, hermitian=True)
    covariance = bread @ meat @ bread
    np.fill_diagonal(covariance, np.maximum(np.diag(covariance), 0.0))
    return values / scale, covariance / np.outer(scale, scale), residual
