"""The table of a rig's tests: made from one JSON per test, and kept in a CSV beside them for speed."""

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from reliab.arrays import Array
from reliab.encodings import as_cell
from reliab.rig.rig_test import COLUMNS, TEXTS

CHANGED: Final = "changed_ns"
"""Column of the CSV with the time at which a test's JSON was last written [ns]."""

CHANGE: Final = "change"
"""Column that says what was noticed to have changed with a test, computed from those before it."""

_TRUTHS: Final = {"True": True, "False": False}
_NOT_MODELLED: Final = frozenset((*COLUMNS, CHANGED, CHANGE, "day"))


@dataclass(frozen=True, kw_only=True)
class RigTable:
    """Tests in the order of their dates, one row each."""

    rows: Sequence[Mapping[str, Any]]
    faults: Mapping[str, str]  # Why tests are left out, by file

    def __len__(self) -> int:
        """Count the tests."""
        return len(self.rows)

    @property
    def covariate_names(self) -> list[str]:
        """Quantities that users named, in alphabetical order."""
        return sorted({name for row in self.rows for name in row} - _NOT_MODELLED)

    @property
    def columns(self) -> list[str]:
        """All columns."""
        return [*COLUMNS, *self.covariate_names, CHANGE]

    def numbers(self, name: str) -> Array:
        """Return a column as numbers, NaN where a test has none."""
        values = (row.get(name) for row in self.rows)
        return np.array([np.nan if value in (None, "") else float(value) for value in values])

    def texts(self, name: str) -> list[str]:
        """Return a column as texts."""
        return [str(row.get(name) or "") for row in self.rows]

    @property
    def moments(self) -> list[str]:
        """What the tests are ordered by."""
        return [moment_of(row) for row in self.rows]

    @property
    def dated(self) -> bool:
        """Whether a date is stated for every test, so that their order means something."""
        return bool(self.rows) and all(row.get("date") for row in self.rows)

    def only(self, places: Iterable[int]) -> "RigTable":
        """Keep tests by their places."""
        return RigTable(rows=[self.rows[place] for place in places], faults={})

    def to_csv(self) -> str:
        """Write the table as text, with formulas of spreadsheets disarmed."""
        return _as_csv(self.rows, self.columns)


def ordered_table(rows: Iterable[Mapping[str, Any]], faults: Mapping[str, str] | None = None) -> RigTable:
    """Put rows into the order of their dates."""
    ordered = sorted(rows, key=lambda row: (moment_of(row), str(row["added"]), str(row["name"])))
    return RigTable(rows=ordered, faults=faults or {})


def moment_of(row: Mapping[str, Any]) -> str:
    """Date of a test, else when it was added."""
    return str(row.get("date") or row["added"])


def row_of(test: Mapping[str, Any], sha256: str) -> dict[str, Any]:
    """Flatten the JSON of a test; TypeError or KeyError where it holds something else."""
    row = {**{name: test[name] for name in COLUMNS}, **test["covariates"]}
    for name, value in row.items():
        kinds = (str,) if name in TEXTS else (bool,) if name == "reliable" else (int, float, type(None))
        if not isinstance(value, kinds):
            raise TypeError(f"{name} is {value!r}")
    if row["sha256"] != sha256:
        raise TypeError("the checksum is not that of the file's name")
    return row


def cached_text(rows: Sequence[Mapping[str, Any]]) -> str:
    """Write rows for the next reader."""
    names = sorted({name for row in rows for name in row} - {*COLUMNS, CHANGED, CHANGE})
    return _as_csv(rows, [CHANGED, *COLUMNS, *names, CHANGE], literal=True)


def cached_rows(text: str) -> dict[str, dict[str, Any]]:
    """Read what :func:`cached_text` wrote, by checksum; ValueError or KeyError where it is damaged."""
    rows: dict[str, dict[str, Any]] = {}
    for entry in csv.DictReader(io.StringIO(text)):
        row = {name: _value(name, cell) for name, cell in entry.items() if name in {*COLUMNS, CHANGE} or cell}
        rows[str(row["sha256"])] = row
    return rows


def _value(name: str, cell: str) -> object:
    if name in TEXTS or name == CHANGE:
        return cell
    if name == CHANGED:
        return int(cell)
    if name == "reliable":
        return _TRUTHS[cell]
    return float(cell) if cell else None


def _as_csv(rows: Iterable[Mapping[str, Any]], columns: Sequence[str], *, literal: bool = False) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    for row in rows:
        values = (row.get(name) for name in columns)
        cells = ("" if value is None else value for value in values)
        writer.writerow([cell if literal or not isinstance(cell, str) else as_cell(cell) for cell in cells])
    return text.getvalue()
