"""Conformal bound, grouped by earthquake: distribution-free with few assumptions."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.criterion.methods.bound import BoundMethod


@dataclass(frozen=True, kw_only=True)
class Conformal(BoundMethod):
    """Hierarchical conformal bound.

    Definition: a motion of a further earthquake exceeds the bound with at least the stated
    probability, on average over suites, whatever the distributions within and between earthquakes.
    Every earthquake weighs 1/(K + 1), shared among its motions, and the further one weighs as much
    at minus infinity; the bound is the (1 − confidence) quantile of that. With K earthquakes the
    highest confidence that can be promised is K/(K + 1): 95 % needs 19 of them and 99 % needs 99,
    and beyond that the bound is minus infinity.

    Lee, Y., Barber, R. F. and Willett, R. (2023). Distribution-free inference with hierarchical data.
    arXiv:2306.06342.

    >>> logarithms, events = np.arange(20.0), np.repeat(np.arange(10), 2).astype(str)
    >>> method = Conformal()
    >>> method.lower_bound(logarithms, events, 0.8), method.lower_bound(logarithms, events, 0.95)
    (2.0, -inf)
    """

    name: ClassVar[str] = "conformal"
    meaning: ClassVar[str] = (
        "the predictive probability for a motion of a further earthquake, free of any distribution"
    )
    exchangeable: ClassVar[str] = "earthquakes, and the motions within each, of any distribution"
    distribution_free: ClassVar[bool] = True

    def carried_confidence(self, n_motions: int, n_events: int) -> float:
        """K/(K + 1): the further earthquake may be the worst of all."""
        del n_motions
        return n_events / (n_events + 1.0)

    def _lower_bound(self, logarithms: Array, events: NDArray[np.str_], confidence: float) -> float:
        _, group, sizes = np.unique(events, return_inverse=True, return_counts=True)
        weight = 1.0 / ((sizes.size + 1) * sizes[group])
        order = np.argsort(logarithms)
        # Weight strictly below each value, with that of the further earthquake at minus infinity.
        below = 1.0 / (sizes.size + 1) + np.cumsum(weight[order]) - weight[order]
        allowed = below <= (1.0 - confidence) * (1.0 + 1e-12)
        return float(logarithms[order][allowed.sum() - 1]) if allowed.any() else -np.inf
