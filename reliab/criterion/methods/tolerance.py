"""One-sided tolerance bound of the lognormal distribution: proportion of motions × assurance."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.criterion.methods.method import AssuredBound
from reliab.criterion.motion_predictive import SumsOfSquares


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


_DRAWS = 4000
_SEED = 2017


@dataclass(frozen=True, kw_only=True)
class Tolerance(AssuredBound):
    """One-sided tolerance bound of a lognormal distribution, motions of one earthquake being alike.

    Definition: in a share `assurance` of all suites that could have been drawn, at least the stated
    share of the motions exceeds the bound. Where earthquakes have several motions, the variances between
    and within them are drawn from their sums of squares, and with them mean and quantile of the population
    (a generalised confidence limit); it is the posterior's limit under the reference prior, too. Otherwise it
    is the exact bound of independent motions.

    Krishnamoorthy, K. and Mathew, T. (2004). One-sided tolerance limits in balanced and unbalanced one-way
    random models based on generalized confidence intervals. *Technometrics* 46(1), 44-52.

    `assurance`: Share of suites for which the promise is kept, in (0, 1).

    >>> logarithms = np.array([-1.0, 0.0, 1.0, 0.5, -0.5])
    >>> bound = Tolerance().lower_bound(logarithms, np.arange(5).astype(str), 0.95)
    >>> round(bound, 4)  # −4.203 · 0.7906
    -3.3225
    """

    name: ClassVar[str] = "tolerance"
    meaning: ClassVar[str] = (
        "a tolerance bound: suites like this one keep the promise with the stated assurance, if motions are "
        "lognormal about their earthquakes"
    )
    lognormal: ClassVar[bool] = True

    def _lower_bound(self, logarithms: Array, events: NDArray[np.str_], confidence: float) -> float:
        squares = SumsOfSquares.from_values(logarithms, events)
        if not squares.separate:
            factor = tolerance_factor(logarithms.size, confidence, self.assurance)
            return float(logarithms.mean() - factor * logarithms.std(ddof=1))
        rng = np.random.default_rng(_SEED)
        inner = squares.within / rng.chisquare(squares.degrees_within, _DRAWS)
        event_variance = squares.between / rng.chisquare(squares.degrees_between, _DRAWS)
        outer = np.maximum((event_variance - inner) / squares.mean_size, 0.0)
        variance_of_mean = outer * squares.concentration + inner / logarithms.size
        means = logarithms.mean() + np.sqrt(variance_of_mean) * rng.standard_normal(_DRAWS)
        quantiles = means + scipy.special.ndtri(1.0 - confidence) * np.sqrt(outer + inner)
        return float(np.quantile(quantiles, 1.0 - self.assurance))
