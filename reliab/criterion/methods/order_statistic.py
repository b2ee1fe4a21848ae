"""Distribution-free tolerance bound: one of the motions themselves."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.criterion.methods.method import AssuredBound
from reliab.criterion.motion_predictive import event_components


@dataclass(frozen=True, kw_only=True)
class OrderStatistic(AssuredBound):
    """Distribution-free tolerance bound.

    Definition: in at least a share `assurance` of all suites, at least the stated share of the motions
    exceeds the bound, whatever their distribution. The bound is the r-th smallest value with the largest
    r for which the share of the population below it, of the distribution Beta(r, n − r + 1), is small enough
    (Wilks 1941); without such an r, as with fewer than 59 motions for 95 % and 95 %, it is minus infinity.
    Motions of one earthquake are alike: both parameters shrink to as many independent motions as analysis of
    variance finds.

    `assurance`: Share of suites for which the promise is kept, in (0, 1).

    Wilks, S. S. (1941). Determination of sample sizes for setting tolerance limits. *Annals of
    Mathematical Statistics* 12(1), 91-96.

    >>> for n in (58, 59):
    ...     print(OrderStatistic().lower_bound(np.arange(n, dtype=float), np.arange(n).astype(str), 0.95))
    -inf
    0.0
    """

    name: ClassVar[str] = "order_statistic"
    meaning: ClassVar[str] = "a bound by order statistics, free of any distribution"
    distribution_free: ClassVar[bool] = True

    def achievable_confidence(self, n_motions: int, n_events: int) -> float:
        """Share that the smallest of n motions promises with the assurance, (1 − assurance)^(1/n)."""
        del n_events
        return float((1.0 - self.assurance) ** (1.0 / n_motions))

    def _lower_bound(self, logarithms: Array, events: NDArray[np.str_], confidence: float) -> float:
        n = logarithms.size
        worth = float(event_components(logarithms, events).effective_number) / n
        ranks = np.arange(1, n + 1)
        rank_distribution = scipy.stats.beta(worth * ranks, worth * (n + 1 - ranks))
        is_assured = rank_distribution.cdf(1.0 - confidence) >= self.assurance
        return float(np.sort(logarithms)[is_assured.sum() - 1]) if is_assured.any() else -np.inf
