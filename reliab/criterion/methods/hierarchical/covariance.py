"""Covariances of two quantities, sampled as logarithms of the spreads and Fisher's z of the correlation.

A covariance is kept as its three numbers [variance of a, variance of b, covariance], last axis 3, so that
thousands of them are handled at once.
"""

import numpy as np

from reliab.core.arrays import Array
from reliab.sampling.model import Parameter


def covariance_parameters(prefix: str, typical_spread: float) -> tuple[Parameter, ...]:
    """Parameters of one covariance with their priors.

    Returns ln σ_a, ln σ_b ~ N(ln typical, 0.8²) and artanh ρ ~ N(1.5, 0.75²): a and b are expected to move
    together (ρ of 0.9), with −0.03 … 0.995 allowed.
    """
    return (
        Parameter(name=f"{prefix}: log spread of a", mean=float(np.log(typical_spread)), spread=0.8),
        Parameter(name=f"{prefix}: log spread of b", mean=float(np.log(typical_spread)), spread=0.8),
        Parameter(name=f"{prefix}: Fisher z", mean=1.5, spread=0.75),
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
    crossed = covariance[..., 1] * squares[..., 0] + covariance[..., 0] * squares[..., 1]
    return np.asarray((crossed - 2.0 * covariance[..., 2] * squares[..., 2]) / determinant)


def squares_of(pairs: Array) -> Array:
    """Products a², b² and ab of pairs, last axis 2 to 3."""
    a, b = pairs[..., 0], pairs[..., 1]
    return np.stack([a * a, b * b, a * b], axis=-1)


def factor_of(covariance: Array) -> Array:
    """Lower Cholesky factors, last axis 3 to (2, 2)."""
    first = np.sqrt(covariance[..., 0])
    mixed = covariance[..., 2] / first
    second = np.sqrt(np.maximum(covariance[..., 1] - mixed**2, 0.0))
    rows = [np.stack([first, np.zeros_like(first)], axis=-1), np.stack([mixed, second], axis=-1)]
    return np.stack(rows, axis=-2)
