"""Bootstrap over earthquakes: how far the plug-in quantile may be off."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.arrays import Array
from reliab.criterion.methods.bound import AssuredBound


@dataclass(frozen=True, kw_only=True)
class Bootstrap(AssuredBound):
    """Lower bootstrap bound of the plug-in quantile, earthquakes drawn with all their motions.

    Definition: the lognormal (1 − confidence) quantile is computed for many suites made of
    earthquakes drawn with replacement; a share `assurance` of these quantiles lies above the bound.
    Approximate, and too optimistic for few earthquakes, but it accounts for motions of one earthquake being
    alike, which the tolerance bound does not.

    `assurance`: Share of the resampled quantiles above the bound, in (0, 1).

    >>> logarithms = np.random.default_rng(1).normal(size=100)
    >>> alone, paired = np.arange(100).astype(str), np.repeat(np.arange(10), 10).astype(str)
    >>> method = Bootstrap()
    >>> round(method.lower_bound(logarithms, alone, 0.95), 1)
    -1.7
    """

    name: ClassVar[str] = "bootstrap"
    meaning: ClassVar[str] = "a bound from resampling whole earthquakes"
    exchangeable: ClassVar[str] = "earthquakes, each with all its motions; lognormal"
    lognormal: ClassVar[bool] = True

    resamples: int = 4000  # Number of suites
    seed: int = 2017  # Seed of the draws

    def _lower_bound(self, logarithms: Array, events: NDArray[np.str_], confidence: float) -> float:
        centred = logarithms - logarithms.mean()
        _, group = np.unique(events, return_inverse=True)
        sums = np.stack([np.bincount(group, centred**power) for power in range(3)], axis=1)
        rng = np.random.default_rng(self.seed)
        drawn = rng.multinomial(len(sums), np.full(len(sums), 1.0 / len(sums)), self.resamples) @ sums
        means = drawn[:, 1] / drawn[:, 0]
        spreads = np.sqrt(np.maximum(drawn[:, 2] / drawn[:, 0] - means**2, 0.0))
        quantiles = means + scipy.special.ndtri(1.0 - confidence) * spreads
        return float(logarithms.mean() + np.quantile(quantiles, 1.0 - self.assurance))
