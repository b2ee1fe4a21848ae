"""What stands above a table of a text: names and units of its columns, statements, and the sampling rate."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

from reliab.core.errors import InputError
from reliab.core.text_tables import COMMENTS, Line, cells_of, number_of
from reliab.recordings.naming import describe
from reliab.recordings.readers.attributes import unclear_in
from reliab.recordings.units import unit_of
from reliab.recordings.words import Measurand

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
_HERTZ: Final = {"hz": 1.0, "khz": 1e3, "mhz": 1e6, "s/s": 1.0, "ks/s": 1e3, "sps": 1.0}
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
        hertz = next((_HERTZ[word.lower()] for word in words if word.lower() in _HERTZ), None)
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
