"""Columns of a table of rows: which values are shown under which headings, and how they are written."""

from collections.abc import Callable, Iterable, Mapping
from typing import Any, Final

from reliab.core.significant_digits import significant

Form = str | Callable[[Any], str]
"""A format specification, or what writes a value."""

Columns = Mapping[str, tuple[str, Form] | tuple[str, Form, str]]
"""By heading, the key of a value in each row ("" for the whole row), its form, and "left" or "right".

Without a side, texts, whose form is "", stand left, and all others right.
"""

PLACE_COLUMNS: Final[Columns] = {
    "f [Hz]": ("f", "g"),
    "ξ [-]": ("xi", "g"),
    "α [-]": ("alpha", "g"),
    "error [-]": ("threshold", "g"),
}
"""Columns of a structure of one mass and the error of a test."""


def write_cells(columns: Columns, rows: Iterable[Mapping[str, Any]]) -> list[list[str]]:
    """Write the cells of a table, row by row.

    >>> write_cells({"f [Hz]": ("f", "g"), "b": ("b", digits)}, [{"f": 1.0, "b": 0.93142}, {"f": 2.0}])
    [['1', '0.931'], ['2', '-']]
    """
    return [[_cell(row, *column[:2]) for column in columns.values()] for row in rows]


def _cell(row: Mapping[str, Any], key: str, form: Form) -> str:
    value = row.get(key) if key else row
    if callable(form):
        return form(value)
    return "-" if value is None else format(value, form)


def side(column: tuple[str, Form] | tuple[str, Form, str]) -> str:
    """Tell whether a column stands "left" or "right"."""
    return column[2] if len(column) == 3 else "right" if column[1] else "left"  # noqa: PLR2004 - with a side


def digits(value: float | None) -> str:
    """Write a number with three digits, "-" without one."""
    return "-" if value is None else significant(value)
