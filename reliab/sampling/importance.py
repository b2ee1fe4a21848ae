"""Draws from a density that is nearly normal, by adaptive importance sampling."""

from collections.abc import Callable

import numpy as np
import scipy

from reliab.core.arrays import Array

_GUIDING = 40.0  # effective number of draws around which the next ones are drawn
_LEAST_VARIANCE = 1e-3  # of a standard coordinate
_WIDER, _FREEDOM = 1.3, 5.0  # spread of a population over that before it, and Student's degrees of freedom


def draw_by_importance(
    log_density: Callable[[Array], Array],
    size: int,
    rng: np.random.Generator,
    *,
    draws: int,
    population: int,
    populations: int,
    enough: float,
) -> tuple[Array, float]:
    """Draw from a density that is nearly standard normal, shape (draws, size); the effective number, too.

    Every population is drawn from a distribution of Student around the weighted draws before it, and all of
    them count as draws of one mixture (adaptive multiple importance sampling of Cornuet and others 2012,
    doi:10.1111/j.1467-9469.2011.00756.x), until `enough` are in effect, or so many `populations` were drawn.
    `log_density` of shape (points,) is −∞ beyond bounds.

    >>> rng = np.random.default_rng(1)
    >>> drawn, effective = draw_by_importance(
    ...     lambda x: -0.5 * ((x[:, 0] - 1.0) / 0.5) ** 2, 1, rng,
    ...     draws=2000, population=500, populations=9, enough=400.0,
    ... )
    >>> bool(abs(drawn.mean() - 1.0) < 0.1 and abs(drawn.std() - 0.5) < 0.05 and effective >= 400.0)
    True
    """
    mean: Array = np.zeros(size)
    covariance = np.eye(size)
    points, logs = np.zeros((0, size)), np.zeros(0)
    weights, mixture, mixed = np.zeros(0), [], np.zeros(0)
    for _ in range(populations):
        shape = _WIDER**2 * covariance + _LEAST_VARIANCE * np.eye(size)
        mixture.append((mean, np.asarray(np.linalg.cholesky(shape))))
        fresh = _draw_student(mean, shape, population, rng)
        fresh_logs = log_density(fresh)
        possible = np.isfinite(fresh_logs)
        fresh = fresh[possible]
        fresh_mixed = np.logaddexp.reduce([_log_student(fresh, *component) for component in mixture])
        mixed = np.concatenate([np.logaddexp(mixed, _log_student(points, *mixture[-1])), fresh_mixed])
        points = np.concatenate([points, fresh])
        logs = np.concatenate([logs, fresh_logs[possible]])
        if len(points) <= size:
            break
        ratios = logs - mixed
        weights = weights_of(ratios)
        if effective_size(weights) >= enough:
            break
        while effective_size(weights_of(ratios)) < min(_GUIDING, 0.5 * len(points)):
            ratios = 0.5 * ratios
        mean = np.average(points, axis=0, weights=weights_of(ratios))
        covariance = np.atleast_2d(np.cov(points.T, aweights=weights_of(ratios)))
    if not weights.size:
        return rng.standard_normal((draws, size)), 1.0
    return points[rng.choice(len(points), draws, p=weights)], effective_size(weights)


def _draw_student(mean: Array, shape: Array, count: int, rng: np.random.Generator) -> Array:
    """Draw from a distribution of Student, shape (count, size)."""
    widths = np.sqrt(rng.chisquare(_FREEDOM, count) / _FREEDOM)
    return mean + rng.multivariate_normal(np.zeros(mean.size), shape, count) / widths[:, np.newaxis]


def _log_student(points: Array, mean: Array, root: Array) -> Array:
    """Logarithm of the density of Student with a root of the shape, up to a constant, shape (points,)."""
    standard = scipy.linalg.solve_triangular(root, (points - mean).T, lower=True)
    powers = np.log1p((standard**2).sum(axis=0) / _FREEDOM)
    return np.asarray(-0.5 * (_FREEDOM + mean.size) * powers - np.log(np.diag(root)).sum())


def weights_of(logarithms: Array) -> Array:
    """Weights that sum to one, of their logarithms."""
    weights = np.exp(logarithms - logarithms.max())
    return np.asarray(weights / weights.sum())


def effective_size(weights: Array) -> float:
    """Effective number of weighted draws.

    >>> effective_size(np.array([0.5, 0.5, 0.0]))
    2.0
    """
    return float(weights.sum() ** 2 / (weights**2).sum())
