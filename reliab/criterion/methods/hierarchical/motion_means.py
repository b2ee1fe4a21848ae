"""Likelihood of the motions' means over all structures, with event effects integrated out."""

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.compiled import compiled
from reliab.criterion.methods.hierarchical.covariance import normal_log_density, squares_of


@compiled
def log_distances(
    strayed: Array,
    effects: Array,
    groups: NDArray[np.int64],
    degrees: Array,
) -> Array:
    """Sum ln(1 + d²/ν) over the motions of each earthquake."""
    vectors, events, nodes, _ = effects.shape
    sums = np.zeros((vectors, events, nodes))
    for vector in range(vectors):
        share = 1.0 / degrees[vector]
        for motion in range(groups.size):
            event = groups[motion]
            first, second = strayed[vector, motion, 0], strayed[vector, motion, 1]
            for node in range(nodes):
                along = first - effects[vector, event, node, 0]
                across = second - effects[vector, event, node, 1]
                sums[vector, event, node] += np.log(1.0 + share * (along * along + across * across))
    return sums


_NODES: Final = 7  # Gauss-Hermite nodes along each of two directions
_ROUNDS: Final = 6  # reweighted means that place them


@dataclass(frozen=True, kw_only=True, eq=False)
class MotionMeans:
    """Means of ln α and ln β of each motion over all structures, grouped by earthquake."""

    means: Array  # The means, shape (motions, 2)
    groups: NDArray[np.int64]  # Number of each motion's earthquake, from zero, shape (motions,)

    def normal(
        self,
        centre: Array,
        between: Array,
        within: Array,
    ) -> Array:
        """Log-likelihood with normal event and motion effects.

        `centre` (vectors, 2); `between`, `within` (vectors, 3); returns (vectors,).
        """
        sizes, event_means, scatter = self._by_event
        below = normal_log_density(within, scatter, float(self.groups.size - sizes.size))
        of_mean = between[:, None, :] + within[:, None, :] / sizes[:, None]
        strayed = squares_of(event_means - centre[:, None, :])
        return np.asarray(below + normal_log_density(of_mean, strayed, 1.0).sum(axis=1))

    def robust(
        self,
        centre: Array,
        between: Array,
        within: Array,
        degrees: Array,
    ) -> Array:
        """Log-likelihood with normal event effects and bivariate Student-t motions about them.

        The event effects are integrated out by Gauss–Hermite quadrature about their conditional mode,
        which is found by reweighting.

        `degrees` (vectors,); returns (vectors,).
        """
        # In coordinates in which the scale is the identity, distances are Euclidean.
        whitening = _inverse_of_triangle(_cholesky(_matrix(within)))
        strayed = np.einsum("wij,wmj->wmi", whitening, self.means - centre[:, None, :])
        prior = whitening @ _matrix(between) @ whitening.swapaxes(-1, -2)
        mode, precision = self._conditional(strayed, _inverse(prior), degrees)
        directions = _inverse_of_triangle(_cholesky(precision)).swapaxes(-1, -2)
        nodes, weights = _nodes()
        effects = mode[:, :, None, :] + nodes @ directions.swapaxes(-1, -2)
        log_weights = weights + 0.5 * (nodes**2).sum(axis=1)
        integrand = self._integrand(strayed, effects, prior, degrees) + log_weights
        peak = integrand.max(axis=2)
        area = np.log(np.exp(integrand - peak[..., None]).sum(axis=2))
        of_events = (peak + area - 0.5 * np.log(_determinant(precision))).sum(axis=1)
        return np.asarray(of_events - 0.5 * self.groups.size * np.log(_determinant(_matrix(within))))

    @cached_property
    def _by_event(self) -> tuple[NDArray[np.int64], Array, Array]:
        """Sizes of the earthquakes, their means, and the squares about these."""
        sizes = np.bincount(self.groups)
        event_means = self._event_sums(self.means) / sizes[:, None]
        return sizes, event_means, squares_of(self.means - event_means[self.groups]).sum(axis=0)

    def _event_sums(self, values: Array) -> Array:
        """Sum motions of each earthquake along the last axis but one."""
        order = np.argsort(self.groups, kind="stable")
        starts = np.flatnonzero(np.diff(self.groups[order], prepend=-1))
        return np.asarray(np.add.reduceat(values[..., order, :], starts, axis=-2))

    def _conditional(self, strayed: Array, prior: Array, degrees: Array) -> tuple[Array, Array]:
        """Mode (vectors, events, 2) of the event effects and precision (vectors, events, 2, 2) about it."""
        weight = np.ones((*strayed.shape[:2], 1))
        for _ in range(_ROUNDS):
            precision = prior[:, None] + self._event_sums(weight)[..., None] * np.eye(2)
            pull = self._event_sums(weight * strayed)
            mode = (_inverse(precision) @ pull[..., None])[..., 0]
            distance_squared = ((strayed - mode[:, self.groups]) ** 2).sum(axis=2, keepdims=True)
            weight = (degrees[:, None, None] + 2.0) / (degrees[:, None, None] + distance_squared)
        return np.asarray(mode), np.asarray(precision, dtype=np.float64)

    def _integrand(
        self,
        strayed: Array,
        effects: Array,
        prior: Array,
        degrees: Array,
    ) -> Array:
        """Log-density of effects and motions in whitened coordinates, shape (vectors, events, nodes)."""
        motions = log_distances(strayed, effects, self.groups, degrees)
        factor = _inverse_of_triangle(_cholesky(prior))
        standard = effects @ factor.swapaxes(-1, -2)[:, None]
        events = -0.5 * (standard**2).sum(axis=-1) + np.log(_determinant(factor))[:, None, None]
        return np.asarray(events - 0.5 * (degrees[:, None, None] + 2.0) * motions)


def _matrix(covariance: Array) -> Array:
    """Covariances (..., 3) as matrices (..., 2, 2)."""
    aa, bb, ab = np.moveaxis(covariance, -1, 0)
    return np.stack([np.stack([aa, ab], axis=-1), np.stack([ab, bb], axis=-1)], axis=-2)


# Two by two and in closed form, so that a covariance that is singular to rounding gives NaN, and with it no
# probability, instead of an exception for all vectors.
def _determinant(matrix: Array) -> Array:
    return np.asarray(matrix[..., 0, 0] * matrix[..., 1, 1] - matrix[..., 0, 1] * matrix[..., 1, 0])


def _inverse(matrix: Array) -> Array:
    """Inverse of symmetric matrices."""
    aa, bb, ab = matrix[..., 0, 0], matrix[..., 1, 1], matrix[..., 0, 1]
    adjugate = _matrix(np.stack([bb, aa, -ab], axis=-1))
    return np.asarray(adjugate / _determinant(matrix)[..., None, None])


def _cholesky(matrix: Array) -> Array:
    """Lower factors; NaN where there is none."""
    first = np.sqrt(matrix[..., 0, 0])
    mixed = matrix[..., 1, 0] / first
    return _triangle(first, mixed, np.sqrt(matrix[..., 1, 1] - mixed**2))


def _inverse_of_triangle(factor: Array) -> Array:
    """Inverse of lower triangular matrices."""
    first, mixed, second = factor[..., 0, 0], factor[..., 1, 0], factor[..., 1, 1]
    return _triangle(1.0 / first, -mixed / (first * second), 1.0 / second)


def _triangle(first: Array, mixed: Array, second: Array) -> Array:
    rows = [np.stack([first, np.zeros_like(first)], axis=-1), np.stack([mixed, second], axis=-1)]
    return np.stack(rows, axis=-2)


def _nodes() -> tuple[Array, Array]:
    """Nodes (nodes, 2) and logarithms of weights of the two-dimensional standard normal density."""
    x, w = np.polynomial.hermite_e.hermegauss(_NODES)
    grid = np.stack(np.meshgrid(x, x, indexing="ij"), axis=-1).reshape(-1, 2)
    return grid, np.log(np.outer(w, w)).ravel()
