"""Probability that two correlated normal variables both stay below their limits."""

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

_TINY = 1e-300  # in place of zero, where a ratio would have no sign


def both_below(first: ArrayLike, second: ArrayLike, correlation: ArrayLike) -> NDArray[np.float64]:
    """Distribution function of the standard bivariate normal distribution.

    Parameters
    ----------
    first, second : array_like of float
        Limits in standard deviations from the means, finite; broadcast against the correlation.
    correlation : array_like of float
        Correlation, in (−1, 1).

    Returns
    -------
    numpy.ndarray
        Probability that both variables are below their limits, of the shape of all three.

    Notes
    -----
    By two of Owen's T functions: D. B. Owen, Tables for computing bivariate normal probabilities, Annals of
    Mathematical Statistics 27 (1956), eq. (2.1).

    Examples
    --------
    >>> both_below(0.0, 0.0, [0.0, 0.5]).round(6).tolist()
    [0.25, 0.333333]
    """
    h, k, r = np.broadcast_arrays(
        *(np.asarray(value, dtype=np.float64) for value in (first, second, correlation))
    )
    h, k = (np.where(limit == 0.0, _TINY, limit) for limit in (h, k))
    root = np.sqrt((1.0 - r) * (1.0 + r))
    owen = scipy.special.owens_t(h, (k / h - r) / root) + scipy.special.owens_t(k, (h / k - r) / root)
    opposite = np.where((h > 0.0) == (k > 0.0), 0.0, 0.5)
    return np.asarray(0.5 * (scipy.special.ndtr(h) + scipy.special.ndtr(k)) - owen - opposite)
