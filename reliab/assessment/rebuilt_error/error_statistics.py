"""RMS^R and MTE^R from histories.

Both are normalised by the peak of the exact response, as in `reliab.tracking.indices.response_error` ::

    RMS^R = √(mean (x_m − x_I)²)/max|x_I|,   MTE^R = max|x_m − x_I|/max|x_I|
"""

import numpy as np

from reliab.core.arrays import Array
from reliab.core.vocabulary import Metric


def mean_square(values: Array) -> Array:
    """Mean square of histories over time by the trapezoidal rule, shape (…, n) to (…)."""
    squares = values**2
    ends = squares[..., 0] + squares[..., -1]
    return np.asarray((squares.sum(axis=-1) - 0.5 * ends) / (values.shape[-1] - 1))


def relative_errors(error: Array, exact: Array) -> tuple[Array, Array]:
    """RMS^R and MTE^R [-] of histories of x_m − x_I and x_I [m], shape (…, n); each shape (…)."""
    peak = np.abs(exact).max(axis=-1)
    return np.sqrt(mean_square(error)) / peak, np.abs(error).max(axis=-1) / peak


def relative_error(error: Array, exact: Array, metric: Metric) -> float:
    """RMS^R or MTE^R [-] of one history of each, shape (n,)."""
    rms, mte = relative_errors(error, exact)
    return float(rms if metric is Metric.RMS else mte)
