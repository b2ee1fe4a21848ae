"""a and b together at one structure: means, spreads and correlation of their logarithms."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from reliab.criterion.bayes.covariance import (
    covariance_of,
    covariance_parameters,
    factor_of,
    normal_log_density,
    squares_of,
)
from reliab.criterion.bayes.model import Model, Parameter


@dataclass(frozen=True, kw_only=True, eq=False)
class BivariateLognormal(Model):
    """Independent pairs (ln α, ln β) of motions, bivariate normal.

    Priors: both means ~ N(−1, 2²), ln σ ~ N(ln 0.6, 0.8²), artanh ρ ~ N(1.5, 0.75²); means and spreads of
    the dimensionless α = a/ξ² and β = bω₀²/ξ², which the physics puts near 1.

    Parameters
    ----------
    pairs : array of float, shape (motions, 2)
        ln α and ln β.

    Examples
    --------
    >>> model = BivariateLognormal(pairs=np.array([[-1.0, -1.2], [0.0, -0.1], [-0.5, -0.9]]))
    >>> [each.name for each in model.parameters][:2]
    ['mean of a', 'mean of b']
    """

    name: ClassVar[str] = "bivariate_lognormal"

    pairs: NDArray[np.float64]

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Means, then the covariance."""
        means = (Parameter(name=f"mean of {each}", mean=-1.0, spread=2.0) for each in "ab")
        return (*means, *covariance_parameters("motion", 0.6))

    @property
    def data(self) -> NDArray[np.float64]:
        """The pairs."""
        return self.pairs

    @cached_property
    def _statistics(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        mean = self.pairs.mean(axis=0)
        return mean, squares_of(self.pairs - mean).sum(axis=0)

    def log_likelihood(self, theta: NDArray[np.float64]) -> NDArray[np.float64]:
        """Bivariate normal likelihood from means and sums of squares."""
        mean, within = self._statistics
        count = len(self.pairs)
        squares = within + count * squares_of(mean - theta[:, :2])
        return normal_log_density(covariance_of(theta[:, 2:]), squares, count)

    def simulate(self, theta: NDArray[np.float64], rng: np.random.Generator) -> Self:
        """Draw as many pairs."""
        factor = factor_of(covariance_of(theta[2:]))
        return replace(self, pairs=theta[:2] + rng.standard_normal(self.pairs.shape) @ factor.T)
