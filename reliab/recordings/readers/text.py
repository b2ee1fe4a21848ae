"""Text in columns: CSV and its relatives, with any usual delimiter, decimal point or comma, and preamble.

A table begins where rows of numbers begin. Names, and units in brackets or in a line of their own, stand
above it, also in a comment. Lines without a number after a table, or a line of another width above a further
table, begin another one: MTS 793 repeats its header for every acquisition.
"""

import re
from array import array
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from reliab.core.encodings import decode_text, encoding_of
from reliab.core.errors import InputError
from reliab.core.files import LIMITS
from reliab.core.text_tables import (
    COMMENTS,
    FEWEST_COLUMNS,
    Line,
    TimesOfDay,
    cells_of,
    has_decimal_comma,
    is_comment,
    lines_of,
    may_be_thousands,
    number_of,
    time_of_day,
)
from reliab.core.units import find_clock_unit
from reliab.recordings.naming import describe
from reliab.recordings.readers.columns import Columns, Series, seconds_between, unclear_in
from reliab.recordings.words import SIGNS, Measurand, unit_of

_STATEMENT: Final = re.compile(r"^[#%!/\s]+([\w ]+?)\s*[=:]\s*(\S.*?)\s*$")
_SCALES: Final = re.compile(
    r"(?:scale|scaling|conversion)[ _]?factor|multiplier|add[ _]?offset", re.IGNORECASE
)
_RATE: Final = re.compile(
    r"^[#%!/\s\"']*"
    r"(sampl\w*[ _]?(?:rate|freq\w*|interval|period)|rate|fs|dt|delta[ _]?t|time[ _]?(?:step|interval))\b"
    r"([^\d\n]{0,30}?)(\d+(?:[., '\u00a0\u202f]\d{3})*(?:[.,]\d+)?(?:e[+-]?\d+)?)(?!\d|[.,]\d)\s*([a-zµμ/]*)",
    re.IGNORECASE,
)
_STEP: Final = re.compile(r"dt|delta|time|.*(?:interval|period)$", re.IGNORECASE)
_STEP_TOLERANCE: Final = 1.01  # ratio of two statements of one step
_MOST_LINES: Final = 1000  # of a preamble in which a rate is looked for
_HEADER_LINES: Final = 8
_NAME_SEPARATORS: Final = ("\t", ";", ",", "  ", "")
_TITLE: Final = re.compile(
    r"^(?:columns?|channels?|fields?|variables?|signals?|names?|header|units?)\s*[:=]\s*", re.IGNORECASE
)
_LETTERS: Final = frozenset("acdfhk-")  # ampere, day, degrees, hour and kelvin, or names of columns


@dataclass(frozen=True, kw_only=True)
class Header:
    """What the lines above a table say of its columns."""

    names: list[str]
    units: list[str]
    named: bool  # Whether the names stand in the file
    statements: Mapping[str, str] = field(default_factory=dict)  # Of comments, by names in small letters
    sampling: Mapping[str, float] = field(default_factory=dict)  # "rate" [Hz] or "dt" [s], where it is stated
    # Scales and offsets that are stated for each column, of which nobody knows whether they were applied
    unclear: Sequence[str] = ()


def header_of(
    lines: Sequence[str], width: int, delimiter: str, *, decimal_comma: bool = False, location: str = ""
) -> Header:
    """Read the lines above a table of `width` columns."""
    wide = [cells for line in lines[-_HEADER_LINES:] if (cells := _names_in(line, width, delimiter))]
    name_rows = [cells for cells in wide if not _is_units(cells)]
    units = next((cells for cells in reversed(wide[-2:]) if _is_units(cells)), ())
    telling = max(reversed(name_rows), key=_telling) if name_rows else ("",) * width
    names = [name or f"column {place + 1}" for place, name in enumerate(telling)]
    for place, name in enumerate(names):  # times may stand before each channel
        if name in names[:place] and describe([name], {})[name].quantity is Measurand.TIME:
            names[place] = f"{name} {names[: place + 1].count(name)}"
    if len(set(names)) < len(names):
        duplicate = next(name for name in names if names.count(name) > 1)
        raise InputError(
            "Two columns have the same name",
            value=repr(duplicate),
            remedy="Rename one of the columns",
            where=location,
        )
    statements = dict(_statements(lines))
    return Header(
        names=names,
        units=list(units) or [""] * width,
        named=bool(name_rows),
        statements=statements,
        sampling=_sampling(lines, delimiter, decimal_comma=decimal_comma),
        unclear=_scales(lines[-_HEADER_LINES:], statements, names, delimiter),
    )


def _names_in(line: str, width: int, delimiter: str) -> tuple[str, ...]:
    """Cells of a line above a table, if they are as many as its columns and no numbers."""
    raw_cells = cells_of(line, delimiter)
    if len(raw_cells) == width and raw_cells[0] == "%" and _is_units(raw_cells):
        return raw_cells  # per cent, the unit of the first column, begins no comment
    plain = _TITLE.sub("", _strip_mark(line)) if line.strip().startswith(COMMENTS) else line
    for sign in (delimiter, *_NAME_SEPARATORS):
        cells = tuple(re.split(r"\s{2,}", plain.strip())) if sign == "  " else cells_of(plain, sign)
        if len(cells) > width and not any(cells[width:]):
            cells = cells[:width]
        if len(cells) == width and any(cells) and not Line(cells=cells).numbers:
            return cells
    return ()


def _strip_mark(line: str) -> str:
    return line.strip().lstrip("".join(COMMENTS)).strip()


def _telling(cells: Sequence[str]) -> int:
    """How many cells of a line are names that say what a column measures, or its side."""
    meanings = describe(cells, {}).values()
    return sum(meaning.quantity is not None or meaning.role is not None for meaning in meanings)


def _is_units(cells: Sequence[str]) -> bool:
    """Whether a line states units: half of its cells are some that are no mere letter, or all are some."""
    texts = [cell for cell in cells if cell]
    unit_cells = [cell for cell in texts if unit_of(cell) is not None and not cell[0].isdigit()]
    clear = [cell for cell in unit_cells if cell.strip("[]()").lower() not in _LETTERS]
    return 2 * len(clear) >= max(len(texts), 1) or (bool(clear) and len(unit_cells) == len(texts))


def _statements(lines: Sequence[str]) -> Iterator[tuple[str, str]]:
    """Names and values that comments state above a table."""
    for line in lines:
        match = _STATEMENT.match(line) if line.strip().startswith(COMMENTS) else None
        if match is not None:
            yield match[1].lower(), match[2]


def _scales(
    lines: Sequence[str], statements: Mapping[str, str], names: Sequence[str], delimiter: str
) -> list[str]:
    """Name scales and offsets that a comment states of all channels, or a row of numbers of each column."""
    clause = " and ".join(f"{name} = {text}" for name, text in statements.items() if _SCALES.fullmatch(name))
    meanings = describe(names, {})
    unclear = ["" if meanings[name].quantity is Measurand.TIME else clause for name in names]
    for line in lines:
        label, *cells = cells_of(_strip_mark(line), delimiter) or ("",)
        first = len(names) - len(cells)  # the label may stand in the first column
        if first in {0, 1}:
            for place, cell in enumerate(cells, start=first):
                unclear_units = unclear_in({label.rstrip(":"): number_of(cell)})
                unclear[place] = " and ".join(filter(None, (unclear[place], unclear_units)))
    return unclear


def _sampling(lines: Sequence[str], delimiter: str, *, decimal_comma: bool) -> dict[str, float]:
    """Find the sampling rate or step that lines above a table state; nothing where two of them differ."""
    statements: list[tuple[str, float]] = []
    for line in lines[:_MOST_LINES]:
        match = _RATE.match(_first_statement(line[:200], delimiter))
        if match is None or not (value := _header_number(match[3], decimal_comma=decimal_comma)):
            continue
        words = [match[4], *re.findall(r"[a-zµμ/]+", match[2], re.IGNORECASE)]
        clocks = filter(None, map(find_clock_unit, words))
        hertz = next((clock.size for clock in clocks if clock.is_frequency), None)
        units = (unit_of(word) for word in words)
        seconds = next((unit.factor for unit in units if unit and unit.quantity is Measurand.TIME), None)
        is_step = bool(_STEP.match(match[1])) if hertz is None and seconds is None else hertz is None
        statements.append(("dt" if is_step else "rate", value * (hertz or seconds or 1.0)))
    steps = [value if name == "dt" else 1.0 / value for name, value in statements]
    is_consistent = bool(steps) and max(steps) < _STEP_TOLERANCE * min(steps)
    return dict(statements[:1]) if is_consistent else {}


def _first_statement(line: str, delimiter: str) -> str:
    """Leave the values of other columns out of a row that states one of each."""
    cells = [cell for cell in cells_of(line, delimiter) if cell] if delimiter else []
    if len(cells) < 2 or line.strip().startswith(COMMENTS) or _RATE.match(cells[0]):  # noqa: PLR2004 - name and value
        return line
    return " ".join(cells[: 3 if len(cells) > 2 and number_of(cells[2]) is None else 2])  # noqa: PLR2004


def _header_number(text: str, *, decimal_comma: bool) -> float:
    """Read a number, with a sign before three digits as thousands unless decimals of the table have it."""
    groups = re.fullmatch(r"\d{1,3}(?:([.,])\d{3})+", text)
    if groups is not None and (groups[1] == ",") != decimal_comma:
        return float(text.replace(groups[1], ""))
    return number_of(text) or 0.0


_HALF: Final = 0.5


def join_tables(tables: Sequence[Columns]) -> list[Columns]:
    """Join tables in which all channels go on one step after the last time of each; number what remains."""
    result = [tables[0]]
    for table in tables[1:]:
        if _goes_on(result[-1], table):
            result[-1] = _append(result[-1], table)
        else:
            result.append(table)
    return result if len(result) == 1 else [replace(table, test=str(k)) for k, table in enumerate(result, 1)]


def _goes_on(first: Columns, second: Columns) -> bool:
    if list(first.series) != list(second.series) or first.units != second.units:
        return False
    meanings = describe(list(first.series), first.units)
    time = next((name for name, meaning in meanings.items() if meaning.quantity is Measurand.TIME), None)
    for name, first_series in first.series.items():
        times, time_pair = (
            table.values[time] if time and series.times is None else series.times
            for table, series in ((first, first_series), (second, second.series[name]))
        )
        if times is None or time_pair is None or times.size < 2:  # noqa: PLR2004 - a step
            return False
        step = float(np.median(np.diff(times)))
        gap = float(time_pair[0] - times[-1]) + _lateness(first_series, second.series[name]) - step
        if not abs(gap) < _HALF * abs(step):
            return False
    return True


def _append(first: Columns, second: Columns) -> Columns:
    series = {}
    for name, first_series in first.series.items():
        addition = second.series[name]
        series[name] = replace(first_series, values=np.concatenate([first_series.values, addition.values]))
        if first_series.times is not None and addition.times is not None:
            later = addition.times + _lateness(first_series, addition)
            series[name] = replace(series[name], times=np.concatenate([first_series.times, later]))
    lines = [part.lines for part in (first, second) if part.lines is not None]
    return replace(first, series=series, lines=np.concatenate(lines))


def _lateness(series: Series, addition: Series) -> float:
    """Time by which the clock of a series begins after that of another [s]."""
    if series.start is None or addition.start is None:
        return 0.0 if series.start is addition.start else np.inf
    return seconds_between(series.start, addition.start)


_DELIMITERS: Final = (";", "\t", ",", "")
_LABEL = re.compile(r"^(?!(?:nan|null|none|inf)$)[a-z][a-z _]{2,}:?$", re.IGNORECASE)  # of a setting
_LONGEST_PREAMBLE = 5_000_000  # characters
_SAMPLE = 2000  # lines by which it is told how numbers are written
_LONGEST_CELL = 40  # characters that a message repeats


def recognises(head: bytes) -> bool:
    """Whether a file begins as text."""
    return b"\x00" not in head or encoding_of(head).startswith("utf-16")


def read_text(path: Path, delimiter: str | None = None) -> list[Columns]:
    """Read all tables of a text."""
    return tables_of(lines_of_file(path), path, delimiter)


def lines_of_file(path: Path) -> list[str]:
    """Read the lines of a text, with names of channels in whichever encoding."""
    LIMITS["text of a test"].require_small(path)
    words = [word for signs in SIGNS.values() for word in signs.split()]
    return lines_of(decode_text(path.read_bytes(), words))


def tables_of(
    lines: Sequence[str], path: Path, delimiter: str | None = None, *, lines_above: int = 0
) -> list[Columns]:
    """Read the tables of a text in lines, of which `lines_above` stand before them in the file."""
    separator = delimiter if delimiter is not None else delimiter_of(lines)
    text = _Text(lines=lines, delimiter=separator, path=path, lines_above=lines_above)
    tables: list[Columns] = []
    begin = 0
    while (place := text.first_row(begin)) is not None:
        table, begin = text.table(begin, place)
        tables.append(table)
    if not tables:
        raise InputError(
            "No rows of at least two numbers in the file",
            remedy="Export command and measured displacement as columns, or give their `delimiter`",
            where=path.name,
        )
    return join_tables([table for table in tables if next(iter(table.values.values())).size > 1] or tables)


def delimiter_of(lines: Sequence[str]) -> str:
    """Delimiter under which two lines of at least two numbers, else one, come first."""
    count = 0
    for place, line in enumerate(lines):
        count += len(line)
        if count > _LONGEST_PREAMBLE:
            break
        if not is_comment(line):
            for candidate in _DELIMITERS:
                if begins_table(lines, candidate, place):
                    return candidate
    for line in lines[:_LONGEST_PREAMBLE]:
        for candidate in _DELIMITERS:
            if Line(cells=cells_of(line, candidate)).numbers >= FEWEST_COLUMNS:
                return candidate
    return ","


def begins_table(lines: Sequence[str], delimiter: str, place: int) -> bool:
    """Whether this line and the next one that is no comment are rows of numbers of one width."""
    first = Line(cells=cells_of(lines[place], delimiter))
    if len(first.cells) < FEWEST_COLUMNS or not first.holds_numbers:
        return False
    following = next((line for line in islice(lines, place + 1, place + 20) if not is_comment(line)), None)
    if following is None:
        return False
    second = Line(cells=cells_of(following, delimiter))
    return len(second.cells) == len(first.cells) and second.holds_numbers


@dataclass(frozen=True, kw_only=True)
class _Text:
    """Lines of a text with the sign that delimits their cells."""

    lines: Sequence[str]
    delimiter: str
    path: Path
    lines_above: int  # Lines of the file before these

    def first_row(self, begin: int) -> int | None:
        """Find the first row of a table: of two rows of one width, else of any, else one with texts."""
        single = mixed_row = None
        for place in range(begin, len(self.lines)):
            if is_comment(self.lines[place]):
                continue
            if begins_table(self.lines, self.delimiter, place):
                return place
            line = Line(cells=cells_of(self.lines[place], self.delimiter))
            if single is None and len(line.cells) >= FEWEST_COLUMNS and line.holds_numbers:
                single = place
            if mixed_row is None and self._begins_mixed_table(place):
                mixed_row = place
            if mixed_row is not None and place - mixed_row > _HEADER_LINES:
                break
        return mixed_row if single is None else single

    def _begins_mixed_table(self, place: int) -> bool:
        """Whether rows begin in which some columns hold a text, such as a remark."""
        rows = [Line(cells=cells_of(line, self.delimiter)) for line in self.lines[place : place + 4]]
        return len(rows) == 4 and all(  # noqa: PLR2004
            row.numbers >= FEWEST_COLUMNS and len(row.cells) == len(rows[0].cells) for row in rows
        )

    def table(self, begin: int, place: int) -> tuple[Columns, int]:
        """One table, with the names above it, and the place of the line behind it."""
        cells = cells_of(self.lines[place], self.delimiter)
        if len(cells) < FEWEST_COLUMNS:
            raise InputError(
                "Only one column of numbers",
                remedy="Export command and measured displacement as columns, or give their `delimiter`",
                where=self._location(place),
            )
        comma = self._has_decimal_comma(place)
        header = header_of(
            self.lines[begin:place],
            len(cells),
            self.delimiter,
            decimal_comma=comma,
            location=self._location(place),
        )
        self._require_no_row_above(begin, place, header)
        rows, numbers, end = self._quick_rows(place, cells, decimal_comma=comma) or self._rows(
            place, header.names
        )
        columns = [k for k, name in enumerate(header.names) if _holds_anything(rows[:, k], name, cells[k])]
        series = {
            header.names[k]: Series(values=rows[:, k].copy(), unit=header.units[k], unclear=header.unclear[k])
            for k in columns
        }
        table = Columns(
            path=self.path,
            series=series,
            scalars=header.sampling,
            header=header.statements,
            lines=numbers + self.lines_above,
            named=header.named,
        )
        return table, end

    def _location(self, place: int) -> str:
        return f"{self.path.name}, line {place + 1 + self.lines_above}"

    def _has_decimal_comma(self, place: int) -> bool:
        """Whether numbers of a table have a decimal comma; what may be thousands as well is refused."""
        cells = [
            cell
            for line in self.lines[place : place + _SAMPLE]
            for cell in cells_of(line, self.delimiter)
            if cell
        ]
        if may_be_thousands(cells):
            raise InputError(
                "It is unclear whether the comma is a decimal comma or separates thousands",
                value=repr(next(cell for cell in cells if has_decimal_comma(cell))),
                remedy="Export the numbers with a decimal point and without separators of thousands",
                where=self._location(place),
            )
        return any(map(has_decimal_comma, cells))

    def _require_no_row_above(self, begin: int, place: int, header: Header) -> None:
        """Refuse a damaged row between the names and the first sound one."""
        for place_above in range(place - 1, begin - 1, -1):
            cells = cells_of(self.lines[place_above], self.delimiter)
            if tuple(cells[: len(header.names)]) == tuple(header.names) or not header.named:
                return
            row = Line(number=place_above + 1 + self.lines_above, cells=cells)
            if row.numbers and not is_comment(self.lines[place_above]) and not _LABEL.match(cells[0]):
                list(self._numbers(row, header.names, set()))

    def _quick_rows(
        self, place: int, cells: Sequence[str], *, decimal_comma: bool
    ) -> tuple[NDArray[np.float64], NDArray[np.int64], int] | None:
        """All rows at once, if every line has as many cells; None where a line needs to be looked at."""
        body = self.lines[place:]
        while body and not body[-1].strip():
            body = body[:-1]
        if decimal_comma:
            if any("." in line for line in body):
                return None
            body = [line.replace(",", ".") for line in body]
        try:
            rows = np.loadtxt(body, delimiter=self.delimiter or None, comments=None, ndmin=2, quotechar='"')
        except ValueError:
            return None
        if rows.shape != (len(body), len(cells)):
            return None
        return rows, np.arange(place + 1, place + 1 + len(rows)), len(self.lines)

    def _rows(self, place: int, names: Sequence[str]) -> tuple[NDArray[np.float64], NDArray[np.int64], int]:
        """Rows of a table, line by line, up to a line without a number; no row is kept as text."""
        first = cells_of(self.lines[place], self.delimiter)
        texts = {k for k, cell in enumerate(first) if number_of(cell) is None}
        values, numbers = array("d"), array("q")
        end = place
        for end in range(place, len(self.lines)):
            if is_comment(self.lines[end]):
                continue
            cells = cells_of(self.lines[end], self.delimiter)
            if not any(number_of(cell) is not None and cell for cell in cells) or self._begins_header(
                end, cells, names
            ):
                break
            values.extend(self._numbers(Line(number=end + 1 + self.lines_above, cells=cells), names, texts))
            numbers.append(end + 1)
        else:
            end = len(self.lines)
        rows = np.array(values).reshape(-1, len(names))
        for k in texts:
            rows[:, k] = TimesOfDay().count_seconds(rows[:, k])
        return rows, np.array(numbers, dtype=np.int64), end

    def _begins_header(self, place: int, cells: Sequence[str], names: Sequence[str]) -> bool:
        """Whether a line is no row, but stands above a further table, whose names follow."""
        if number_of(cells[0]) is not None or time_of_day(cells[0]) is not None:
            return False
        following = self.lines[place + 1 : place + 1 + _HEADER_LINES]
        return any(cells_of(line, self.delimiter)[: len(names)] == tuple(names) for line in following)

    def _numbers(self, row: Line, names: Sequence[str], texts: set[int]) -> Iterator[float]:
        location = f"{self.path.name}, line {row.number}"
        if len(row.cells) != len(names):
            raise InputError(
                f"{len(row.cells)} columns, but {len(names)} in the first line",
                remedy="Correct the line, or cut the file before it",
                where=location,
            )
        for place, (name, cell) in enumerate(zip(names, row.cells, strict=True)):
            number = time_of_day(cell) if place in texts else number_of(cell)
            if place in texts and number is None:
                number = float("nan")
            if number is None:
                raise InputError(
                    "Not a number",
                    value=repr(cell if len(cell) <= _LONGEST_CELL else f"{cell[:_LONGEST_CELL]} …"),
                    remedy="Correct the line, or cut the file before it",
                    where=f"{location}, column {name}",
                )
            yield number


def _holds_anything(values: NDArray[np.float64], name: str, cell: str) -> bool:
    """Whether a column is more than what a delimiter at the end of each line, or a remark, leaves."""
    return not np.isnan(values).all() or not (name.startswith("column ") or number_of(cell) is None)
