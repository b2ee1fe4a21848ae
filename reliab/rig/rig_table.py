"""The table of a rig's tests: made from one JSON per test, and kept in a CSV beside them for speed."""

import csv
import io
import zlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from reliab.core.arrays import Array
from reliab.core.encodings import as_cell, of_cell
from reliab.rig.rig_test import COLUMNS, TEXTS

STATE: Final = "file_state"
"""Column of the CSV: time [ns] and size of a test's JSON when it was read, and a checksum of the row."""

CHANGE: Final = "change"
"""Column that says what was noticed to have changed with a test, computed from those before it."""

_TRUTHS: Final = {"True": True, "False": False}
_NOT_MODELLED: Final = frozenset((*COLUMNS, STATE, CHANGE, "day"))
_FORM: Final = b"rig table 3"
"""Goes into the checksums of rows; another one where flags of changes are computed in another way."""


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
        return sorted(set().union(*self.rows) - _NOT_MODELLED)

    @property
    def columns(self) -> list[str]:
        """All columns."""
        return [*COLUMNS, *self.covariate_names, CHANGE]

    @property
    def whole_rows(self) -> list[dict[str, Any]]:
        """Rows with all columns, None where a test has no value."""
        columns = self.columns
        return [{name: row.get(name) for name in columns} for row in self.rows]

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
    further = sorted(set().union(*rows) - {*COLUMNS, STATE, CHANGE})
    names = [STATE, *COLUMNS, *further, CHANGE]
    header = _header_check(names)
    checked = []
    for row in rows:
        cells = [_cell(row.get(name)) for name in names[1:]]
        checked.append({**row, STATE: f"{row[STATE]}-{_check(cells, header)}"})
    return _as_csv(checked, names)


def cached_rows(text: str) -> dict[str, dict[str, Any]]:
    """Read what :func:`cached_text` wrote, by checksum of the test, without rows changed since.

    ValueError, KeyError or csv.Error where the text is damaged.
    """
    lines = (list(map(of_cell, cells)) for cells in csv.reader(io.StringIO(text, newline="")))
    names = next(lines, [])
    if names[:1] != [STATE]:
        raise ValueError("another table")
    header = _header_check(names)
    columns = [(name, _reader(name), name in {*COLUMNS, CHANGE}) for name in names[1:]]
    rows: dict[str, dict[str, Any]] = {}
    for state, *cells in lines:
        stamp, _, check = state.rpartition("-")
        if check != _check(cells, header):
            continue
        row: dict[str, Any] = {STATE: stamp}
        for (name, read, always), cell in zip(columns, cells, strict=True):
            if cell or always:
                row[name] = read(cell)
        rows[row["sha256"]] = row
    return rows


def _header_check(names: Sequence[str]) -> int:
    return zlib.crc32(_joined(names), zlib.crc32(_FORM))


def _check(cells: Sequence[str], header: int) -> str:
    return f"{zlib.crc32(_joined(cells), header):08x}"


def _joined(cells: Sequence[str]) -> bytes:
    return "\x1f".join(cells).encode("utf-8", "backslashreplace")


def _cell(value: object) -> str:
    return "" if value is None else str(value)


def _reader(name: str) -> Callable[[str], object]:
    """Return what makes a value of a column of its cell."""
    if name in TEXTS or name == CHANGE:
        return str
    return _TRUTHS.__getitem__ if name == "reliable" else _number_of


def _number_of(cell: str) -> float | None:
    return float(cell) if cell else None


def _as_csv(rows: Iterable[Mapping[str, Any]], columns: Sequence[str]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(map(as_cell, columns))
    for row in rows:
        values = (row.get(name) for name in columns)
        cells = ("" if value is None else value for value in values)
        writer.writerow([as_cell(cell) if isinstance(cell, str) else cell for cell in cells])
    return text.getvalue()
