"""The posterior distribution of a model's parameters, sampled by independent ensembles of walkers.

A simulation takes some ten milliseconds and an ensemble sampler asks for a hundred thousand. Near a fitted
model the whitened residual is therefore written as a quadratic polynomial of the parameters, exact where
effects enter linearly, which is fitted at points as far from the most probable model as the data allow. The
likelihood is then a quartic polynomial whose coefficients are inner products of residuals. Whether that is
good enough is checked with simulations at draws.
"""

import warnings
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from itertools import combinations
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.significant_digits import percent
from reliab.discrepancy.fitting.fit import Fit
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.fitting.space import ModelSpace
from reliab.sampling.ensembles import Ensembles, sample
from reliab.sampling.model import Model, Parameter
from reliab.sampling.posterior_sample import PosteriorSample

_REACH = np.sqrt(3.0)  # standard deviations: the nodes of Gauss and Hermite of order three
_WIDE = 10.0  # standard deviations within which the mode is looked for
_WALL = 1e9  # stands for infinity where walkers may still start
_WORKERS = 2

SMALLEST_AGREEMENT = 0.7
"""Share of simulated draws that importance weights leave in effect, from which the surface is trusted."""

_SEED = 2017
_THIN = 8  # steps to a kept draw, of which a file takes milliseconds each
_CHECKED = 48  # draws at which the surface is compared with simulations
_DRAWS = 4000
_INTERVAL = (0.05, 0.95)


def simulated(problem: Problem, fitted: Fit, points: Iterable[Array]) -> Array:
    """Whitened residuals of a model at given coordinates."""
    with ThreadPoolExecutor(_WORKERS) as pool:
        rows = pool.map(lambda point: problem.whitened(fitted.space, point, fitted.noise), points)
        return np.stack(list(rows))


@dataclass(frozen=True, kw_only=True, eq=False)
class LikelihoodSurface(Model):
    """Posterior of a model's coordinates, in standard ones in which it is nearly standard normal."""

    name: ClassVar[str] = "likelihood surface"

    names: tuple[str, ...]  # Standard coordinates, principal axes of the fitted covariance
    centre: Array  # Coordinates where the standard ones are zero, shape (size,)
    axes: Array  # Coordinates over standard ones, shape (size, size)
    bounds: tuple[Array, Array]  # Bounds of the coordinates, shape (size,) each
    coefficients: Array  # The whitened residual over the monomials, shape (features, rows)

    @classmethod
    def around(cls, problem: Problem, fitted: Fit) -> "LikelihoodSurface":
        """Simulate around a fitted model and fit the polynomial."""
        variances, directions = np.linalg.eigh(fitted.covariance)
        axes = directions * np.sqrt(variances)
        points = np.clip(fitted.coordinates + _design(fitted.space.size) @ axes.T, *fitted.space.bounds)
        standard = np.linalg.solve(axes, (points - fitted.coordinates).T).T
        return cls(
            names=tuple(f"axis {k}" for k in range(fitted.space.size)),
            centre=fitted.coordinates,
            axes=axes,
            bounds=fitted.space.bounds,
            coefficients=np.linalg.pinv(_features(standard)) @ simulated(problem, fitted, points),
        )

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """Standard coordinates; their spread is how far the mode is looked for, not that of the prior."""
        return tuple(Parameter(name=name, mean=0.0, spread=_WIDE) for name in self.names)

    @property
    def data(self) -> Array:
        """Coefficients of the residual and where they hold."""
        return np.concatenate([self.coefficients.ravel(), self.centre, self.axes.ravel()])

    @cached_property
    def _gram(self) -> Array:
        return self.coefficients @ self.coefficients.T

    def coordinates(self, theta: Array) -> Array:
        """Coordinates of standard ones, shape (..., size)."""
        return np.asarray(self.centre + theta @ self.axes.T)

    def log_prior(self, theta: Array) -> Array:
        """Log-density of the prior, standard normal in the model's coordinates, negligible beyond bounds."""
        coordinates = self.coordinates(theta)
        overshoot = np.abs(coordinates - np.clip(coordinates, *self.bounds)).sum(axis=1)
        walls = np.where(overshoot > 0.0, _WALL * (1.0 + overshoot), 0.0)
        return np.asarray(-0.5 * (coordinates**2).sum(axis=1) - walls)

    def draw_prior(self, count: int, rng: np.random.Generator) -> Array:
        """Draw standard coordinates from the prior, shape (count, size)."""
        drawn = np.clip(rng.standard_normal((count, self.centre.size)), *self.bounds)
        return np.asarray(np.linalg.solve(self.axes, (drawn - self.centre).T).T)

    def log_likelihood(self, theta: Array) -> Array:
        """Log-likelihood at standard coordinates, shape (points, size) to (points,)."""
        features = _features(theta)
        return np.asarray(-0.5 * np.einsum("ki,ki->k", features @ self._gram, features))

    def simulate(self, theta: Array, rng: np.random.Generator) -> "LikelihoodSurface":
        """Return the surface of data drawn at standard coordinates, shape (size,)."""
        changed = self.coefficients.copy()
        changed[0] += (
            rng.standard_normal(changed.shape[1]) - (_features(theta[np.newaxis]) @ self.coefficients)[0]
        )
        return replace(self, coefficients=changed)


def log_density(residuals: Array, coordinates: Array) -> Array:
    """Logarithm of the posterior density from simulated residuals, shape (points,)."""
    return np.asarray(-0.5 * (residuals**2).sum(axis=1) - 0.5 * (coordinates**2).sum(axis=1))


def _design(size: int) -> Array:
    """Points that determine a quadratic polynomial, shape ((size + 1)(size + 2)/2, size)."""
    unit = _REACH * np.eye(size)
    pairs = [unit[i] + unit[j] for i, j in combinations(range(size), 2)]
    return np.vstack([np.zeros((1, size)), unit, -unit, *(pair[np.newaxis] / np.sqrt(2.0) for pair in pairs)])


def _features(standard: Array) -> Array:
    """Monomials up to the second degree, shape (points, features)."""
    i, j = _pairs(standard.shape[1])
    return np.column_stack([np.ones(len(standard)), standard, standard[:, i] * standard[:, j]])


@cache
def _pairs(size: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Factors of the monomials of the second degree; walkers ask for them thousands of times."""
    i, j = np.triu_indices(size)
    return i, j


@dataclass(frozen=True, kw_only=True, eq=False)
class Posterior:
    """Posterior of a model's parameters."""

    names: tuple[str, ...]  # names, units: Parameters, those of effects as "effect.parameter"
    units: tuple[str, ...]
    draws: Array  # Values in SI units, shape (draws, parameters)
    sample: PosteriorSample = field(repr=False)  # The chains with their diagnostics
    # Share of simulated draws that their importance weights leave in effect [-]; 1 where the surface on which
    # walkers moved is exact
    agreement: float

    @property
    def mean(self) -> Array:
        """Means in SI units, shape (parameters,)."""
        return np.asarray(self.draws.mean(axis=0))

    @property
    def sd(self) -> Array:
        """Standard deviations in SI units, shape (parameters,)."""
        return np.asarray(self.draws.std(axis=0, ddof=1))

    @property
    def interval(self) -> Array:
        """Ends of the central 90 % intervals in SI units, shape (2, parameters)."""
        return np.asarray(np.quantile(self.draws, _INTERVAL, axis=0))

    @property
    def converged(self) -> bool:
        """Whether walkers mixed and the surface agrees with simulations."""
        return self.sample.converged and self.agreement >= SMALLEST_AGREEMENT

    @property
    def statement(self) -> str:
        """One sentence on convergence."""
        diagnostics = self.sample.diagnostics
        smallest = min(diagnostics.bulk_size.min(), diagnostics.tail_size.min())
        verdict = "Converged" if self.converged else "Not converged"
        return (
            f"{verdict}: {diagnostics.ensembles} independent ensembles, R-hat at most "
            f"{diagnostics.r_hat.max():.3f}, "
            f"effective sample size at least {smallest:.0f}; simulations at {_CHECKED} draws "
            f"confirm the surface that was sampled to {percent(self.agreement, decimals=0)}."
        )

    def parameters_of(self, effect: str) -> dict[str, dict[str, Any]]:
        """Return means, standard deviations, 90 % intervals and units of an effect's parameters by name."""
        low, high = self.interval.tolist()
        rows = zip(self.names, self.units, self.mean.tolist(), self.sd.tolist(), low, high, strict=True)
        return {
            name.removeprefix(f"{effect}."): {
                "value": mean,
                "sd": sd,
                "interval_90": [low, high],
                "units": units,
            }
            for name, units, mean, sd, low, high in rows
            if name.startswith(f"{effect}.")
        }


def sample_posterior(
    problem: Problem,
    fitted: Fit,
    *,
    out: Path | None = None,
    steps: int = 800,
) -> Posterior:
    """Sample the posterior distribution of a fitted model.

    Calibrations and offsets are sampled along with the effects; the noise is as fitted. Walkers move on a
    surface that a few simulations determine, see :mod:`reliab.discrepancy.adding.posterior`, and
    simulations at draws check it.
    """
    surface = LikelihoodSurface.around(problem, fitted)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # convergence is said in the statement
        sampled = sample(surface, Ensembles(steps=steps, thin=_THIN, seed=_SEED), file=out)
    coordinates = surface.coordinates(sampled.spread_out(_DRAWS))
    return Posterior(
        names=_names(fitted.space),
        units=tuple(parameter.units for parameter in fitted.space.parameters),
        draws=_values(fitted.space, coordinates),
        sample=sampled,
        agreement=_agreement(problem, fitted, surface, sampled.spread_out(_CHECKED)),
    )


def _values(space: ModelSpace, coordinates: Array) -> Array:
    """SI values with the error of the model, shape (draws, parameters)."""
    exact = np.stack([space.values(point) for point in coordinates])
    strayed = np.random.default_rng(_SEED).standard_normal(exact.shape)
    return exact + space.model_errors(exact) * strayed


def _names(space: ModelSpace) -> tuple[str, ...]:
    calibrated = (calibration.parameter.name for calibration in space.block.calibrations)
    effects = (*space.block.offsets, *space.effects)
    return (
        *calibrated,
        *(f"{effect.name}.{parameter.name}" for effect in effects for parameter in effect.parameters),
    )


def _agreement(problem: Problem, fitted: Fit, surface: LikelihoodSurface, drawn: Array) -> float:
    """Effective share of draws under importance weights from surface to simulation."""
    coordinates = surface.coordinates(drawn)
    exact = log_density(simulated(problem, fitted, coordinates), coordinates)
    ratios = exact - surface.log_posterior(drawn)
    weights = np.exp(ratios - ratios.max())
    return float(weights.sum() ** 2 / (weights**2).sum() / len(drawn))
