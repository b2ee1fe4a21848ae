"""Bayesian credible bound of the population's own quantile."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from reliab.arrays import Array
from reliab.criterion.methods.bound import AssuredBound
from reliab.sampling import NormalInverseChiSquared


@dataclass(frozen=True, kw_only=True)
class Posterior(AssuredBound):
    """Lower credible bound of the (1 − confidence) quantile of a lognormal distribution.

    Definition: given these motions, the probability is `assurance` that at least the stated share of
    all motions exceeds the bound. The prior is p(μ, σ) ∝ 1/σ, under which the bound equals the
    tolerance bound and keeps its promise over repeated suites too.

    `assurance`: Posterior probability of the promise, in (0, 1).

    >>> logarithms = np.array([-1.0, 0.0, 1.0, 0.5, -0.5])
    >>> round(Posterior().lower_bound(logarithms, np.arange(5).astype(str), 0.95), 4)
    -3.3225
    """

    name: ClassVar[str] = "posterior"
    meaning: ClassVar[str] = (
        "a credible bound of the population's quantile, if motions are independent and lognormal"
    )
    exchangeable: ClassVar[str] = "motions, each counted as independent and lognormal"
    lognormal: ClassVar[bool] = True

    def _lower_bound(self, logarithms: Array, events: NDArray[np.str_], confidence: float) -> float:
        del events
        posterior = NormalInverseChiSquared.posterior(logarithms)
        return float(posterior.quantile_of_quantile(1.0 - confidence, 1.0 - self.assurance))
