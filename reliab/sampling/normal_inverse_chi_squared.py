"""The exact posterior of a normal distribution's mean and variance under its conjugate prior.

Prior: σ² ~ ν₀σ₀²/χ²(ν₀), μ | σ² ~ N(μ₀, σ²/κ₀). The reference prior p(μ, σ) ∝ 1/σ is the limit
κ₀ = 0, ν₀ = −1, σ₀² = 0, under which posterior bounds have exact coverage.

References
----------
Gelman, A. and others (2013). *Bayesian data analysis*, third edition, section 3.3.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from reliab.errors import InputError

_FEWEST = 2


@dataclass(frozen=True, kw_only=True)
class NormalInverseChiSquared:
    """A distribution of μ and σ².

    Parameters
    ----------
    mean : float
        μ_n, the centre of μ.
    mean_weight : float
        κ_n, the number of values that μ_n is worth.
    degrees_of_freedom : float
        ν_n of σ².
    variance : float
        σ_n², the scale of σ².

    Examples
    --------
    >>> posterior = NormalInverseChiSquared.posterior(np.array([-1.0, 0.0, 1.0]))
    >>> posterior.degrees_of_freedom, posterior.variance
    (2.0, 1.0)
    """

    mean: float
    mean_weight: float
    degrees_of_freedom: float
    variance: float

    @classmethod
    def reference_prior(cls) -> Self:
        """Improper prior p(μ, σ) ∝ 1/σ."""
        return cls(mean=0.0, mean_weight=0.0, degrees_of_freedom=-1.0, variance=0.0)

    @classmethod
    def posterior(cls, values: ArrayLike, prior: Self | None = None) -> Self:
        """Update a prior with independent normal values.

        Parameters
        ----------
        values : array_like
            Shape (n,), at least two.
        prior : NormalInverseChiSquared, optional
            The reference prior by default.

        Returns
        -------
        NormalInverseChiSquared
            The posterior.

        Raises
        ------
        InputError
            If there are fewer than two values.
        """
        sample = np.asarray(values, dtype=np.float64)
        if sample.size < _FEWEST:
            raise InputError("A posterior needs at least two values", value=sample.size)
        before = cls.reference_prior() if prior is None else prior
        n, average = sample.size, float(sample.mean())
        weight = before.mean_weight + n
        degrees = before.degrees_of_freedom + n
        squares = (
            before.degrees_of_freedom * before.variance
            + float(((sample - average) ** 2).sum())
            + before.mean_weight * n / weight * (average - before.mean) ** 2
        )
        return cls(
            mean=(before.mean_weight * before.mean + n * average) / weight,
            mean_weight=weight,
            degrees_of_freedom=degrees,
            variance=squares / degrees,
        )

    def mean_quantile(self, probability: ArrayLike) -> NDArray[np.float64]:
        """Quantile of μ, Student's t."""
        spread = np.sqrt(self.variance / self.mean_weight)
        return np.asarray(scipy.stats.t.ppf(probability, self.degrees_of_freedom, self.mean, spread))

    def predictive_quantile(self, probability: ArrayLike) -> NDArray[np.float64]:
        """Quantile of a further value, Student's t."""
        spread = np.sqrt(self.variance * (1.0 + 1.0 / self.mean_weight))
        return np.asarray(scipy.stats.t.ppf(probability, self.degrees_of_freedom, self.mean, spread))

    def quantile_of_quantile(self, share: float, probability: ArrayLike) -> NDArray[np.float64]:
        """Posterior quantile of the population's own quantile μ + z_share·σ.

        Parameters
        ----------
        share : float
            Which quantile of the population, in (0, 1).
        probability : array_like
            Posterior probability of lying below the result.

        Returns
        -------
        numpy.ndarray
            From the non-central t distribution with non-centrality √κ_n·z_share.
        """
        root = np.sqrt(self.mean_weight)
        factor = (
            scipy.stats.nct.ppf(probability, self.degrees_of_freedom, scipy.special.ndtri(share) * root)
            / root
        )
        return np.asarray(self.mean + np.sqrt(self.variance) * factor)

    def draw(self, count: int, rng: np.random.Generator) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Draw μ and σ, shape (count,) each."""
        chi_squared = rng.chisquare(self.degrees_of_freedom, count)
        sigma = np.sqrt(self.degrees_of_freedom * self.variance / chi_squared)
        return rng.normal(self.mean, sigma / np.sqrt(self.mean_weight)), sigma
