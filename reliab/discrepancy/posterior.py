"""The posterior distribution of a model's parameters, drawn by importance.

A simulation takes some ten milliseconds. Near a fitted model the whitened residual is therefore written as a
quadratic polynomial of the parameters, exact where effects enter linearly, which is fitted at points as far
from the most probable model as the data allow. The likelihood is then a quartic polynomial whose coefficients
are inner products of residuals. Whether that is good enough is checked with simulations at draws. Where it is
not, as for a hysteresis that a few cycles show, every draw is simulated.
"""

import math
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.significant_digits import percent, significant
from reliab.discrepancy.fitting.fit import CorrectedSketch, Fit
from reliab.discrepancy.fitting.problem import Problem
from reliab.sampling.importance import draw_by_importance, effective_size, weights_of

_REACH = np.sqrt(3.0)  # standard deviations: the nodes of Gauss and Hermite of order three
_WORKERS = 2

SMALLEST_AGREEMENT = 0.7
"""Share of simulated draws that importance weights leave in effect, from which the surface is trusted."""

_SEED = 2017
_CHECKS = 48  # draws at which the surface is compared with simulations
_DRAWS, _POPULATIONS = 4000, 24  # of a surface, at most so often
_INTERVAL = (0.05, 0.95)
_BADLY_KNOWN = 0.2  # relative spread of a parameter
_JOINT_SPREAD = 0.3  # spread of a product or ratio over that of its parts, below which it alone is known
_SIMULATED, _SIMULATIONS = 300, 30  # draws that are simulated at once, at most so often

ENOUGH = 100.0
"""Effective number of simulated draws from which quantiles of 5 and 95 % are trusted."""

_ENOUGH_OF_SURFACE = 2000.0  # the same where draws cost nothing


def simulate_residuals(problem: Problem | CorrectedSketch, fit: Fit, points: Iterable[Array]) -> Array:
    """Whitened residuals of a model at given coordinates."""
    with ThreadPoolExecutor(_WORKERS) as pool:
        rows = pool.map(lambda point: problem.whiten(fit.space, point, fit.noise), points)
        return np.stack(list(rows))


@dataclass(frozen=True, kw_only=True, eq=False)
class LikelihoodSurface:
    """Posterior of a model's coordinates, over standard ones in which it is nearly standard normal."""

    centre: Array  # Coordinates where the standard ones are zero, shape (size,)
    axes: Array  # Coordinates over standard ones, principal axes of the fitted covariance, shape (size, size)
    bounds: tuple[Array, Array]  # Bounds of the coordinates, shape (size,) each
    coefficients: Array  # The whitened residual over the monomials, shape (features, rows)

    @classmethod
    def around(cls, problem: Problem, fit: Fit) -> "LikelihoodSurface":
        """Simulate around a fitted model and fit the polynomial."""
        variances, directions = np.linalg.eigh(fit.covariance)
        axes = directions * np.sqrt(variances)
        points = np.clip(fit.coordinates + _design(fit.space.size) @ axes.T, *fit.space.bounds)
        standard = np.linalg.solve(axes, (points - fit.coordinates).T).T
        return cls(
            centre=fit.coordinates,
            axes=axes,
            bounds=fit.space.bounds,
            coefficients=np.linalg.pinv(_features(standard)) @ simulate_residuals(problem, fit, points),
        )

    @cached_property
    def _gram(self) -> Array:
        return self.coefficients @ self.coefficients.T

    def coordinates(self, standard: Array) -> Array:
        """Coordinates of standard ones, shape (points, size)."""
        return np.asarray(self.centre + standard @ self.axes.T)

    def log_density(self, standard: Array) -> Array:
        """Logarithm of the posterior density by the polynomial, shape (points,)."""
        features, (coordinates, is_inside) = _features(standard), self._locate(standard)
        squares = np.einsum("ki,ki->k", features @ self._gram, features)
        return np.where(is_inside, -0.5 * (squares + (coordinates**2).sum(axis=1)), -np.inf)

    def simulate_density(self, problem: Problem | CorrectedSketch, fit: Fit, standard: Array) -> Array:
        """Return the same by simulations of the fitted problem, or of its sketch."""
        coordinates, is_inside = self._locate(standard)
        logs = np.full(len(standard), -np.inf)
        if is_inside.any():
            inside = coordinates[is_inside]
            squares = (simulate_residuals(problem, fit, inside) ** 2).sum(axis=1)
            logs[is_inside] = -0.5 * (squares + (inside**2).sum(axis=1))
        return logs

    def _locate(self, standard: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Coordinates of standard ones, and whether they lie within the bounds."""
        coordinates = self.coordinates(standard)
        return coordinates, (coordinates == np.clip(coordinates, *self.bounds)).all(axis=1)


def _design(size: int) -> Array:
    """Points that determine a quadratic polynomial, shape ((size + 1)(size + 2)/2, size)."""
    unit = _REACH * np.eye(size)
    pairs = [unit[i] + unit[j] for i, j in combinations(range(size), 2)]
    return np.vstack([np.zeros((1, size)), unit, -unit, *(pair[np.newaxis] / np.sqrt(2.0) for pair in pairs)])


def _features(standard: Array) -> Array:
    """Monomials up to the second degree, shape (points, features)."""
    i, j = np.triu_indices(standard.shape[1])
    return np.column_stack([np.ones(len(standard)), standard, standard[:, i] * standard[:, j]])


@dataclass(frozen=True, kw_only=True, eq=False)
class Posterior:
    """Posterior of a model's parameters."""

    names: tuple[str, ...]  # names, units: Parameters, those of effects as "effect.parameter"
    units: tuple[str, ...]
    meanings: tuple[str, ...]  # Parameters in words
    draws: Array  # Values in SI units, shape (draws, parameters)
    effective: float  # Number of independent draws that say as much as the weighted ones
    agreement: float  # Share of simulated draws that their importance weights leave in effect [-]
    simulated: bool  # Whether every draw was simulated, because the surface did not agree with simulations

    @property
    def converged(self) -> bool:
        """Whether enough draws are in effect."""
        return self.effective >= ENOUGH

    @property
    def statement(self) -> str:
        """One sentence on convergence."""
        digit = 10.0 ** max(math.floor(math.log10(max(self.effective, 1.0))) - 1, 0)
        number = int(self.effective // digit * digit)  # of two digits, downwards
        count = f"{number} {'simulated ' if self.simulated else ''}draws in effect"
        if not self.converged:
            return (
                f"The parameters' distributions have not converged: {count}, {ENOUGH:.0f} are needed. "
                "The tests hardly tell some parameters apart: measure cycles of other amplitudes and speeds."
            )
        check = "" if self.simulated else f", of which {_CHECKS} were checked by simulation"
        return f"The parameters' distributions have converged: {count}{check}."

    def spread_of(self, name: str) -> tuple[float, float, float]:
        """Return standard deviation and ends of the central 90 % interval of a parameter, in its unit."""
        draws = self.draws[:, self.names.index(name)]
        low, high = np.quantile(draws, _INTERVAL).tolist()
        return float(draws.std(ddof=1)), low, high

    def inseparable(self, effects: Sequence[str]) -> tuple[str, ...]:
        """Say which pairs of parameters of an effect the tests show in combination only, and how large it is.

        Both are known badly by themselves, and their product or ratio is known well.
        """
        sentences = []
        for effect in effects:
            places = [k for k, name in enumerate(self.names) if name.startswith(f"{effect}.")]
            for pair in combinations(places, 2):
                draws = self.draws[:, pair]
                if not (draws > 0.0).all():
                    continue
                logs = np.log(draws)
                is_ratio = float(np.corrcoef(logs.T)[0, 1]) > 0.0
                combination = logs[:, 0] + (-logs[:, 1] if is_ratio else logs[:, 1])
                least = logs.std(axis=0).min()
                if least > _BADLY_KNOWN and combination.std() < _JOINT_SPREAD * least:
                    sentences.append(
                        f"The tests do not tell {' and '.join(self.meanings[k] for k in pair)} of "
                        f"{effect.replace('_', ' ')} apart: their {'ratio' if is_ratio else 'product'} is "
                        f"{significant(float(np.exp(combination.mean())))} ± "
                        f"{percent(float(combination.std()), 2)}."
                    )
        return tuple(sentences)


def sample_posterior(problem: Problem, fit: Fit) -> Posterior:
    """Sample the posterior distribution of a fitted model.

    Calibrations and offsets are sampled along with the effects; the noise is as fitted.
    """
    surface, space = LikelihoodSurface.around(problem, fit), fit.space
    draws, effective = draw_by_importance(
        surface.log_density,
        space.size,
        np.random.default_rng(_SEED),
        draws=_DRAWS,
        population=_DRAWS,
        populations=_POPULATIONS,
        enough=_ENOUGH_OF_SURFACE,
    )
    agreement = 0.0 if effective < ENOUGH else agreement_of(problem, fit, surface, draws[:_CHECKS])
    is_simulated = agreement < SMALLEST_AGREEMENT
    if is_simulated:
        sketch = CorrectedSketch(problem.sketch, fit)
        draws, effective = draw_by_importance(
            lambda standard: surface.simulate_density(sketch, fit, standard),
            space.size,
            np.random.default_rng(_SEED),
            draws=_DRAWS,
            population=_SIMULATED,
            populations=_SIMULATIONS,
            enough=ENOUGH,
        )
    exact = np.stack([space.values(point) for point in np.clip(surface.coordinates(draws), *surface.bounds)])
    model_noise = np.random.default_rng(_SEED).standard_normal(exact.shape)  # the error of the model
    return Posterior(
        names=space.keys,
        units=tuple(parameter.units for parameter in space.parameters),
        meanings=tuple(parameter.meaning for parameter in space.parameters),
        draws=exact + space.model_errors(exact) * model_noise,
        effective=effective,
        agreement=agreement,
        simulated=is_simulated,
    )


def agreement_of(problem: Problem, fit: Fit, surface: LikelihoodSurface, draws: Array) -> float:
    """Effective share of draws of a surface under importance weights from it to simulations."""
    ratios = surface.simulate_density(problem, fit, draws) - surface.log_density(draws)
    return effective_size(weights_of(ratios)) / len(draws)
