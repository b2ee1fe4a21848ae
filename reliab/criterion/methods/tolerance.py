"""One-sided tolerance bound of the lognormal distribution: proportion of motions × assurance."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.arrays import Array
from reliab.criterion.methods.bound import AssuredBound


def tolerance_factor(n: int, proportion: float, assurance: float) -> float:
    """Exact factor k of a one-sided normal tolerance bound, mean − k · standard deviation.

    With probability `assurance`, at least the share `proportion` of a normal population lies above
    the bound when mean and standard deviation (divisor n − 1) come from n independent values. √n·k is
    the `assurance` quantile of the non-central t distribution with n − 1 degrees of freedom and
    non-centrality √n·z_proportion.

    Returns [-].

    Odeh, R. E. and Owen, D. B. (1980). *Tables for normal tolerance limits, sampling plans, and screening*.

    >>> round(tolerance_factor(10, 0.95, 0.95), 3), round(tolerance_factor(43, 0.90, 0.99), 4)
    (2.911, 1.874)
    """
    root = np.sqrt(n)
    return float(scipy.stats.nct.ppf(assurance, n - 1, scipy.special.ndtri(proportion) * root) / root)


@dataclass(frozen=True, kw_only=True)
class Tolerance(AssuredBound):
    """One-sided tolerance bound of a lognormal distribution.

    Definition: in a share `assurance` of all suites that could have been drawn, at least the stated
    share of the motions exceeds the bound. Exact for independent lognormal motions; motions of one
    earthquake are not independent, so that the true assurance is lower (see `Bootstrap`).

    `assurance`: Share of suites for which the promise is kept, in (0, 1).

    >>> logarithms = np.array([-1.0, 0.0, 1.0, 0.5, -0.5])
    >>> bound = Tolerance().lower_bound(logarithms, np.arange(5).astype(str), 0.95)
    >>> round(bound, 4)  # −4.203 · 0.7906
    -3.3225
    """

    name: ClassVar[str] = "tolerance"
    meaning: ClassVar[str] = (
        "a tolerance bound: suites like this one keep the promise with the stated assurance, if motions "
        "are independent and lognormal"
    )
    exchangeable: ClassVar[str] = "motions, each counted as independent and lognormal"
    lognormal: ClassVar[bool] = True

    def _lower_bound(self, logarithms: Array, events: NDArray[np.str_], confidence: float) -> float:
        del events
        factor = tolerance_factor(logarithms.size, confidence, self.assurance)
        return float(logarithms.mean() - factor * logarithms.std(ddof=1))
