"""What a Bayesian model is: parameters with priors, a vectorised posterior, and data that it can simulate."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Self

import numpy as np

from reliab.core.arrays import Array

if TYPE_CHECKING:
    from emcee.moves import Move


@dataclass(frozen=True, kw_only=True)
class SampledParameter:
    """One parameter on the unbounded scale on which it is sampled, with a normal prior."""

    name: str  # What it is called in tables and figures
    mean: float  # mean, spread: Mean and standard deviation of its prior
    spread: float


class Model(ABC):
    """A posterior over unbounded parameters, given the data that the model holds."""

    name: ClassVar[str]  # What the model is called in files

    @property
    @abstractmethod
    def parameters(self) -> tuple[SampledParameter, ...]:
        """Parameters in the order of the sampled vectors."""

    @abstractmethod
    def log_likelihood(self, theta: Array) -> Array:
        """Log-likelihood up to a constant of parameter vectors, shape (vectors, parameters) to (vectors,)."""

    @abstractmethod
    def simulate(self, theta: Array, rng: np.random.Generator) -> Self:
        """Make the same model with data drawn at one parameter vector, shape (parameters,)."""

    @property
    @abstractmethod
    def data(self) -> Array:
        """The data, for their checksum and for prior-predictive checks."""

    def log_prior(self, theta: Array) -> Array:
        """Log-density up to a constant of the priors, shape (vectors,)."""
        means, spreads = self._prior
        return np.asarray(-0.5 * (((theta - means) / spreads) ** 2).sum(axis=1))

    @property
    def moves(self) -> "Move | list[tuple[Move, float]] | None":
        """How walkers move; None leaves it to :func:`reliab.sampling.ensembles.sample`."""
        return None

    def draw_prior(self, count: int, rng: np.random.Generator) -> Array:
        """Draw parameter vectors from the prior, shape (count, parameters)."""
        means, spreads = self._prior
        return rng.normal(means, spreads, (count, means.size))

    def log_posterior(self, theta: Array) -> Array:
        """Log-density up to a constant of the posterior, shape (vectors,); minus infinity where undefined."""
        with np.errstate(all="ignore"):
            density = self.log_prior(theta) + self.log_likelihood(theta)
        return np.where(np.isfinite(density), density, -np.inf)

    @property
    def _prior(self) -> tuple[Array, Array]:
        means = np.array([parameter.mean for parameter in self.parameters])
        return means, np.array([parameter.spread for parameter in self.parameters])
