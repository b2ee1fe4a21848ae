"""Structures whose floors, storeys or modes are heavier, stiffer or more damped than stated.

A matrix is written in the motions in which its parts stand apart, A = Bᵀ S B, and each part is multiplied by
its factor as √F S √F, which leaves it positive definite and is exact for diagonal S: B gives the
displacements of the floors for masses, the drifts of the storeys for springs and dashpots (S of a shear frame
is diagonal), and the coordinates of the modes for frequencies and damping ratios.

Single entries of a matrix are off with those opposite to them, alone or several together. Where draws of them
would leave less than a twentieth of the lowest stiffness, which no structure has, they are drawn nearer.
"""

import re
from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
import scipy

from reliab.core.arrays import Array

PARTS: Final = ("floor_mass", "storey_stiffness", "storey_damping", "mode_frequency", "mode_damping_ratio")
"""Parts of a structure by name, each followed by its number from the ground up or from the slowest mode."""

WHOLES: Final = ("damping", "specimen_stiffness", *PARTS[:3])
"""What is changed without a number: the damping, the specimen, what floors or storeys have in common."""

MATRICES: Final = ("mass", "damping", "stiffness")

_ENTRIES = re.compile(r"(mass|damping|stiffness)_entry((?:_\d+_\d+)+)")
_LEAST = 0.05  # of what is stated: no part has less
_ROUNDING = 1e-9  # of the largest eigenvalue


def is_part(name: str) -> bool:
    """Whether a name is of a part, such as "storey_stiffness_2", of entries, or of a whole: "damping"."""
    return name in WHOLES or part_and_number(name) is not None


def part_and_number(name: str) -> tuple[str, str] | None:
    """Part of the structure and its number, or places of entries; None where a name is of no such part.

    >>> part_and_number("storey_stiffness_2"), part_and_number("damping")
    (('storey_stiffness', '2'), None)
    >>> part_and_number("mass_entry_1_2")
    ('mass_entry', '(1, 2)')
    """
    part, _, number = name.rpartition("_")
    if part in PARTS and number.isdecimal():
        return part, number
    if (entries := _places_of_entries(name)) is None:
        return None
    return f"{entries[0]}_entry", ", ".join(f"({row + 1}, {column + 1})" for row, column in entries[1])


def is_of_entries(name: str) -> bool:
    """Whether a name is of single entries of a matrix, such as "stiffness_entry_1_2"."""
    return _places_of_entries(name) is not None


def name_of_entries(matrix: str, places: Sequence[tuple[int, int]]) -> str:
    """Name entries of a matrix that are off together, by rows and columns from 0.

    >>> name_of_entries("stiffness", [(0, 1)])
    'stiffness_entry_1_2'
    """
    return f"{matrix}_entry" + "".join(f"_{row + 1}_{column + 1}" for row, column in places)


def _places_of_entries(name: str) -> tuple[str, list[tuple[int, int]]] | None:
    """Matrix, rows and columns of entries that are off together."""
    if (match := _ENTRIES.fullmatch(name)) is None:
        return None
    numbers = [int(number) - 1 for number in match[2].split("_")[1:]]
    return match[1], list(zip(numbers[::2], numbers[1::2], strict=True))


def change_matrices(
    mass: Array, damping: Array, stiffness: Array, changes: Mapping[str, float]
) -> tuple[Array, Array, Array]:
    """Return M, C and K with parts that are off by relative changes.

    >>> stiffness = np.array([[300.0, -100.0], [-100.0, 100.0]])
    >>> change_matrices(np.eye(2), 0.01 * stiffness, stiffness, {"storey_stiffness_2": 0.1})[2]
    array([[ 310., -110.],
           [-110.,  110.]])
    """
    factors = {part: _factors(part, mass.shape[0], changes) for part in PARTS}
    if any((factors[part] != 1.0).any() for part in PARTS[3:]):
        back = scipy.linalg.eigh(stiffness, mass)[1].T @ mass
        frequency, ratio = factors["mode_frequency"], factors["mode_damping_ratio"]
        stiffness = _scale_motions(stiffness, back, frequency**2)
        damping = _scale_motions(damping, back, frequency * ratio)
    floors = np.eye(mass.shape[0])
    drifts = floors - np.eye(mass.shape[0], k=-1)
    parts = (
        _scale_motions(mass, floors, factors["floor_mass"]),
        _scale_motions(damping, drifts, factors["storey_damping"]) * _factor(changes.get("damping", 0.0)),
        _scale_motions(stiffness, drifts, factors["storey_stiffness"]),
    )
    m, c, k = (change_entries(matrix, name, changes) for matrix, name in zip(parts, MATRICES, strict=True))
    return m, c, k


def change_entries(matrix: Array, name: str, changes: Mapping[str, float]) -> Array:
    """Return a matrix with entries off by relative changes, or by as much of them as a structure allows."""
    increments = np.zeros_like(matrix)
    for entries, change in changes.items():
        entry_places = _places_of_entries(entries)
        if entry_places is not None and entry_places[0] == name:
            for row, column in entry_places[1]:
                increments[row, column] += change * matrix[row, column]
                if row != column:
                    increments[column, row] += change * matrix[column, row]
    if not increments.any():
        return matrix
    least = least_of(matrix)
    while np.linalg.eigvalsh(matrix + increments)[0] < least:
        increments = increments / 2.0
    return np.asarray(matrix + increments)


def least_of(matrix: Array) -> float:
    """Lowest eigenvalue that changes of entries may leave."""
    values = np.linalg.eigvalsh(matrix)
    return float(min(_LEAST * values[0], values[0]) - _ROUNDING * np.abs(values).max())


def _factor(change: float) -> float:
    return max(1.0 + change, _LEAST)


def _factors(part: str, size: int, changes: Mapping[str, float]) -> Array:
    """Factors of all floors, storeys or modes, shape (n,)."""
    common = _factor(changes.get(part, 0.0))
    return np.array([common * _factor(changes.get(f"{part}_{place + 1}", 0.0)) for place in range(size)])


def _scale_motions(matrix: Array, motions: Array, factors: Array) -> Array:
    """√F S √F for a matrix Bᵀ S B; `motions` is B."""
    if (factors == 1.0).all():
        return matrix
    back, roots = np.linalg.inv(motions), np.sqrt(factors)
    parts = back.T @ matrix @ back
    return np.asarray(motions.T @ (roots[:, np.newaxis] * parts * roots) @ motions)
