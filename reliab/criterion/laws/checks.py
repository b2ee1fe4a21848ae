"""Checks of every law: increasing grids, and finite limits that are not negative."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reliab.errors import InputError

LARGEST = 1e30
"""Beyond any structure and any boundary, and its square is still a number."""

_REMEDY = "Derive the criterion again; few motions give limits of zero, never negative ones"


def checked_limits(name: str, values: ArrayLike, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Return limits as an array, or say what is wrong with them."""
    limits = _numbers(f"limits {name}", values)
    if limits.shape != shape:
        raise InputError(
            f"The limits {name} of a law must have one number for each structure, shape {shape}",
            value=f"shape {limits.shape}",
            remedy=_REMEDY,
        )
    wrong = ~((limits >= 0.0) & (limits <= LARGEST))
    if wrong.any():
        raise InputError(
            f"The limits {name} of a law must be finite, at most {LARGEST:g}, and not negative",
            value=limits[wrong].flat[0],
            remedy=_REMEDY,
        )
    return limits


def checked_grid(name: str, values: ArrayLike) -> NDArray[np.float64]:
    """Return the frequencies or damping ratios of a law, or say what is wrong with them."""
    grid = _numbers(name, values)
    increasing = grid.ndim == 1 and grid.size > 0 and bool((np.diff(grid) > 0.0).all())
    if not (increasing and grid[0] >= 1.0 / LARGEST and grid[-1] <= LARGEST):
        raise InputError(
            f"The {name} of a law must be positive, finite, at most {LARGEST:g}, and increasing",
            value=str(np.asarray(values).tolist()),
            remedy="Derive the criterion again",
        )
    return grid


def checked_coefficients(name: str, values: ArrayLike, terms: int) -> None:
    """Refuse coefficients that are not finite, or not as many as the law has terms."""
    coefficients = _numbers(f"coefficients of {name}", values)
    if coefficients.shape != (terms,) or not np.isfinite(coefficients).all():
        raise InputError(
            f"The law's coefficients of {name} must be {terms} finite numbers",
            value=str(np.asarray(values).tolist()),
            remedy="Derive the criterion again",
        )


def _numbers(name: str, values: ArrayLike) -> NDArray[np.float64]:
    try:
        return np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(
            f"The {name} of a law must be numbers in rows of one length",
            value=str(error),
            remedy="Derive the criterion again",
        ) from error
