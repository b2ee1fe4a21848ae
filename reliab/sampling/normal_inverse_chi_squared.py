"""The exact posterior of a normal distribution's mean and variance, and the same model to be sampled.

Prior: σ² ~ ν₀σ₀²/χ²(ν₀), μ | σ² ~ N(μ₀, σ²/κ₀). The reference prior p(μ, σ) ∝ 1/σ is the limit
κ₀ = 0, ν₀ = −1, σ₀² = 0, under which posterior bounds have exact coverage.

References
----------
Gelman, A. and others (2013). *Bayesian data analysis*, third edition, section 3.3.
"""

from dataclasses import dataclass, replace
from typing import ClassVar, Final, Self

import numpy as np
import scipy
from numpy.typing import ArrayLike

from reliab.arrays import Array
from reliab.errors import InputError
from reliab.sampling.model import Model, Parameter

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
    def reference_prior(cls) -> Self:
        """Improper prior p(μ, σ) ∝ 1/σ."""
        return cls(mean=0.0, mean_weight=0.0, degrees_of_freedom=-1.0, variance=0.0)

    @classmethod
    def posterior(cls, values: ArrayLike, prior: Self | None = None) -> Self:
        """Update a prior with independent normal values.

        `values`: shape (n,), at least two; `prior`: the reference prior by default. Raises InputError if
        there are fewer than two values.
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

    def mean_quantile(self, probability: ArrayLike) -> Array:
        """Quantile of μ, Student's t."""
        spread = np.sqrt(self.variance / self.mean_weight)
        return np.asarray(scipy.stats.t.ppf(probability, self.degrees_of_freedom, self.mean, spread))

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

    def draw(self, count: int, rng: np.random.Generator) -> tuple[Array, Array]:
        """Draw μ and σ, shape (count,) each."""
        chi_squared = rng.chisquare(self.degrees_of_freedom, count)
        sigma = np.sqrt(self.degrees_of_freedom * self.variance / chi_squared)
        return rng.normal(self.mean, sigma / np.sqrt(self.mean_weight)), sigma


WEAK_PRIOR: Final = NormalInverseChiSquared(mean=-1.0, mean_weight=0.1, degrees_of_freedom=3.0, variance=0.4)
"""Prior of ln α or ln β: worth a tenth of a motion for the mean and three motions for the spread."""


@dataclass(frozen=True, kw_only=True, eq=False)
class NormalValues(Model):
    """Independent normal values ln α or ln β with unknown μ and σ, sampled as (μ, ln σ).

    Prior: σ² ~ ν₀σ₀²/χ²(ν₀) with ν₀ = 3 and σ₀² = 0.4, μ | σ² ~ N(−1, σ²/0.1), unless another one is
    given; under the reference prior p(μ, σ) ∝ 1/σ nothing can be drawn before the data.

    >>> model = NormalValues(values=np.array([-1.0, 0.0, 1.0]))
    >>> model.log_likelihood(np.array([[0.0, 0.0], [5.0, 0.0]])).tolist()
    [-1.0, -38.5]
    """

    name: ClassVar[str] = "normal_values"

    values: Array  # Logarithms of the dimensionless parameter, at least two
    prior: NormalInverseChiSquared = WEAK_PRIOR  # The conjugate prior

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """μ and ln σ; mean and spread say only where to begin, the prior is the conjugate one."""
        return (
            Parameter(name="mean", mean=float(self.values.mean()), spread=1.0),
            Parameter(name="log_spread", mean=float(np.log(self.values.std() + 1e-3)), spread=1.0),
        )

    @property
    def data(self) -> Array:
        """The values."""
        return self.values

    def log_prior(self, theta: Array) -> Array:
        """Conjugate prior of μ and σ², with the Jacobian of ln σ."""
        mu, log_sigma = theta.T
        squares = self.prior.degrees_of_freedom * self.prior.variance
        squares = squares + self.prior.mean_weight * (mu - self.prior.mean) ** 2
        return np.asarray(
            -(self.prior.degrees_of_freedom + 1.0) * log_sigma - 0.5 * squares * np.exp(-2.0 * log_sigma)
        )

    def log_likelihood(self, theta: Array) -> Array:
        """Evaluate the normal likelihood from count, mean and sum of squares."""
        mu, log_sigma = theta.T
        n, mean = self.values.size, self.values.mean()
        squares = ((self.values - mean) ** 2).sum() + n * (mean - mu) ** 2
        return np.asarray(-n * log_sigma - 0.5 * squares * np.exp(-2.0 * log_sigma))

    def draw_prior(self, count: int, rng: np.random.Generator) -> Array:
        """Draw (μ, ln σ) from the conjugate prior."""
        mu, sigma = self.prior.draw(count, rng)
        return np.stack([mu, np.log(sigma)], axis=1)

    def simulate(self, theta: Array, rng: np.random.Generator) -> Self:
        """Draw as many values."""
        return replace(self, values=rng.normal(theta[0], np.exp(theta[1]), self.values.size))
