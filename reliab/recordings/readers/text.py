"""Text in columns: CSV and its relatives, with any usual delimiter, decimal point or decimal comma."""

import re
from array import array
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reliab.encodings import decoded
from reliab.errors import InputError
from reliab.recordings.readers.columns import Columns

_COMMENTS = ("#", "%", "//", "!")
_STATEMENT = re.compile(r"^[#%!/\s]+([\w ]+?)\s*[=:]\s*(\S.*?)\s*$")
_DELIMITERS = (";", "\t", ",", "")
_DECIMAL_COMMA = re.compile(r"^[+-]?\d+,\d+(?:[eE][+-]?\d+)?$")
_MISSING = {"", "nan", "na", "n/a", "null", "none", "-nan", "#n/a"}
_FEWEST_COLUMNS = 2


@dataclass(frozen=True, kw_only=True)
class _Line:
    number: int
    cells: tuple[str, ...]

    @property
    def holds_numbers(self) -> bool:
        """Whether all cells are numbers, or gaps between numbers."""
        numbers = [_number(cell) for cell in self.cells]
        return None not in numbers and any(np.isfinite(number or 0.0) for number in numbers)


def read_text(path: Path, *, delimiter: str | None = None) -> Columns:
    """Read a text file of columns."""
    text = decoded(path.read_bytes())
    separator = delimiter if delimiter is not None else _delimiter(text)
    lines = _lines(text, separator)
    before, first = _until_numbers(lines)
    if first is None or len(first.cells) < _FEWEST_COLUMNS:
        raise InputError(
            "A test's file must hold rows of at least two numbers",
            value="none" if first is None else f"{len(first.cells)} in line {first.number}",
            remedy="Export command and measured displacement as columns, or give `delimiter`",
            where=path.name,
        )
    names, units = _header(before, len(first.cells))
    labels = names or [f"column {place + 1}" for place in range(len(first.cells))]
    table, numbers = _table(chain([first], lines), labels, path)
    return Columns(
        path=path,
        values=dict(zip(labels, table.T, strict=True)),
        units=dict(zip(labels, units, strict=False)),
        header=dict(_statements(text, first.number)),
        lines=numbers,
        named=bool(names),
    )


def _until_numbers(lines: Iterator[_Line]) -> tuple[list[_Line], _Line | None]:
    """Lines before the first row of numbers, and that row."""
    before: list[_Line] = []
    for line in lines:
        if line.holds_numbers:
            return before, line
        before.append(line)
    return before, None


def _table(
    rows: Iterable[_Line], labels: Sequence[str], path: Path
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Numbers of rows, shape (rows, columns), and their lines; no row is kept as text."""
    values, lines = array("d"), array("q")
    for row in rows:
        values.extend(_numbers(row, labels, path))
        lines.append(row.number)
    return np.array(values).reshape(-1, len(labels)), np.array(lines, dtype=np.int64)


def _statements(text: str, first: int) -> Iterator[tuple[str, str]]:
    """Names and values that comments state before the first row of numbers."""
    for line in text.splitlines()[: first - 1]:
        match = _STATEMENT.match(line) if line.strip().startswith(_COMMENTS) else None
        if match is not None:
            yield match[1].lower(), match[2]


def _delimiter(text: str) -> str:
    """Delimiter under which a line of at least two numbers comes first."""
    top = text[:20_000]
    for candidate in _DELIMITERS:
        wide = (line for line in _lines(top, candidate) if len(line.cells) >= _FEWEST_COLUMNS)
        if any(line.holds_numbers for line in wide):
            return candidate
    return ","


def _lines(text: str, delimiter: str) -> Iterator[_Line]:
    for number, line in enumerate(text.splitlines(), start=1):
        stripped = line.strip()
        if not stripped or stripped.startswith(_COMMENTS):
            continue
        cells = line.split(delimiter) if delimiter else stripped.split()
        yield _Line(number=number, cells=tuple(cell.strip().strip('"').strip() for cell in cells))


def _header(lines: Sequence[_Line], width: int) -> tuple[list[str], list[str]]:
    """Names and, where a second line holds them, units of the columns."""
    wide = [line.cells for line in lines if len(line.cells) == width][-2:]
    if not wide:
        return [], []
    names = list(wide[0])
    units = [cell.strip("[]()") for cell in wide[1]] if len(wide) > 1 else []
    if len(set(names)) < len(names):
        repeated = next(name for name in names if names.count(name) > 1)
        raise InputError(
            "A column must stand once only", value=repr(repeated), remedy="Rename one of the columns"
        )
    return names, units


def _numbers(row: _Line, labels: Sequence[str], path: Path) -> list[float]:
    where = f"{path.name}, line {row.number}"
    if len(row.cells) != len(labels):
        raise InputError(
            f"Every line must have {len(labels)} columns, as the first has",
            value=len(row.cells),
            remedy="Mend the line, or leave it and all later ones out",
            where=where,
        )
    numbers = []
    for label, cell in zip(labels, row.cells, strict=True):
        number = _number(cell)
        if number is None:
            raise InputError(
                "Every value must be a number",
                value=repr(cell),
                remedy="Mend the line, or leave it and all later ones out",
                where=f"{where}, column {label}",
            )
        numbers.append(number)
    return numbers


def _number(cell: str) -> float | None:
    try:
        return float(cell)
    except ValueError:
        pass
    if cell.lower() in _MISSING:
        return float("nan")
    return float(cell.replace(",", ".")) if _DECIMAL_COMMA.match(cell) else None
