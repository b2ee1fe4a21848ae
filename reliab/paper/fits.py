"""The curve fits of the paper."""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import curve_fit

from reliab.criterion.distributions import Lognormal

_SHARE = 0.05


def exponential(frequencies: ArrayLike, b: ArrayLike) -> tuple[float, float]:
    """Fit k₁ and k₂ of equation (13), b = k₁ e^(−k₂f), by least squares of b itself.

    Examples
    --------
    >>> f = np.array([0.25, 0.5, 1.0, 2.0])
    >>> [round(each, 6) for each in exponential(f, 97.0 * np.exp(-3.4 * f))]
    [97.0, 3.4]
    """
    f, values = np.asarray(frequencies, dtype=np.float64), np.asarray(b, dtype=np.float64)
    slope, level = np.polyfit(f, np.log(values), 1)
    found, _ = curve_fit(
        lambda x, k1, k2: k1 * np.exp(-k2 * x), f, values, p0=(np.exp(level), -slope), maxfev=20000
    )
    return float(found[0]), float(found[1])


def proportional(damping_ratios: ArrayLike, values: ArrayLike) -> float:
    """Fit k of equations (16), y = kξ, by least squares.

    Examples
    --------
    >>> round(proportional([0.02, 0.1], [2.0, 10.0]), 6)
    100.0
    """
    xi, y = np.asarray(damping_ratios, dtype=np.float64), np.asarray(values, dtype=np.float64)
    return float(xi @ y / (xi @ xi))


def quantile(values: NDArray[np.float64]) -> float:
    """5 % quantile of a lognormal distribution, the paper's "95 % confidence"; NaN of nothing."""
    known = values[np.isfinite(values) & (values > 0.0)]
    return float(Lognormal.fit(known).quantile(_SHARE)) if known.size else float("nan")
