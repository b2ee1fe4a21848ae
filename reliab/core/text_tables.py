"""One lexer of text tables: lines, cells, numbers and times of day, as programs of any country write them.

Records of ground motions have numbers as Fortran prints them (`NUMBER`), in which nothing else may stand;
recordings of tests also those with decimal commas, signs between thousands and gaps (`number_of`).
"""

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal
from typing import Final

import numpy as np

from reliab.core.arrays import Array

NUMBER: Final = r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[EeDd][-+]?[0-9]+)?"
"""Pattern of a number as Fortran and everyone else print it."""

COMMENTS: Final = ("#", "%", "//", "!")
FEWEST_COLUMNS: Final = 2
_MISSING: Final = frozenset({"", "nan", "na", "n/a", "null", "none", "-nan", "#n/a"})
_SIGNS: Final = str.maketrans({"−": "-", "’": "'", "\u00a0": " ", "\u202f": " ", "\u2009": " "})
_DECIMAL_COMMA: Final = re.compile(r"[+-]?(?:\d*,\d+|\d+,)(?:[eE][+-]?\d+)?")
_NUMBER: Final = re.compile(NUMBER)
_EXPONENTS: Final = str.maketrans("Dd", "EE")
_FORTRAN: Final = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+))(?:[dDqQ]([+-]?\d+)|([+-]\d{3}))")
_THOUSANDS: Final = (  # of which one is no decimal sign: 1,234.5 and 1 234,5 and 1,234,567
    (re.compile(r"[+-]?\d{1,3}(?:,\d{3})+\.\d*|[+-]?\d{1,3}(?:,\d{3}){2,}"), ",", "."),
    (re.compile(r"[+-]?\d{1,3}(?:\.\d{3})+,\d*|[+-]?\d{1,3}(?:\.\d{3}){2,}"), ".", ","),
    (re.compile(r"[+-]?\d{1,3}(?: \d{3})+(?:[.,]\d*)?"), " ", ","),
    (re.compile(r"[+-]?\d{1,3}(?:'\d{3})+(?:[.,]\d*)?"), "'", ","),
)
_PERHAPS_THOUSANDS: Final = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}")
_TIME: Final = re.compile(
    r"(?:(\d{1,2}):)?(\d{1,2}):(\d{2})(?:[.,:](\d{1,9})\d*)?(?!\d|:)\s*(?:([ap])\.?m\b)?", re.IGNORECASE
)
_HALF_DAY: Final = 43200.0  # s


def lines_of(text: str) -> list[str]:
    """Split a text where files end their lines, but not at signs that only Python takes for ends."""
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    return lines if lines[-1] else lines[:-1]


def is_comment(line: str) -> bool:
    """Whether a line is empty or a comment."""
    text = line.strip()
    return not text or text.startswith(COMMENTS)


def cells_of(line: str, delimiter: str) -> tuple[str, ...]:
    """Cells of a line, without blanks and quotation marks around them; blanks delimit where nothing does."""
    if not delimiter:
        parts = line.split()
    elif '"' in line and len(delimiter) == 1:
        try:
            parts = next(csv.reader([line], delimiter=delimiter, skipinitialspace=True))
        except csv.Error:
            parts = line.split(delimiter)
    else:
        parts = line.split(delimiter)
    return tuple(part.strip().strip('"').strip() for part in parts)


def is_number(text: str) -> bool:
    """Whether a text is a number as Fortran prints it."""
    return _NUMBER.fullmatch(text) is not None


def parse_number(text: str) -> float | None:
    """Read a number as Fortran prints it, which may be infinite; None if the text is not one.

    >>> [parse_number(text) for text in ("1.5D-02", "-.1e3", "1,5", "nan")]
    [0.015, -100.0, None, None]
    """
    return float(text.translate(_EXPONENTS)) if is_number(text) else None


def last_place(text: str) -> float:
    """Return one unit in the last printed place of a number."""
    return float(Decimal(1).scaleb(int(Decimal(text.translate(_EXPONENTS)).as_tuple().exponent)))


def number_of(cell: str) -> float | None:
    """Read a number in any notation; NaN where the cell is empty, None where it is neither.

    >>> [number_of(cell) for cell in ("1,5", "1.5D-02", "1,234.5", "1.234.567,5", "1 234,5", "−3", "x")]
    [1.5, 0.015, 1234.5, 1234567.5, 1234.5, -3.0, None]
    """
    try:
        return float(cell)
    except ValueError:
        pass
    if cell.lower() in _MISSING:
        return float("nan")
    plain = cell.translate(_SIGNS)
    if _DECIMAL_COMMA.fullmatch(plain):
        return float(plain.replace(",", "."))
    if match := _FORTRAN.fullmatch(plain):
        return float(f"{match[1]}e{match[2] or match[3]}")
    for pattern, separator, decimal in _THOUSANDS:
        if pattern.fullmatch(plain):
            return float(plain.replace(separator, "").replace(decimal, "."))
    return float(plain) if plain != cell and re.fullmatch(r"[+-]?[\d.]+(?:[eE][+-]?\d+)?", plain) else None


def has_decimal_comma(cell: str) -> bool:
    """Whether a cell is a number whose only sign is a comma."""
    return bool(_DECIMAL_COMMA.fullmatch(cell))


def may_be_thousands(cells: Sequence[str]) -> bool:
    """Whether the commas of cells that hold one may all part thousands, since three digits follow each."""
    comma_cells = [cell for cell in cells if _DECIMAL_COMMA.fullmatch(cell)]
    return 0 < len(comma_cells) < len(cells) and all(map(_PERHAPS_THOUSANDS.fullmatch, comma_cells))


def time_of_day(cell: str) -> float | None:
    """Seconds since midnight in a cell that holds a time of day, perhaps beside a date; None without one.

    >>> [time_of_day(cell) for cell in ("2026-11-24 09:15:30,5", "1:00:05.5 PM", "12:00:00 a.m.", "01:30.25")]
    [33330.5, 46805.5, 0.0, 90.25]
    """
    match = _TIME.search(cell)
    if match is None or (match[1] is None and match[4] is None):
        return None
    hours = float(match[1] or 0.0)
    if match[5] is not None:
        hours = hours % 12.0 + 12.0 * (match[5].lower() == "p")
    return 3600.0 * hours + 60.0 * float(match[2]) + float(f"{match[3]}.{match[4] or 0}")


@dataclass(kw_only=True)
class TimesOfDay:
    """Times of day that follow one another, counted from the first one on, beyond midnight too."""

    first: float | None = None  # s
    before: float = 0.0  # s, the last one that was counted
    days: float = 0.0  # s, of the midnights so far

    def count_seconds(self, seconds: Array) -> Array:
        """Count further times of day [s], shape (n,)."""
        if not seconds.size:
            return seconds
        if self.first is None:
            self.first = self.before = float(seconds[0])
        wraps = np.diff(seconds, prepend=self.before) < -_HALF_DAY
        days = self.days + 2.0 * _HALF_DAY * np.cumsum(wraps)
        self.before, self.days = float(seconds[-1]), float(days[-1])
        return np.asarray(seconds + days - self.first)


@dataclass(frozen=True, kw_only=True)
class Line:
    """A line of a text, in its cells."""

    cells: tuple[str, ...]
    number: int = 0  # counted from 1

    @property
    def holds_numbers(self) -> bool:
        """Whether all cells are numbers, times of day or gaps between them, and more than gaps."""
        numbers = [number_of(cell) for cell in self.cells]
        is_numeric = all(
            n is not None or time_of_day(cell) is not None
            for n, cell in zip(numbers, self.cells, strict=True)
        )
        return is_numeric and any(number is not None and np.isfinite(number) for number in numbers)

    @property
    def numbers(self) -> int:
        """How many cells are numbers."""
        return sum(number is not None and np.isfinite(number) for number in map(number_of, self.cells))


_USUAL_MARKS = frozenset(
    [*(float("9" * digits) for digits in range(3, 8)), 999.25, 999.9, 999.99, 32767.0, 32768.0]
)
_LARGEST_NUMBER = 1e10  # from which a number marks gaps: 1e20, 9.97e36 of netCDF, 1.7e38 of SMC
_STANDING_OUT = 1.5  # times the largest deviation of the others, from which a usual mark is one
_FAR_OUT = 3.0  # times the largest deviation of the others, from which any repeated number is a mark
_FEWEST_REPETITIONS = 3  # times that a mark is repeated exactly
_FEWEST_VALUES = 10  # fewest different numbers of a history


def missing_mark(values: Array, *, any_repeated: bool = False) -> float | None:
    """Find the number that marks gaps in a history, shape (n,); None where none does.

    `any_repeated`: whether an outlier of any size that is repeated exactly is a mark.

    >>> history = np.sin(np.arange(100.0))
    >>> history[20:30] = -9999.0
    >>> missing_mark(history)
    -9999.0
    """
    deviations = np.abs(values - np.median(values))
    mark = float(values[deviations.argmax()])
    is_usual = abs(mark) in _USUAL_MARKS or abs(mark) >= _LARGEST_NUMBER
    if not (is_usual or any_repeated):
        return None
    other_deviations = deviations[values != mark]
    if not other_deviations.size or deviations.max() <= _STANDING_OUT * other_deviations.max():
        return None
    is_repeated = (
        values.size - other_deviations.size >= _FEWEST_REPETITIONS
        and deviations.max() > _FAR_OUT * other_deviations.max()
    )
    return mark if (is_usual or is_repeated) and np.unique(values).size >= _FEWEST_VALUES else None
