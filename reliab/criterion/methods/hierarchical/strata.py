"""The scatter of ln α and ln β over motions and structures, divided into independent strata.

On a complete grid, orthonormal contrasts along ln f and along ln ξ turn correlated values into independent
ones. Each stratum's covariance is a weighted sum of the covariances of the effects that reach it, so that
motion effects are integrated out exactly and a likelihood costs as much for a hundred motions as for ten.

A covariance is kept as its three numbers [variance of a, variance of b, covariance], last axis 3, so that
thousands of them are handled at once.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from reliab.core.arrays import Array
from reliab.sampling.ensembles import SampledParameter


def covariance_parameters(prefix: str, typical_spread: float) -> tuple[SampledParameter, ...]:
    """Parameters of one covariance with their priors.

    Returns ln σ_a, ln σ_b ~ N(ln typical, 0.8²) and artanh ρ ~ N(1.5, 0.75²): a and b are expected to move
    together (ρ of 0.9), with −0.03 … 0.995 allowed.
    """
    return (
        SampledParameter(name=f"{prefix}: log spread of a", mean=float(np.log(typical_spread)), spread=0.8),
        SampledParameter(name=f"{prefix}: log spread of b", mean=float(np.log(typical_spread)), spread=0.8),
        SampledParameter(name=f"{prefix}: Fisher z", mean=1.5, spread=0.75),
    )


def covariance_of(theta: Array) -> Array:
    """Covariance of sampled parameters, last axis 3 to 3.

    >>> covariance_of(np.array([0.0, np.log(2.0), np.arctanh(0.5)])).round(6)
    array([1., 4., 1.])
    """
    a, b = np.exp(theta[..., 0]), np.exp(theta[..., 1])
    return np.stack([a**2, b**2, np.tanh(theta[..., 2]) * a * b], axis=-1)


def normal_log_density(covariance: Array, squares: Array, count: float | Array) -> Array:
    """Log-density up to a constant of pairs with mean zero, by their sums of squares.

    `covariance`, `squares` (..., 3); returns (...).
    """
    determinant = covariance[..., 0] * covariance[..., 1] - covariance[..., 2] ** 2
    return np.asarray(-0.5 * (count * np.log(determinant) + distance(covariance, squares, determinant)))


def distance(covariance: Array, squares: Array, determinant: Array) -> Array:
    """Trace of covariance⁻¹ squares, shape (...)."""
    cross_terms = covariance[..., 1] * squares[..., 0] + covariance[..., 0] * squares[..., 1]
    return np.asarray((cross_terms - 2.0 * covariance[..., 2] * squares[..., 2]) / determinant)


def squares_of(pairs: Array) -> Array:
    """Products a², b² and ab of pairs, last axis 2 to 3."""
    a, b = pairs[..., 0], pairs[..., 1]
    return np.stack([a * a, b * b, a * b], axis=-1)


def factor_of(covariance: Array) -> Array:
    """Lower Cholesky factors, last axis 3 to (2, 2)."""
    first = np.sqrt(covariance[..., 0])
    off_diagonal = covariance[..., 2] / first
    second = np.sqrt(np.maximum(covariance[..., 1] - off_diagonal**2, 0.0))
    rows = [np.stack([first, np.zeros_like(first)], axis=-1), np.stack([off_diagonal, second], axis=-1)]
    return np.stack(rows, axis=-2)


EVENT: Final = "event"
MOTION: Final = "motion"
MOTION_SLOPE: Final = "motion, slope in ln ξ"
FREQUENCY: Final = "motion at a frequency"
FREQUENCY_SLOPE: Final = "motion at a frequency, slope in ln ξ"
REMAINDER: Final = "remainder"


@dataclass(frozen=True, kw_only=True, eq=False)
class ComparedStructures:
    """Structures over which motions are compared.

    >>> ComparedStructures(frequencies=np.array([1.0]), damping_ratios=np.array([0.02, 0.05])).effects
    ('event', 'motion', 'motion, slope in ln ξ')
    """

    frequencies: Array  # frequencies, damping_ratios: The grid [Hz, -], shape (F,) and (X,)
    damping_ratios: Array

    @property
    def shape(self) -> tuple[int, int]:
        """(F, X)."""
        return self.frequencies.size, self.damping_ratios.size

    @property
    def eta(self) -> Array:
        """Ln ξ about its mean, shape (X,)."""
        logarithms = np.log(self.damping_ratios)
        return np.asarray(logarithms - logarithms.mean())

    @property
    def bases(self) -> tuple[Array, Array]:
        """Orthonormal contrasts in columns along f and ξ: mean first, along ξ then slope, then the rest."""
        f_count, xi_count = self.shape
        f_basis = np.linalg.qr(np.column_stack([np.ones(f_count), np.eye(f_count)]))[0]
        linear = [np.ones(xi_count), self.eta] if xi_count > 1 else [np.ones(xi_count)]
        return f_basis, np.linalg.qr(np.column_stack([*linear, np.eye(xi_count)]))[0]

    @property
    def effects(self) -> tuple[str, ...]:
        """Effects that the grid can separate, that of the event first."""
        f_count, xi_count = self.shape
        wide, has_damping, has_curvature = f_count > 1, xi_count > 1, xi_count > 2  # noqa: PLR2004 - a slope takes two
        possible = (
            (EVENT, True),
            (MOTION, True),
            (MOTION_SLOPE, has_damping),
            (FREQUENCY, wide),
            (FREQUENCY_SLOPE, wide and has_damping),
            (REMAINDER, has_curvature),
        )
        return tuple(name for name, present in possible if present)


@dataclass(frozen=True, kw_only=True, eq=False)
class Strata:
    """Sums over the pairs (ln α, ln β) of each stratum, which are independent given the law."""

    # Weight of each effect's covariance in that of each stratum, shape (strata, effects)
    weights: Array
    counts: Array  # Numbers of pairs, shape (strata,)
    # Sums of products of the terms and values of each pair, shape (strata, terms + 2, terms + 2)
    products: Array

    def log_likelihood(self, coefficients: Array, covariances: Array) -> Array:
        """Log-likelihood up to a constant.

        `coefficients` (vectors, terms, 2); `covariances` (vectors, effects, 3); returns (vectors,).
        """
        identity = np.broadcast_to(np.eye(2), (len(coefficients), 2, 2))
        residual = np.concatenate([-coefficients, identity], axis=1)[:, None]  # values minus the law
        squares = residual.swapaxes(-1, -2) @ self.products @ residual
        about = np.stack([squares[..., 0, 0], squares[..., 1, 1], squares[..., 0, 1]], axis=-1)
        covariance = self.weights @ covariances
        return np.asarray(normal_log_density(covariance, about, self.counts).sum(axis=1))


def divide(grid: ComparedStructures, values: Array, terms: Array) -> Strata:
    """Divide values into the strata below that of the motions' means.

    `values` (motions, F, X, 2); `terms` (F, X, terms).
    """
    basis_f, basis_xi = grid.bases
    y = np.einsum("mfxq,fi,xj->mijq", values, basis_f, basis_xi)
    t = np.broadcast_to(
        np.einsum("fxk,fi,xj->ijk", terms, basis_f, basis_xi), (*y.shape[:3], terms.shape[-1])
    )
    both = np.concatenate([t, y], axis=-1)
    damping = float((grid.eta**2).sum())
    first, slope, bends = slice(0, 1), slice(1, 2), slice(2, None)
    contrasts = slice(1, None)
    places = (
        (contrasts, first, {FREQUENCY: float(grid.shape[1]), REMAINDER: 1.0}),
        (
            first,
            slope,
            {MOTION_SLOPE: grid.shape[0] * damping, FREQUENCY_SLOPE: damping, REMAINDER: 1.0},
        ),
        (contrasts, slope, {FREQUENCY_SLOPE: damping, REMAINDER: 1.0}),
        (slice(None), bends, {REMAINDER: 1.0}),
    )
    pairs_of_strata = [
        (both[:, basis_f, basis_xi].reshape(-1, both.shape[-1]), w) for basis_f, basis_xi, w in places
    ]
    present = [(pairs, weights) for pairs, weights in pairs_of_strata if pairs.size]
    return Strata(
        weights=np.array([_weights(grid, stratum) for _, stratum in present]).reshape(-1, len(grid.effects)),
        counts=np.array([float(len(pairs)) for pairs, _ in present]),
        products=np.array([pairs.T @ pairs for pairs, _ in present]).reshape(-1, *(both.shape[-1],) * 2),
    )


def weights_of_motion_mean(grid: ComparedStructures) -> Array:
    """Weight of each effect in the mean of a motion over all structures, about its earthquake.

    Returns (effects,).
    """
    f_count, xi_count = grid.shape
    return _weights(grid, {MOTION: 1.0, FREQUENCY: 1.0 / f_count, REMAINDER: 1.0 / (f_count * xi_count)})


def weights_of_motion(grid: ComparedStructures) -> Array:
    """Weight of each effect in the covariance of one motion of a further earthquake.

    Returns (X, effects).
    """
    squares = grid.eta**2
    return np.stack(
        [
            squares if effect in {MOTION_SLOPE, FREQUENCY_SLOPE} else np.ones_like(squares)
            for effect in grid.effects
        ],
        axis=-1,
    )


def _weights(grid: ComparedStructures, weight_of_stratum: dict[str, float]) -> Array:
    return np.array([weight_of_stratum.get(effect, 0.0) for effect in grid.effects])
