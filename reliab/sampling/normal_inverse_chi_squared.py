"""The exact posterior of a normal distribution's mean and variance.

It is σ² ~ νσₙ²/χ²(ν), μ | σ² ~ N(μₙ, σ²/κₙ). Under the reference prior p(μ, σ) ∝ 1/σ its bounds have exact
coverage.

References
----------
Gelman, A. and others (2013). *Bayesian data analysis*, third edition, section 3.3.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np
import scipy
from numpy.typing import ArrayLike

from reliab.core.arrays import Array
from reliab.core.errors import InputError

_FEWEST = 2


@dataclass(frozen=True, kw_only=True)
class NormalInverseChiSquared:
    """A distribution of μ and σ².

    >>> posterior = NormalInverseChiSquared.posterior(np.array([-1.0, 0.0, 1.0]))
    >>> posterior.degrees_of_freedom, posterior.variance
    (2.0, 1.0)
    """

    mean: float  # μ_n, the centre of μ
    mean_weight: float  # κ_n, the number of values that μ_n is worth
    degrees_of_freedom: float  # ν_n of σ²
    variance: float  # σ_n², the scale of σ²

    @classmethod
    def posterior(cls, values: ArrayLike) -> Self:
        """Learn from independent normal values, shape (n,), under the reference prior.

        Raises InputError if there are fewer than two values.
        """
        sample = np.asarray(values, dtype=np.float64)
        if sample.size < _FEWEST:
            raise InputError("A posterior needs at least two values", value=sample.size)
        return cls(
            mean=float(sample.mean()),
            mean_weight=float(sample.size),
            degrees_of_freedom=sample.size - 1.0,
            variance=float(sample.var(ddof=1)),
        )

    def predictive_quantile(self, probability: ArrayLike) -> Array:
        """Quantile of a further value, Student's t."""
        spread = np.sqrt(self.variance * (1.0 + 1.0 / self.mean_weight))
        return np.asarray(scipy.stats.t.ppf(probability, self.degrees_of_freedom, self.mean, spread))

    def quantile_of_quantile(self, share: float, probability: ArrayLike) -> Array:
        """Posterior quantile of the population's own quantile μ + z_share·σ.

        `share`: which quantile of the population, in (0, 1); `probability`: posterior probability of lying
        below the result. Comes from the non-central t distribution with non-centrality √κ_n·z_share.
        """
        root = np.sqrt(self.mean_weight)
        factor = (
            scipy.stats.nct.ppf(probability, self.degrees_of_freedom, scipy.special.ndtri(share) * root)
            / root
        )
        return np.asarray(self.mean + np.sqrt(self.variance) * factor)
