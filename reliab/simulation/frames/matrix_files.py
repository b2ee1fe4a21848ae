"""Matrices of a description, as rows of numbers or in files beside it."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any, Final

import numpy as np

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.files import LIMITS
from reliab.core.untrusted_files import resolve_within

Row = tuple[float, ...]

Matrix = tuple[Row, ...]

_MATRICES: Final = frozenset(
    [
        "mass_matrix_kg",
        "stiffness_matrix_n_per_m",
        "damping_matrix_n_s_per_m",
        "matrix_n_s_per_m",
    ]
)
_REMEDY: Final = "Write rows of numbers, separated by commas or spaces"


def read_matrices(content: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Put the rows of a file in the place of its name, wherever a matrix is described."""
    return {key: _read(key, value, folder) for key, value in content.items()}


def _read(key: str, value: Any, folder: Path) -> Any:  # noqa: ANN401 - TOML holds anything
    if isinstance(value, dict):
        if key == "kinematics" and isinstance(value.get("matrix"), str):
            value = {**value, "matrix": _rows(value["matrix"], folder)}
        return read_matrices(value, folder)
    if key in _MATRICES and isinstance(value, str):
        return _rows(value, folder)
    return value


def _rows(name: str, folder: Path) -> list[list[float]]:
    path = resolve_within(folder, name, where="")
    LIMITS["matrix"].require_small(path)
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeError) as error:
        reason = getattr(error, "strerror", None) or "bytes that are not text"
        raise InputError("Cannot read the matrix", value=reason, remedy=_REMEDY, where=name) from None
    return list(_numbers(lines, name))


def _numbers(lines: Iterable[str], name: str) -> Iterable[list[float]]:
    for number, line in enumerate(lines, start=1):
        text = line.split("#")[0].replace(",", " ").replace(";", " ").split()
        try:
            row = [float(word) for word in text]
        except ValueError:
            raise InputError(
                "Not only numbers in the matrix", value=f"a text in line {number}", remedy=_REMEDY, where=name
            ) from None
        if row:
            yield row


def matrix_of_rows(rows: tuple[Row, ...] | None) -> Array:
    """Matrix of rows, which must be of one length."""
    rows = rows or ()
    if len({len(row) for row in rows}) != 1:
        raise InputError(
            "The rows of the matrix have different lengths",
            value=f"lengths {[len(row) for row in rows]}",
            remedy="Give as many numbers in each row",
        )
    return np.array(rows, dtype=np.float64)
