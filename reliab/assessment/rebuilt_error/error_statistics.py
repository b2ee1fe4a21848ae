"""RMS^R and MTE^R from histories.

Both are normalised by the peak of the exact response, as in `reliab.tracking.indices.response_error` ::

    RMS^R = √(mean (x_m − x_I)²)/max|x_I|,   MTE^R = max|x_m − x_I|/max|x_I|
"""

import numpy as np

from reliab.core.arrays import Array
from reliab.core.vocabulary import Metric


def mean_square(values: Array) -> float:
    """Mean square of a history over time by the trapezoidal rule."""
    inner = float(values @ values)
    return (inner - 0.5 * float(values[0] ** 2 + values[-1] ** 2)) / (values.size - 1)


def relative_errors(error: Array, reference: Array) -> tuple[float, float]:
    """RMS^R and MTE^R [-] of x_m − x_I and x_I [m], both shape (n,)."""
    peak = np.abs(reference).max()
    return float(np.sqrt(mean_square(error)) / peak), float(np.abs(error).max() / peak)


def relative_error(error: Array, reference: Array, metric: Metric) -> float:
    """RMS^R or MTE^R [-] of the same."""
    rms, mte = relative_errors(error, reference)
    return rms if metric is Metric.RMS else mte
