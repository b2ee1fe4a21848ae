"""What a Bayesian model is: priors, a posterior and its normal approximation, and data that it simulates."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Self

import numpy as np
import scipy

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


_DIFFERENCE = 1e-3  # of the spread of the prior
_FARTHEST = 6.0
_DESERT = 1e30
_DEGREES = 8.0  # tails of the leaps
_WIDER = 1.1
_LEAPS = 0.6  # share of the moves


@dataclass(frozen=True, kw_only=True, eq=False)
class Laplace:
    """Normal approximation of a posterior about its mode."""

    mode: Array  # Parameters of the greatest density
    # Square root of the covariance, mapping standard normal variables to deviations from the mode
    factor: Array

    @classmethod
    def about_mode(cls, model: Model) -> Self:
        """Approximate the posterior of a model.

        The approximation is nowhere wider than the prior.
        """
        begin = np.array([parameter.mean for parameter in model.parameters])
        spreads = np.array([parameter.spread for parameter in model.parameters])

        def loss(deviations: Array) -> Array:
            return np.minimum(-model.log_posterior(begin + spreads * deviations), _DESERT)

        bounds = [(-_FARTHEST, _FARTHEST)] * begin.size
        optimum = scipy.optimize.minimize(
            lambda deviations: _value_and_gradient(loss, deviations),
            np.zeros_like(begin),
            jac=True,
            method="L-BFGS-B",
            bounds=bounds,
            options={"maxiter": 2000},
        )
        steps = _DIFFERENCE * np.eye(begin.size)
        gradients = [
            (_value_and_gradient(loss, optimum.x + step)[1] - _value_and_gradient(loss, optimum.x - step)[1])
            / (2.0 * _DIFFERENCE)
            for step in steps
        ]
        curvature, axes = np.linalg.eigh((np.array(gradients) + np.array(gradients).T) / 2.0)
        factor = spreads[:, None] * axes / np.sqrt(np.maximum(curvature, 1.0))
        return cls(mode=begin + spreads * optimum.x, factor=factor)

    def around(self, count: int, width: float, rng: np.random.Generator) -> Array:
        """Draw parameter vectors about the mode, `width` times as far as the posterior reaches."""
        return self.mode + width * rng.standard_normal((count, self.mode.size)) @ self.factor.T

    @property
    def moves(self) -> "list[tuple[Move, float]]":
        """Leaps anywhere in the approximation, widened, and steps of differential evolution."""
        from emcee.moves import DEMove, MHMove

        return [(MHMove(self._leap), _LEAPS), (DEMove(), 1.0 - _LEAPS)]

    def _leap(self, walkers: Array, rng: np.random.RandomState) -> tuple[Array, Array]:
        """Independent Student-t proposals, with the logarithms of their Hastings factors."""
        normal = rng.standard_normal(walkers.shape)
        longer = np.sqrt(_DEGREES / rng.chisquare(_DEGREES, (len(walkers), 1)))
        proposal = normal * longer * _WIDER
        present = np.asarray(np.linalg.solve(self.factor, (walkers - self.mode).T).T, dtype=np.float64)
        return self.mode + proposal @ self.factor.T, _log_density(present) - _log_density(proposal)


def _value_and_gradient(loss: Callable[[Array], Array], point: Array) -> tuple[float, Array]:
    """Value and central differences, all evaluated at once."""
    steps = _DIFFERENCE * np.concatenate([np.zeros((1, point.size)), np.eye(point.size), -np.eye(point.size)])
    values = loss(point + steps)
    ahead, backward_values = np.split(values[1:], 2)
    return float(values[0]), (ahead - backward_values) / (2.0 * _DIFFERENCE)


def _log_density(standard: Array) -> Array:
    """Student-t density up to a constant of standardised vectors."""
    squares = (standard**2).sum(axis=1) / _WIDER**2
    return np.asarray(-0.5 * (_DEGREES + standard.shape[1]) * np.log1p(squares / _DEGREES))
