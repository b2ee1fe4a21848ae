"""Structures whose floors, storeys or modes are heavier, stiffer or more damped than stated.

A matrix is written in the motions in which its parts stand apart, A = Bᵀ S B, and each part is multiplied by
its factor as √F S √F, which leaves it positive definite and is exact for diagonal S: B gives the
displacements of the floors for masses, the drifts of the storeys for springs and dashpots (S of a shear frame
is diagonal), and the coordinates of the modes for frequencies and damping ratios.
"""

from collections.abc import Mapping
from typing import Final

import numpy as np
import scipy

from reliab.arrays import Array

PARTS: Final = ("floor_mass", "storey_stiffness", "storey_damping", "mode_frequency", "mode_damping_ratio")
"""Parts of a structure by name, each followed by its number from the ground up or from the slowest mode."""

WHOLES: Final = ("damping", "specimen_stiffness", *PARTS[:3])
"""What is changed without a number: the damping, the specimen, what floors or storeys have in common."""

_LEAST = 0.05  # of what is stated: no part has less


def is_part(name: str) -> bool:
    """Whether a name is that of a part, such as "storey_stiffness_2", or of a whole, such as "damping"."""
    return name in WHOLES or part_and_number(name) is not None


def part_and_number(name: str) -> tuple[str, int] | None:
    """Part of the structure and its number; None where a name is not that of a numbered part.

    >>> part_and_number("storey_stiffness_2"), part_and_number("damping")
    (('storey_stiffness', 2), None)
    """
    part, _, number = name.rpartition("_")
    return (part, int(number)) if part in PARTS and number.isdecimal() else None


def with_parts(
    mass: Array, damping: Array, stiffness: Array, changes: Mapping[str, float]
) -> tuple[Array, Array, Array]:
    """Return M, C and K with parts that are off by relative changes.

    >>> stiffness = np.array([[300.0, -100.0], [-100.0, 100.0]])
    >>> with_parts(np.eye(2), 0.01 * stiffness, stiffness, {"storey_stiffness_2": 0.1})[2]
    array([[ 310., -110.],
           [-110.,  110.]])
    """
    factors = {part: _factors(part, mass.shape[0], changes) for part in PARTS}
    if any((factors[part] != 1.0).any() for part in PARTS[3:]):
        back = scipy.linalg.eigh(stiffness, mass)[1].T @ mass
        frequency, ratio = factors["mode_frequency"], factors["mode_damping_ratio"]
        stiffness = _multiplied(stiffness, back, frequency**2)
        damping = _multiplied(damping, back, frequency * ratio)
    floors = np.eye(mass.shape[0])
    drifts = floors - np.eye(mass.shape[0], k=-1)
    return (
        _multiplied(mass, floors, factors["floor_mass"]),
        _multiplied(damping, drifts, factors["storey_damping"]) * _factor(changes.get("damping", 0.0)),
        _multiplied(stiffness, drifts, factors["storey_stiffness"]),
    )


def _factor(change: float) -> float:
    return max(1.0 + change, _LEAST)


def _factors(part: str, size: int, changes: Mapping[str, float]) -> Array:
    """Factors of all floors, storeys or modes, shape (n,)."""
    common = _factor(changes.get(part, 0.0))
    return np.array([common * _factor(changes.get(f"{part}_{place + 1}", 0.0)) for place in range(size)])


def _multiplied(matrix: Array, motions: Array, factors: Array) -> Array:
    """√F S √F for a matrix Bᵀ S B; `motions` is B."""
    if (factors == 1.0).all():
        return matrix
    back, roots = np.linalg.inv(motions), np.sqrt(factors)
    parts = back.T @ matrix @ back
    return np.asarray(motions.T @ (roots[:, np.newaxis] * parts * roots) @ motions)
