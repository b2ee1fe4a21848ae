"""What a Bayesian model is: parameters with priors, a vectorised posterior, and data that it can simulate."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from emcee.moves import Move


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """One parameter on the unbounded scale on which it is sampled, with a normal prior.

    Parameters
    ----------
    name : str
        What it is called in tables and figures.
    mean, spread : float
        Mean and standard deviation of its prior.
    """

    name: str
    mean: float
    spread: float


class Model(ABC):
    """A posterior over unbounded parameters, given the data that the model holds.

    Attributes
    ----------
    name : str
        What the model is called in files.
    """

    name: ClassVar[str]

    @property
    @abstractmethod
    def parameters(self) -> tuple[Parameter, ...]:
        """Parameters in the order of the sampled vectors."""

    @abstractmethod
    def log_likelihood(self, theta: NDArray[np.float64]) -> NDArray[np.float64]:
        """Log-likelihood up to a constant of parameter vectors, shape (vectors, parameters) to (vectors,)."""

    @abstractmethod
    def simulate(self, theta: NDArray[np.float64], rng: np.random.Generator) -> Self:
        """Make the same model with data drawn at one parameter vector, shape (parameters,)."""

    @property
    @abstractmethod
    def data(self) -> NDArray[np.float64]:
        """The data, for their checksum and for prior-predictive checks."""

    def log_prior(self, theta: NDArray[np.float64]) -> NDArray[np.float64]:
        """Log-density up to a constant of the priors, shape (vectors,)."""
        means, spreads = self._prior
        return np.asarray(-0.5 * (((theta - means) / spreads) ** 2).sum(axis=1))

    @property
    def moves(self) -> "Move | list[tuple[Move, float]] | None":
        """How walkers move; None leaves it to :func:`reliab.sampling.sample`."""
        return None

    def draw_prior(self, count: int, rng: np.random.Generator) -> NDArray[np.float64]:
        """Draw parameter vectors from the prior, shape (count, parameters)."""
        means, spreads = self._prior
        return rng.normal(means, spreads, (count, means.size))

    def log_posterior(self, theta: NDArray[np.float64]) -> NDArray[np.float64]:
        """Log-density up to a constant of the posterior, shape (vectors,); minus infinity where undefined."""
        with np.errstate(all="ignore"):
            density = self.log_prior(theta) + self.log_likelihood(theta)
        return np.where(np.isfinite(density), density, -np.inf)

    @property
    def _prior(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        means = np.array([parameter.mean for parameter in self.parameters])
        return means, np.array([parameter.spread for parameter in self.parameters])


def prior_predictive(model: Model, *, count: int = 1000, seed: int = 2017) -> NDArray[np.float64]:
    """Draw data that a model expects before it has seen any.

    Returns (count, ...).

    Before any record is seen, 95 % of the motions have an α between 0.0007 and 330; nothing is ruled out
    that a structure could do:

    >>> from reliab.sampling import NormalValues
    >>> drawn = prior_predictive(NormalValues(values=np.zeros(20)), count=4000)
    >>> [f"{value:.0e}" for value in np.exp(np.quantile(drawn, [0.025, 0.5, 0.975]))]
    ['7e-04', '4e-01', '3e+02']
    """
    rng = np.random.default_rng(seed)
    return np.stack([model.simulate(theta, rng).data for theta in model.draw_prior(count, rng)])
