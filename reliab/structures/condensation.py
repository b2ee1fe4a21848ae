"""Shapes to which matrices of a structure are confined: of statics, and of unit mass."""

import numpy as np
from numpy.typing import NDArray

from reliab.arrays import Array

_SINGULAR = 1e-10  # of the largest eigenvalue


def condensed(stiffness: Array, matrices: tuple[Array, ...], retained: int) -> tuple[Array, ...]:
    """Condense matrices of a specimen statically to its first degrees of freedom."""
    followed = np.arange(stiffness.shape[0]) >= retained
    shapes = static_shapes(stiffness, followed)
    return tuple(shapes.T @ matrix @ shapes for matrix in matrices)


def static_shapes(stiffness: Array, followed: NDArray[np.bool_]) -> Array:
    """Shapes of the structure when the remaining degrees of freedom move by one each."""
    moving = ~followed
    shapes = np.zeros((stiffness.shape[0], int(moving.sum())))
    shapes[moving] = np.eye(shapes.shape[1])
    shapes[followed] = -np.linalg.solve(
        stiffness[np.ix_(followed, followed)], stiffness[np.ix_(followed, moving)]
    )
    return shapes


def mass_orthonormal(shapes: Array, mass: Array) -> Array:
    """Basis of the same motions, of unit mass each, without those that depend on others."""
    scaled = shapes / np.sqrt(np.einsum("di,de,ei->i", shapes, mass, shapes))
    values, vectors = np.linalg.eigh(scaled.T @ mass @ scaled)
    independent = values > _SINGULAR * values.max()
    return np.asarray(scaled @ vectors[:, independent] / np.sqrt(values[independent]))
