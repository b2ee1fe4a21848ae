"""Mean and spread of the logarithm at one structure: the model whose posterior is known exactly."""

from dataclasses import dataclass, replace
from typing import ClassVar, Final, Self

import numpy as np
from numpy.typing import NDArray

from reliab.sampling.model import Model, Parameter
from reliab.sampling.normal_inverse_chi_squared import NormalInverseChiSquared

WEAK_PRIOR: Final = NormalInverseChiSquared(mean=-1.0, mean_weight=0.1, degrees_of_freedom=3.0, variance=0.4)
"""Prior of ln α or ln β: worth a tenth of a motion for the mean and three motions for the spread."""


@dataclass(frozen=True, kw_only=True, eq=False)
class NormalValues(Model):
    """Independent normal values ln α or ln β with unknown μ and σ, sampled as (μ, ln σ).

    Prior: σ² ~ ν₀σ₀²/χ²(ν₀) with ν₀ = 3 and σ₀² = 0.4, μ | σ² ~ N(−1, σ²/0.1), unless another one is
    given; under the reference prior p(μ, σ) ∝ 1/σ nothing can be drawn before the data.

    Parameters
    ----------
    values : array of float, shape (motions,)
        Logarithms of the dimensionless parameter, at least two.
    prior : NormalInverseChiSquared, optional
        The conjugate prior.

    Examples
    --------
    >>> model = NormalValues(values=np.array([-1.0, 0.0, 1.0]))
    >>> model.log_likelihood(np.array([[0.0, 0.0], [5.0, 0.0]])).tolist()
    [-1.0, -38.5]
    """

    name: ClassVar[str] = "normal_values"

    values: NDArray[np.float64]
    prior: NormalInverseChiSquared = WEAK_PRIOR

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """μ and ln σ; mean and spread say only where to begin, the prior is the conjugate one."""
        return (
            Parameter(name="mean", mean=float(self.values.mean()), spread=1.0),
            Parameter(name="log_spread", mean=float(np.log(self.values.std() + 1e-3)), spread=1.0),
        )

    @property
    def data(self) -> NDArray[np.float64]:
        """The values."""
        return self.values

    def log_prior(self, theta: NDArray[np.float64]) -> NDArray[np.float64]:
        """Conjugate prior of μ and σ², with the Jacobian of ln σ."""
        mu, log_sigma = theta.T
        squares = self.prior.degrees_of_freedom * self.prior.variance
        squares = squares + self.prior.mean_weight * (mu - self.prior.mean) ** 2
        return np.asarray(
            -(self.prior.degrees_of_freedom + 1.0) * log_sigma - 0.5 * squares * np.exp(-2.0 * log_sigma)
        )

    def log_likelihood(self, theta: NDArray[np.float64]) -> NDArray[np.float64]:
        """Evaluate the normal likelihood from count, mean and sum of squares."""
        mu, log_sigma = theta.T
        n, mean = self.values.size, self.values.mean()
        squares = ((self.values - mean) ** 2).sum() + n * (mean - mu) ** 2
        return np.asarray(-n * log_sigma - 0.5 * squares * np.exp(-2.0 * log_sigma))

    def draw_prior(self, count: int, rng: np.random.Generator) -> NDArray[np.float64]:
        """Draw (μ, ln σ) from the conjugate prior."""
        mu, sigma = self.prior.draw(count, rng)
        return np.stack([mu, np.log(sigma)], axis=1)

    def simulate(self, theta: NDArray[np.float64], rng: np.random.Generator) -> Self:
        """Draw as many values."""
        return replace(self, values=rng.normal(theta[0], np.exp(theta[1]), self.values.size))
