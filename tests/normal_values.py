"""Independent normal values, whose posterior is known exactly, as a model for samplers.

Prior: σ² ~ ν₀σ₀²/χ²(ν₀), μ | σ² ~ N(μ₀, σ²/κ₀). The reference prior p(μ, σ) ∝ 1/σ is the limit κ₀ = 0,
ν₀ = −1, σ₀² = 0 (Gelman and others 2013, Bayesian data analysis, third edition, section 3.3).
"""

from dataclasses import dataclass, replace
from typing import ClassVar, Final, Self

import numpy as np

from reliab.core.arrays import Array
from reliab.sampling.ensembles import Model, SampledParameter
from reliab.sampling.normal_inverse_chi_squared import NormalInverseChiSquared

REFERENCE_PRIOR: Final = NormalInverseChiSquared(
    mean=0.0, mean_weight=0.0, degrees_of_freedom=-1.0, variance=0.0
)
WEAK_PRIOR: Final = NormalInverseChiSquared(mean=-1.0, mean_weight=0.1, degrees_of_freedom=3.0, variance=0.4)


def updated(prior: NormalInverseChiSquared, values: Array) -> NormalInverseChiSquared:
    """Update a prior with values."""
    n, average = values.size, float(values.mean())
    weight, degrees = prior.mean_weight + n, prior.degrees_of_freedom + n
    squares = prior.degrees_of_freedom * prior.variance + float(((values - average) ** 2).sum())
    squares += prior.mean_weight * n / weight * (average - prior.mean) ** 2
    return NormalInverseChiSquared(
        mean=(prior.mean_weight * prior.mean + n * average) / weight,
        mean_weight=weight,
        degrees_of_freedom=degrees,
        variance=squares / degrees,
    )


def drawn(distribution: NormalInverseChiSquared, count: int, rng: np.random.Generator) -> tuple[Array, Array]:
    """Draw μ and σ, shape (count,) each."""
    chi_squared = rng.chisquare(distribution.degrees_of_freedom, count)
    sigma = np.sqrt(distribution.degrees_of_freedom * distribution.variance / chi_squared)
    return rng.normal(distribution.mean, sigma / np.sqrt(distribution.mean_weight)), sigma


@dataclass(frozen=True, kw_only=True, eq=False)
class NormalValues(Model):
    """Independent normal values ln α or ln β with unknown μ and σ, sampled as (μ, ln σ).

    Prior: σ² ~ ν₀σ₀²/χ²(ν₀) with ν₀ = 3 and σ₀² = 0.4, μ | σ² ~ N(−1, σ²/0.1), unless another one is
    given; under the reference prior p(μ, σ) ∝ 1/σ nothing can be drawn before the data.
    """

    name: ClassVar[str] = "normal_values"

    values: Array  # Logarithms of the dimensionless parameter, at least two
    prior: NormalInverseChiSquared = WEAK_PRIOR  # The conjugate prior

    @property
    def parameters(self) -> tuple[SampledParameter, ...]:
        """μ and ln σ; mean and spread say only where to begin, the prior is the conjugate one."""
        return (
            SampledParameter(name="mean", mean=float(self.values.mean()), spread=1.0),
            SampledParameter(name="log_spread", mean=float(np.log(self.values.std() + 1e-3)), spread=1.0),
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
        mu, sigma = drawn(self.prior, count, rng)
        return np.stack([mu, np.log(sigma)], axis=1)

    def simulate(self, theta: Array, rng: np.random.Generator) -> Self:
        """Draw as many values."""
        return replace(self, values=rng.normal(theta[0], np.exp(theta[1]), self.values.size))
