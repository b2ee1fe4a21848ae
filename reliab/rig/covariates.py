"""Under what a test is performed, and how much of the scatter lies between groups and over time.

The quantity is y = level + Σ effects + noise; each effect is normal with a kernel matrix B_c of its own and
a variance that is learned, so that the covariance is K = 100 + Σ σ_c² B_c + σ² W⁻¹. The odd test has a small
weight in W, as under Student's t distribution of four degrees of freedom, from its residual when it is left
out. The posterior of the logarithms of all σ is drawn by importance sampling: first about its mode by its
curvature there, then about the mean of these draws by their covariance (population Monte Carlo: Cappé and
others 2004), in four independent batches from which R-hat and effective sizes come.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.core.arrays import Array

NEW = ""
"""A group of which nothing is known: its tests are like no others."""

_LENGTHS = (4.0, 40.0)
"""Tests over which the level of a rig wanders, quickly and slowly."""
_WARM = 3.0
"""Tests of a day after which a rig is warm."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Covariates:
    """Covariates of several tests, in the order of rows."""

    numbers: Mapping[str, Array] = field(default_factory=dict)  # Covariates by name
    groups: Mapping[str, NDArray[np.str_]] = field(default_factory=dict)  # Names by kind of group
    place: Array | None = None  # Place in the order of tests; None where their order means nothing

    def __len__(self) -> int:
        """Count the tests."""
        numbers = [*self.numbers.values(), *(() if self.place is None else (self.place,))]
        return max((len(values) for values in (*numbers, *self.groups.values())), default=0)


@dataclass(frozen=True, kw_only=True, eq=False)
class Kernels:
    """How alike tests are in each respect: what learned tests span, and how other tests relate to them."""

    training: Covariates
    centres: Mapping[str, tuple[float, float]]  # Centre and spread of each covariate that varies
    respects: tuple[str, ...]

    @classmethod
    def among(cls, learned: Covariates, count: int) -> "Kernels":
        """Find in which respects tests differ so that something can be learned of it."""
        centres = {
            name: (float(np.mean(values)), float(np.std(values)))
            for name, values in learned.numbers.items()
            if np.ptp(values) > 1e-9 * (1.0 + np.abs(values).max())
        }
        respects = [f"covariate {name}" for name in centres]
        for kind, names in learned.groups.items():
            sizes = np.unique(names[names != NEW], return_counts=True)[1]
            if sizes.size > 1 and (sizes > 1).any():
                respects.append(kind)
        if learned.place is not None and count > 2 * _LENGTHS[0]:
            respects += [f"time {length:g}" for length in _LENGTHS if count > 2 * length]
        return cls(training=learned, centres=centres, respects=tuple(respects))

    def among_learned(self) -> Array:
        """One matrix for each respect, shape (respects, learned, learned)."""
        return self.covariances(self.training)

    def covariances(self, targets: Covariates) -> Array:
        """One matrix for each respect, shape (respects, others, learned)."""
        matrices = np.zeros((len(self.respects), len(targets), len(self.training)))
        for matrix, respect in zip(matrices, self.respects, strict=True):
            matrix[:] = self._is_shared(respect, targets, self.training)
        return matrices

    def prior_variances(self, targets: Covariates) -> list[Array]:
        """Kernel of each other test with itself, shape (others,) for each respect."""
        units = np.ones(len(targets))
        return [
            1.0 + self._standard(respect, targets) ** 2 if respect.startswith("covariate ") else units
            for respect in self.respects
        ]

    def _is_shared(self, respect: str, targets: Covariates, training: Covariates) -> Array:
        kind, _, name = respect.partition(" ")
        if kind == "covariate":
            here, there = self._standard(respect, targets)[:, None], self._standard(respect, training)
            return np.asarray(here * there + np.exp(-0.5 * (here - there) ** 2))
        if kind == "time" and targets.place is not None and training.place is not None:
            return np.asarray(np.exp(-np.abs(targets.place[:, None] - training.place) / float(name)))
        names = targets.groups[kind][:, None]
        return np.asarray((names == training.groups[kind]) & (names != NEW), dtype=np.float64)

    def _standard(self, respect: str, covariates: Covariates) -> Array:
        name = respect.removeprefix("covariate ")
        centre, spread = self.centres[name]
        return np.asarray(np.clip((covariates.numbers[name] - centre) / spread, -4.0, 4.0))


def warmth(places_in_day: Array) -> Array:
    """How cold a rig still is at the first, second, … test of a day.

    >>> warmth(np.array([0.0, 3.0])).round(2)
    array([1.  , 0.37])
    """
    return np.asarray(np.exp(-places_in_day / _WARM))


def places_in_day(days: Iterable[str]) -> Array:
    """How many tests of the same day were before each test.

    >>> places_in_day(["2026-03-01", "2026-03-01", "2026-03-02"])
    array([0., 1., 0.])
    """
    counts: dict[str, int] = {}
    places = []
    for day in days:
        places.append(counts.get(day, 0))
        counts[day] = places[-1] + 1
    return np.array(places, dtype=np.float64)


LEVEL = 100.0  # variance of the level, in squared spreads of the values
_PRIOR = (float(np.log(0.03)), 1.5)  # of ln σ of an effect: most matter little, some do a lot
_PRIOR_OF_NOISE = (float(np.log(0.7)), 0.7)
_DEGREES = 4.0
_ROUNDS = 3
_FEWEST_FOR_ODD = 10  # tests; of fewer nobody can tell which are the odd ones
_BATCHES, _FEWEST_DRAWS, _MOST_DRAWS = 4, 40, 128
_WORK = 1e9  # draws in a batch times the cube of the tests
_POPULATIONS = 3
_PRIOR_DRAWS = 3.0  # draws for each effect, that the covariance of before counts as


@dataclass(frozen=True, kw_only=True, eq=False)
class Variances:
    """Posterior of the spreads of all effects and of the noise, of standardised values."""

    respects: tuple[str, ...]
    mode: Array  # ln σ of each effect, then of the noise
    problem: "_Problem"

    @property
    def weights(self) -> Array:
        """Weights of the tests, 1 for an ordinary one."""
        return self.problem.weights

    @property
    def draws(self) -> Array:
        """Draws of the posterior, shape (draws, effects + 1)."""
        return self._importance_sample[0]

    @property
    def r_hat(self) -> float:
        """Largest R-hat of the draws over their batches."""
        return self._importance_sample[1]

    @property
    def effective_size(self) -> float:
        """How many independent draws they are worth."""
        return self._importance_sample[2]

    @cached_property
    def _importance_sample(self) -> tuple[Array, float, float]:
        return _importance_draws(self.problem, self.mode, np.random.default_rng(0))


def fit_variances(values: Array, kernels: Array, respects: Sequence[str]) -> Variances:
    """Learn from standardised values, shape (tests,), and their kernels, shape (respects, tests, tests)."""
    priors = np.array([_PRIOR for _ in respects] + [_PRIOR_OF_NOISE])
    theta, weights = priors[:, 0].copy(), np.ones(values.size)
    for _ in range(_ROUNDS if values.size >= _FEWEST_FOR_ODD else 0):
        problem = _Problem(values=values, kernels=kernels, weights=weights, priors=priors)
        theta = problem.mode(theta)
        weights = problem.robust_weights(theta)
    problem = _Problem(values=values, kernels=kernels, weights=weights, priors=priors)
    return Variances(respects=tuple(respects), mode=problem.mode(theta), problem=problem)


def covariance(kernels: Array, theta: Array) -> Array:
    """Covariance of values without noise, from their kernels, shape (respects, others, tests)."""
    return np.asarray(LEVEL + np.tensordot(np.exp(2.0 * theta[: len(kernels)]), kernels, axes=1))


@dataclass(frozen=True, kw_only=True, eq=False)
class _Problem:
    values: Array
    kernels: Array
    weights: Array
    priors: Array  # Mean and spread of each ln σ

    def _covariance(self, theta: Array) -> Array:
        count = self.values.size
        total = covariance(self.kernels, theta)
        total[np.diag_indices(count)] += np.exp(2.0 * theta[-1]) / self.weights
        return total

    def loss(self, theta: Array) -> float:
        """Negative logarithm of the posterior density, up to a constant."""
        # LAPACK itself, which for some dozens of tests takes half the time of what is wrapped around it
        factor, lapack_status = scipy.linalg.lapack.dpotrf(self._covariance(theta).T, overwrite_a=True)
        if lapack_status:
            raise np.linalg.LinAlgError("The covariance of the tests is not positive definite.")
        white, _ = scipy.linalg.lapack.dtrtrs(factor, self.values, trans=1)
        standard = (theta - self.priors[:, 0]) / self.priors[:, 1]
        return float(0.5 * white @ white + np.log(np.diag(factor)).sum() + 0.5 * standard @ standard)

    def loss_with_gradient(self, theta: Array) -> tuple[float, Array]:
        """Return the same with its gradient."""
        inverse, logarithm = inverse_of(self._covariance(theta))
        weighted_values = inverse @ self.values
        standard = (theta - self.priors[:, 0]) / self.priors[:, 1]
        loss = 0.5 * self.values @ weighted_values + 0.5 * logarithm + 0.5 * standard @ standard
        inner = inverse - np.outer(weighted_values, weighted_values)
        effect_gradients = [
            np.exp(2.0 * log_spread) * np.vdot(inner, matrix)
            for matrix, log_spread in zip(self.kernels, theta, strict=False)
        ]
        noise_gradient = np.exp(2.0 * theta[-1]) * (np.diag(inner) / self.weights).sum()
        return float(loss), np.array([*effect_gradients, noise_gradient]) + standard / self.priors[:, 1]

    def mode(self, start: Array) -> Array:
        """Most probable ln σ."""
        bounds = [(mean - 5.0 * spread, mean + 4.0 * spread) for mean, spread in self.priors]
        found_mode = scipy.optimize.minimize(
            self.loss_with_gradient,
            start,
            jac=True,
            method="L-BFGS-B",
            bounds=bounds,
            options={"maxiter": 60},
        )
        return np.asarray(found_mode.x)

    def robust_weights(self, theta: Array) -> Array:
        """Weights of the tests by what each is when it is left out, in spreads of an ordinary test."""
        inverse, _ = inverse_of(self._covariance(theta))
        leverage = np.diag(inverse)
        variances = 1.0 / leverage + np.exp(2.0 * theta[-1]) * (1.0 - 1.0 / self.weights)
        squares = (inverse @ self.values / leverage) ** 2 / variances
        return np.asarray(np.clip((_DEGREES + 1.0) / (_DEGREES + squares), 0.02, 1.0))


def inverse_of(matrix: Array) -> tuple[Array, float]:
    """Inverse of a positive definite matrix, and the logarithm of its determinant."""
    factor, _ = scipy.linalg.cho_factor(matrix, lower=True, check_finite=False)
    inverse, _ = scipy.linalg.lapack.dpotri(factor, lower=1)
    inverse = np.where(np.tri(len(inverse), dtype=bool), inverse, inverse.T)
    return inverse, 2.0 * float(np.log(np.diag(factor)).sum())


def _importance_draws(problem: _Problem, mode: Array, rng: np.random.Generator) -> tuple[Array, float, float]:
    """Draws of the posterior, their R-hat over batches, and how many independent ones they are worth."""
    batch_size = int(np.clip(_WORK / problem.values.size**3, _FEWEST_DRAWS, _MOST_DRAWS))
    centre, factor = mode, _spread_about(problem, mode)
    for _ in range(_POPULATIONS):
        draws_of_round, weights = _weighted_draws(problem, centre, factor, _BATCHES * batch_size, rng)
        centre, factor = _moments(draws_of_round, weights, factor)
    batches = weights.reshape(_BATCHES, -1)
    means = np.einsum("bi,bip->bp", batches, draws_of_round.reshape(_BATCHES, batch_size, mode.size))
    means /= batches.sum(axis=1)[:, None]
    draws = draws_of_round[rng.choice(weights.size, size=weights.size, p=weights)]
    draw_variance = draws.var(axis=0) + 1e-12
    r_hat = float(np.sqrt(1.0 + means.var(axis=0, ddof=1) / draw_variance).max())
    return draws, r_hat, float(1.0 / (weights**2).sum())


def _weighted_draws(
    problem: _Problem, centre: Array, factor: Array, count: int, rng: np.random.Generator
) -> tuple[Array, Array]:
    """Draws of Student's t distribution, and what each counts in the posterior, with a sum of 1."""
    normal = rng.standard_normal((count, centre.size))
    normal *= np.sqrt(_DEGREES / rng.chisquare(_DEGREES, (count, 1)))
    draws = np.clip(centre + normal @ factor.T, -12.0, 6.0)
    density = -0.5 * (_DEGREES + centre.size) * np.log1p((normal**2).sum(axis=1) / _DEGREES)
    logarithms = np.array([-problem.loss(theta) for theta in draws]) - density
    weights = np.exp(logarithms - logarithms.max())
    weights = np.minimum(weights, weights.mean() * np.sqrt(count))  # truncated, Ionides 2008
    return draws, weights / weights.sum()


def _moments(draws: Array, weights: Array, factor: Array) -> tuple[Array, Array]:
    """Mean and factor of the covariance of weighted draws, the nearer to that of before the fewer count."""
    centre = weights @ draws
    spread = draws - centre
    effective_number = 1.0 / float((weights**2).sum())
    share = effective_number / (effective_number + _PRIOR_DRAWS * draws.shape[1])
    matrix = share * (weights[:, None] * spread).T @ spread + (1.0 - share) * factor @ factor.T
    return centre, np.linalg.cholesky(matrix)


def _spread_about(problem: _Problem, mode: Array) -> Array:
    """Factor of the covariance of the posterior about its mode."""
    step = 0.05
    size = mode.size
    curvature = np.empty((size, size))
    for index in range(size):
        shift = step * np.eye(size)[index]
        ahead, backward = (problem.loss_with_gradient(mode + sign * shift)[1] for sign in (1.0, -1.0))
        curvature[index] = (ahead - backward) / (2.0 * step)
    eigenvalues, axes = np.linalg.eigh(0.5 * (curvature + curvature.T))
    return np.asarray(axes / np.sqrt(np.maximum(eigenvalues, 0.5)))
