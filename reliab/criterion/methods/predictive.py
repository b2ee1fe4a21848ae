"""Bayesian posterior-predictive quantile of the lognormal distribution."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.criterion.methods.method import BoundMethod
from reliab.sampling.normal_inverse_chi_squared import NormalInverseChiSquared


@dataclass(frozen=True, kw_only=True)
class Predictive(BoundMethod):
    """Posterior-predictive quantile of a lognormal distribution.

    Definition: given these motions, the probability that one further motion exceeds the bound is the
    stated confidence. With the prior p(μ, σ) ∝ 1/σ this is mean + t(1 − confidence; n − 1) s √(1 + 1/n)
    of the logarithms, and it holds on average over repeated suites too.

    >>> logarithms = np.array([-1.0, 0.0, 1.0, 0.5, -0.5])
    >>> round(Predictive().lower_bound(logarithms, np.arange(5).astype(str), 0.95), 4)
    -1.8462
    """

    name: ClassVar[str] = "predictive"
    meaning: ClassVar[str] = "the predictive probability for one further motion, if motions are lognormal"
    lognormal: ClassVar[bool] = True

    def _lower_bound(self, logarithms: Array, events: NDArray[np.str_], confidence: float) -> float:
        del events
        posterior = NormalInverseChiSquared.posterior(logarithms)
        return float(posterior.predictive_quantile(1.0 - confidence))
