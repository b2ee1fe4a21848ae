"""Checks of a structure's matrices before anything is computed with them."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reliab.errors import InputError

_SYMMETRY = 1e-6  # of the largest entry: printed matrices are rounded
_ROUNDING = 1e-9  # of the largest eigenvalue: a semi-definite matrix in double precision


def square_matrix(values: ArrayLike, name: str) -> NDArray[np.float64]:
    """Return a finite, square, symmetric matrix, made exactly symmetric."""
    matrix = np.array(values, dtype=np.float64)
    if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1] or matrix.size == 0:  # noqa: PLR2004
        raise InputError(
            f"The {name} must be square", value=f"shape {matrix.shape}", remedy="Give n rows of n numbers"
        )
    if not np.isfinite(matrix).all():
        raise InputError(f"The {name} must be finite", remedy="Remove entries that are not numbers")
    difference = np.abs(matrix - matrix.T)
    if difference.max() > _SYMMETRY * np.abs(matrix).max():
        row, column = np.unravel_index(int(np.argmax(difference)), matrix.shape)
        raise InputError(
            f"The {name} must be symmetric",
            value=f"{matrix[row, column]:g} in row {row + 1}, column {column + 1} and "
            f"{matrix[column, row]:g} in row {column + 1}, column {row + 1}",
            remedy="Correct one of the two entries",
        )
    symmetric = np.asarray(0.5 * (matrix + matrix.T))
    symmetric.setflags(write=False)
    return symmetric


def lowest_eigenvalue(matrix: NDArray[np.float64]) -> tuple[float, float]:
    """Lowest eigenvalue of a symmetric matrix, and the largest modulus, in its units."""
    eigenvalues = np.linalg.eigvalsh(matrix)
    return float(eigenvalues[0]), float(np.abs(eigenvalues).max())


def require_positive_definite(matrix: NDArray[np.float64], name: str, remedy: str) -> None:
    """Raise an InputError that names the lowest eigenvalue unless the matrix is positive definite."""
    lowest, largest = lowest_eigenvalue(matrix)
    if lowest <= _ROUNDING**2 * largest or lowest <= 0.0:
        raise InputError(
            f"The {name} must be positive definite", value=f"the eigenvalue {lowest:g}", remedy=remedy
        )


def require_positive_semidefinite(matrix: NDArray[np.float64], name: str, remedy: str) -> None:
    """Raise an InputError that names the lowest eigenvalue if the matrix has a negative one."""
    lowest, largest = lowest_eigenvalue(matrix)
    if lowest < -_ROUNDING * largest:
        raise InputError(
            f"The {name} must not have a negative eigenvalue", value=f"{lowest:g}", remedy=remedy
        )
