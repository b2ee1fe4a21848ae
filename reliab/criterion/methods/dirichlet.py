"""The recommended meaning: predictive quantile of the motions themselves and a fitted shape beyond them."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.criterion.methods.method import BoundMethod
from reliab.criterion.motion_predictive import CONCENTRATION, MotionPredictive


@dataclass(frozen=True, kw_only=True)
class Dirichlet(BoundMethod):
    """Predictive quantile under a Dirichlet process with a skew-normal base.

    Definition: given these motions, the probability that a motion of a further earthquake exceeds the
    bound is the stated confidence. The distribution is learned, not assumed
    (`reliab.criterion.motion_predictive`): with many earthquakes the bound tends to the sample's own
    quantile, with few a fitted skew-normal shape determines the tail. Motions of one earthquake are alike and
    count as fewer independent ones.

    >>> logarithms = np.random.default_rng(1).normal(size=400)
    >>> round(Dirichlet().lower_bound(logarithms, np.arange(400).astype(str), 0.95), 2)
    -1.62
    """

    name: ClassVar[str] = "dirichlet"
    meaning: ClassVar[str] = (
        "the predictive probability for a motion of a further earthquake, learned from the motions "
        "themselves and, beyond them, from a fitted distribution; motions of one earthquake count as "
        "fewer independent ones"
    )

    concentration: float = CONCENTRATION  # Weight of the fitted shape, as a number of motions

    def _lower_bound(self, logarithms: Array, events: NDArray[np.str_], confidence: float) -> float:
        predictive = MotionPredictive.fit(logarithms[:, None], events, self.concentration)
        return float(predictive.quantile(1.0 - confidence)[0])
