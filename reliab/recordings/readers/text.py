"""Text in columns: CSV and its relatives, with any usual delimiter, decimal point or comma, and preamble.

A table begins where rows of numbers begin. Names, and units in brackets or in a line of their own, stand
above it, also in a comment. Lines without a number after a table begin another one: MTS 793 repeats its
header for every acquisition.
"""

import re
from array import array
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from reliab.encodings import decoded, encoding_of
from reliab.errors import InputError
from reliab.files import require_small
from reliab.recordings.naming import describe
from reliab.recordings.readers.columns import Columns
from reliab.recordings.units import unit_of
from reliab.recordings.words import Quantity

COMMENTS: Final = ("#", "%", "//", "!")
TOO_LARGE: Final = "Leave columns out, resample the test, or cut it where everything stands still"
_MOST_BYTES: Final = 400_000_000  # a text takes about seven times its size in memory
_STATEMENT = re.compile(r"^[#%!/\s]+([\w ]+?)\s*[=:]\s*(\S.*?)\s*$")
_RATE = re.compile(
    r"^[#%!/\s\"]*(sampl\w*[ _]?(?:rate|freq\w*)|rate|fs|dt|time ?step)\b"
    r"[^\d\n]{0,20}?([\d.]+(?:e-?\d+)?)\s*(k?hz|ms|s(?:ec)?\b)?",
    re.IGNORECASE,
)
_RATE_UNITS = {"khz": 1e3, "ms": 1e-3}
_DELIMITERS: Final = (";", "\t", ",", "")
_BETWEEN_NAMES: Final = ("\t", ";", ",", "  ", "")
_DECIMAL_COMMA = re.compile(r"^[+-]?\d*,\d+(?:[eE][+-]?\d+)?$|^[+-]?\d+,(?:[eE][+-]?\d+)?$")
_TITLE = re.compile(
    r"^(?:columns?|channels?|fields?|variables?|signals?|names?|header)\s*[:=]\s*", re.IGNORECASE
)
_LABEL = re.compile(r"^(?!(?:nan|null|none|inf)$)[a-z][a-z _]{2,}:?$", re.IGNORECASE)  # of a setting
_CLOCK_TIME = re.compile(r"(\d{1,2}):(\d{2}):(\d{2}(?:[.,]\d+)?)")
_MISSING = {"", "nan", "na", "n/a", "null", "none", "-nan", "#n/a"}
_FEWEST_COLUMNS = 2
_LONGEST_PREAMBLE = 5_000_000  # characters
_HEADER_LINES = 8
_LONGEST_CELL = 40  # characters that a message repeats
_DAY = 86400.0
_HALF = 0.5
_LETTERS: Final = frozenset("acfk-")  # ampere, degrees and kelvin, or names of columns


@dataclass(frozen=True, kw_only=True)
class Line:
    """A line of a text, in its cells."""

    number: int  # counted from 1
    cells: tuple[str, ...]

    @property
    def holds_numbers(self) -> bool:
        """Whether all cells are numbers, or gaps between numbers."""
        numbers = [number_of(cell) for cell in self.cells]
        return None not in numbers and any(np.isfinite(number or 0.0) for number in numbers)

    @property
    def numbers(self) -> int:
        """How many cells are numbers."""
        return sum(number is not None and np.isfinite(number) for number in map(number_of, self.cells))


@dataclass(frozen=True, kw_only=True)
class Header:
    """What stands above a table."""

    names: list[str]
    units: list[str]
    named: bool


def recognises(head: bytes) -> bool:
    """Whether a file begins as text."""
    return b"\x00" not in head or encoding_of(head).startswith("utf-16")


def read_text(path: Path, delimiter: str | None = None) -> list[Columns]:
    """Read all tables of a text."""
    require_small(path, _MOST_BYTES, remedy=f"{TOO_LARGE}, or export it as HDF5")
    return tables_of(decoded(path.read_bytes()).splitlines(), path, delimiter)


def tables_of(lines: Sequence[str], path: Path, delimiter: str | None = None) -> list[Columns]:
    """Read the tables of a text in lines."""
    separator = delimiter if delimiter is not None else delimiter_of(lines)
    tables: list[Columns] = []
    begin = 0
    while begin < len(lines):
        place = _first_row(lines, separator, begin)
        if place is None:
            break
        table, begin = _table(lines, begin, place, separator, path)
        tables.append(table)
    if not tables:
        raise InputError(
            "A test's file must hold rows of at least two numbers",
            value="none",
            remedy="Export command and measured displacement as columns, or give `delimiter`",
            where=path.name,
        )
    long = [table for table in tables if next(iter(table.values.values())).size > 1] or tables
    joined = _joined(long)
    return joined if len(joined) == 1 else [_as_test(table, place) for place, table in enumerate(joined, 1)]


def _joined(tables: Sequence[Columns]) -> list[Columns]:
    """Join tables that go on one another: the same columns, and a first time one step after the last."""
    joined = [tables[0]]
    for table in tables[1:]:
        before = joined[-1]
        if not _goes_on(before, table):
            joined.append(table)
            continue
        values = {name: np.concatenate([before.values[name], table.values[name]]) for name in table.values}
        lines = [part.lines for part in (before, table) if part.lines is not None]
        joined[-1] = replace(before, values=values, lines=np.concatenate(lines))
    return joined


def _goes_on(before: Columns, table: Columns) -> bool:
    if list(before.values) != list(table.values) or dict(before.units) != dict(table.units):
        return False
    described = describe(list(table.values), table.units)
    time = next((name for name, what in described.items() if what.quantity is Quantity.TIME), None)
    if time is None or before.values[time].size < _FEWEST_COLUMNS:
        return False
    step = float(np.median(np.diff(before.values[time])))
    return bool(abs(table.values[time][0] - before.values[time][-1] - step) < _HALF * abs(step))


def _as_test(table: Columns, number: int) -> Columns:
    return replace(table, test=str(number))


def delimiter_of(lines: Sequence[str]) -> str:
    """Delimiter under which two lines of at least two numbers, else one, come first."""
    seen = 0
    for place, line in enumerate(lines):
        seen += len(line)
        if seen > _LONGEST_PREAMBLE:
            break
        if not is_comment(line):
            for candidate in _DELIMITERS:
                if begins_table(lines, candidate, place):
                    return candidate
    for line in lines[:_LONGEST_PREAMBLE]:
        for candidate in _DELIMITERS:
            if Line(number=1, cells=cells_of(line, candidate)).numbers >= _FEWEST_COLUMNS:
                return candidate
    return ","


def cells_of(line: str, delimiter: str) -> tuple[str, ...]:
    """Cells of a line, without blanks and quotation marks around them; blanks delimit where nothing does."""
    parts = line.split(delimiter) if delimiter else line.split()
    return tuple(part.strip().strip('"').strip() for part in parts)


def header_of(lines: Sequence[str], width: int, delimiter: str) -> Header:
    """Names and units of the columns, from the lines above a table."""
    wide = [cells for line in lines[-_HEADER_LINES:] if (cells := _names_in(line, width, delimiter))]
    named = [cells for cells in wide if not _is_units(cells)]
    units = next((cells for cells in reversed(wide[-2:]) if _is_units(cells)), ())
    if not named:
        return Header(names=[f"column {place + 1}" for place in range(width)], units=list(units), named=False)
    telling = max(reversed(named), key=_telling)
    names = [name or f"column {place + 1}" for place, name in enumerate(telling)]
    if len(set(names)) < len(names):
        repeated = next(name for name in names if names.count(name) > 1)
        raise InputError(
            "Each column must occur only once", value=repr(repeated), remedy="Rename one of the columns"
        )
    return Header(names=names, units=list(units), named=True)


def number_of(cell: str) -> float | None:
    """Read a cell: a number with point or comma, NaN where it is empty, None where it is neither."""
    try:
        return float(cell)
    except ValueError:
        pass
    if cell.lower() in _MISSING:
        return float("nan")
    return float(cell.replace(",", ".")) if _DECIMAL_COMMA.match(cell) else None


def is_comment(line: str) -> bool:
    """Whether a line is empty or a comment."""
    stripped = line.strip()
    return not stripped or stripped.startswith(COMMENTS)


def _names_in(line: str, width: int, delimiter: str) -> tuple[str, ...]:
    """Cells of a line above a table, if they are as many as its columns and no numbers."""
    plain = line.strip("\r\n")
    as_written = cells_of(plain, delimiter)
    if len(as_written) == width and as_written[0] == "%" and _is_units(as_written):
        return as_written  # per cent, the unit of the first column, begins no comment
    if plain.strip().startswith(COMMENTS):
        plain = _TITLE.sub("", plain.strip().lstrip("".join(COMMENTS)).strip())
    for sign in (delimiter, *_BETWEEN_NAMES):
        parts = re.split(r"\s{2,}", plain.strip()) if sign == "  " else cells_of(plain, sign)
        cells = tuple(part.strip().strip('"').strip() for part in parts)
        if len(cells) > width and not any(cells[width:]):
            cells = cells[:width]
        if len(cells) == width and any(cells) and not Line(number=0, cells=cells).numbers:
            return cells
    return ()


def _telling(cells: Sequence[str]) -> int:
    """How many cells of a line are names that say what a column measures, or its side."""
    described = describe(cells, {}).values()
    return sum(what.quantity is not None or what.role is not None for what in described)


def _is_units(cells: Sequence[str]) -> bool:
    """Whether a line states units: half of its cells are some that are no mere letter, or all are some."""
    stated = [cell for cell in cells if cell]
    known = [cell for cell in stated if unit_of(cell) is not None]
    clear = [cell for cell in known if cell.strip("[]()").lower() not in _LETTERS]
    return 2 * len(clear) >= max(len(stated), 1) or (bool(clear) and len(known) == len(stated))


def _first_row(lines: Sequence[str], delimiter: str, begin: int) -> int | None:
    """Find the first row of a table: of two rows of one width, else of any, else of text among numbers."""
    single = mixed = None
    for place in range(begin, len(lines)):
        if is_comment(lines[place]):
            continue
        if begins_table(lines, delimiter, place):
            return place
        line = Line(number=place + 1, cells=cells_of(lines[place], delimiter))
        if single is None and len(line.cells) >= _FEWEST_COLUMNS and line.holds_numbers:
            single = place
        if mixed is None and _begins_mixed_table(lines, delimiter, place):
            mixed = place
        if mixed is not None and place - mixed > _HEADER_LINES:
            break
    return mixed if single is None else single


def begins_table(lines: Sequence[str], delimiter: str, place: int) -> bool:
    """Whether this line and the next one that is no comment are rows of numbers of one width."""
    first = Line(number=0, cells=cells_of(lines[place], delimiter))
    if len(first.cells) < _FEWEST_COLUMNS or not first.holds_numbers:
        return False
    following = next((line for line in islice(lines, place + 1, place + 20) if not is_comment(line)), None)
    if following is None:
        return False
    second = Line(number=0, cells=cells_of(following, delimiter))
    return len(second.cells) == len(first.cells) and second.holds_numbers


def _begins_mixed_table(lines: Sequence[str], delimiter: str, place: int) -> bool:
    """Whether rows begin in which some columns hold a text, such as the time of day."""
    rows = [Line(number=0, cells=cells_of(line, delimiter)) for line in lines[place : place + 4]]
    return len(rows) == 4 and all(  # noqa: PLR2004
        row.numbers >= _FEWEST_COLUMNS and len(row.cells) == len(rows[0].cells) for row in rows
    )


def _table(lines: Sequence[str], begin: int, place: int, delimiter: str, path: Path) -> tuple[Columns, int]:
    """One table, with the names above it, and the place of the line behind it."""
    cells = cells_of(lines[place], delimiter)
    if len(cells) < _FEWEST_COLUMNS:
        raise InputError(
            "A test's file must hold rows of at least two numbers",
            value=f"{len(cells)} in line {place + 1}",
            remedy="Export command and measured displacement as columns, or give `delimiter`",
            where=path.name,
        )
    header = header_of(lines[begin:place], len(cells), delimiter)
    _require_no_row_above(lines, begin, place, header, delimiter, path)
    quick = _quick_rows(lines, place, cells, delimiter)
    rows, numbers, end = quick or _rows(lines, place, header.names, delimiter, path)
    kept = [k for k, name in enumerate(header.names) if _holds_anything(rows[:, k], name, cells[k])]
    return (
        Columns(
            path=path,
            values={header.names[k]: rows[:, k].copy() for k in kept},
            units={header.names[k]: header.units[k] for k in kept if k < len(header.units)},
            scalars=dict(_rates(lines[begin:place])),
            header=dict(statements_of(lines[begin:place])),
            lines=numbers,
            named=header.named,
        ),
        end,
    )


def _require_no_row_above(
    lines: Sequence[str], begin: int, place: int, header: Header, delimiter: str, path: Path
) -> None:
    """Refuse a damaged row between the names and the first sound one."""
    for above in range(place - 1, begin - 1, -1):
        cells = cells_of(lines[above], delimiter)
        if tuple(cells[: len(header.names)]) == tuple(header.names) or not header.named:
            return
        row = Line(number=above + 1, cells=cells)
        if row.numbers and not is_comment(lines[above]) and not _LABEL.match(cells[0]):
            list(_numbers(row, header.names, set(), path))


def _holds_anything(values: NDArray[np.float64], name: str, cell: str) -> bool:
    """Whether a column is more than what a delimiter at the end of each line, or a remark, leaves."""
    return not np.isnan(values).all() or not (name.startswith("column ") or number_of(cell) is None)


def _quick_rows(
    lines: Sequence[str], place: int, cells: Sequence[str], delimiter: str
) -> tuple[NDArray[np.float64], NDArray[np.int64], int] | None:
    """All rows at once, if every line has as many cells; None where a line needs to be looked at."""
    body = lines[place:]
    while body and not body[-1].strip():
        body = body[:-1]
    if any(_DECIMAL_COMMA.match(cell) for cell in cells):
        body = [line.replace(",", ".") for line in body]
    try:
        rows = np.loadtxt(body, delimiter=delimiter or None, comments=None, ndmin=2)
    except ValueError:
        return None
    if rows.shape != (len(body), len(cells)):
        return None
    return rows, np.arange(place + 1, place + 1 + len(rows)), len(lines)


def _rows(
    lines: Sequence[str], place: int, names: Sequence[str], delimiter: str, path: Path
) -> tuple[NDArray[np.float64], NDArray[np.int64], int]:
    """Rows of a table, line by line, up to a line without a number; no row is kept as text."""
    first = cells_of(lines[place], delimiter)
    texts = {k for k, cell in enumerate(first) if number_of(cell) is None}
    values, numbers = array("d"), array("q")
    end = place
    for end in range(place, len(lines)):
        if is_comment(lines[end]):
            continue
        cells = cells_of(lines[end], delimiter)
        if not any(number_of(cell) is not None and cell for cell in cells):
            break
        values.extend(_numbers(Line(number=end + 1, cells=cells), names, texts, path))
        numbers.append(end + 1)
    else:
        end = len(lines)
    rows = np.array(values).reshape(-1, len(names))
    for k in texts:
        rows[:, k] = _unwrapped(rows[:, k])
    return rows, np.array(numbers, dtype=np.int64), end


def _numbers(row: Line, names: Sequence[str], texts: set[int], path: Path) -> Iterator[float]:
    where = f"{path.name}, line {row.number}"
    if len(row.cells) != len(names):
        raise InputError(
            f"Every line must have {len(names)} columns, as the first has",
            value=len(row.cells),
            remedy="Correct the line, or leave out this line and all later ones",
            where=where,
        )
    for place, (name, cell) in enumerate(zip(names, row.cells, strict=True)):
        number = _time_of_day(cell) if place in texts else number_of(cell)
        if number is None:
            raise InputError(
                "Every value must be a number",
                value=repr(cell if len(cell) <= _LONGEST_CELL else f"{cell[:_LONGEST_CELL]} …"),
                remedy="Correct the line, or leave out this line and all later ones",
                where=f"{where}, column {name}",
            )
        yield number


def _time_of_day(cell: str) -> float:
    """Seconds since midnight, NaN for any other text."""
    match = _CLOCK_TIME.search(cell)
    if match is None:
        return float("nan")
    return 3600.0 * int(match[1]) + 60.0 * int(match[2]) + float(match[3].replace(",", "."))


def _unwrapped(seconds: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return times of day from the first one on, beyond midnight too."""
    days = np.concatenate([[0.0], (np.diff(seconds) < -0.5 * _DAY).cumsum()])
    return np.asarray(seconds - seconds[0] + _DAY * days)


def statements_of(lines: Sequence[str]) -> Iterator[tuple[str, str]]:
    """Names and values that comments state above a table."""
    for line in lines:
        match = _STATEMENT.match(line) if line.strip().startswith(COMMENTS) else None
        if match is not None:
            yield match[1].lower(), match[2]


def _rates(lines: Sequence[str]) -> Iterator[tuple[str, float]]:
    """Find the sampling rate or time step that lines above a table state."""
    for line in lines[:1000]:
        match = _RATE.match(line[:200])
        if match is None:
            continue
        try:
            value = float(match[2]) * _RATE_UNITS.get((match[3] or "").lower(), 1.0)
        except ValueError:
            continue
        is_step = match[1].lower() in {"dt", "timestep", "time step"}
        yield ("dt" if is_step else "rate"), value
