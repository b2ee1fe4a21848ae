"""Least squares for an equation of motion seen through a kernel: its residuals are correlated.

Standard errors are those of generalised least squares' sandwich with the residuals' own autocovariance over
the kernel's length.
"""

import numpy as np

from reliab.arrays import Array
from reliab.assessment.rebuilt_error.kernel import Kernel


def fit_equation(columns: Array, target: Array, kernel: Kernel) -> tuple[Array, Array, Array]:
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
