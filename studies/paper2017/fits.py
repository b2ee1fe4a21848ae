"""The fits of the paper: equations (13) and (16), and the quantile that it calls 95 % confidence."""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import curve_fit

from reliab.criterion.distributions import Lognormal

from .printed import SHARE

_PARAMETERS = 2


def exponential(frequencies: ArrayLike, b: ArrayLike) -> tuple[float, float]:
    """Fit k₁ and k₂ of equation (13), b = k₁ e^(−k₂f), by least squares of b; NaN of one value.

    Table 3 as printed gives equation (15):

    >>> from reliab_studies.paper2017.printed import PrintedTables
    >>> table = PrintedTables.read().table3
    >>> [round(k, 1) for k in exponential(table["f_hz"], table["b"])]
    [121.6, 6.6]
    """
    f, values = np.asarray(frequencies, dtype=np.float64), np.asarray(b, dtype=np.float64)
    if f.size < _PARAMETERS or not np.isfinite(values).all():
        return float("nan"), float("nan")
    slope, level = np.polyfit(f, np.log(values), 1)
    (k1, k2), _ = curve_fit(
        lambda x, k1, k2: k1 * np.exp(-k2 * x), f, values, p0=(np.exp(level), -slope), maxfev=20000
    )
    return float(k1), float(k2)


def proportional(damping_ratios: ArrayLike, values: ArrayLike) -> float:
    """Fit k of equations (16), y = kξ, by least squares.

    >>> round(proportional([0.02, 0.1], [2.0, 10.0]), 6)
    100.0
    """
    xi, y = np.asarray(damping_ratios, dtype=np.float64), np.asarray(values, dtype=np.float64)
    return float(xi @ y / (xi @ xi))


def quantile(values: NDArray[np.float64]) -> float:
    """5 % quantile of a lognormal distribution, the paper's "95 % confidence"; NaN of nothing."""
    known = values[np.isfinite(values) & (values > 0.0)]
    return float(Lognormal.fit(known).quantile(SHARE)) if known.size else float("nan")
