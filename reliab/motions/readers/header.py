"""Contents of a record's header, the same for all formats."""

import re
from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from typing import Generic, TypeVar

from reliab.motions.faults import Report
from reliab.motions.units import AccelerationUnit, find_unit

T = TypeVar("T")

_CORRECTION = 0.05  # largest error of a printed step, as a share of the step, however many digits are printed
_SLACK = 1.001  # admits a step exactly on the limit of a header's rounding

NUMBER = r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[EeDd][-+]?[0-9]+)?"
"""Pattern of a number as Fortran and everyone else print it."""


@dataclass(frozen=True, kw_only=True)
class Statement(Generic[T]):
    """One value that a header states."""

    value: T  # The value
    line: int  # The line that states it
    tolerance: float = 0.0  # One unit in the last place that the header prints


@dataclass(frozen=True, kw_only=True)
class Header:
    """What a header says about one record of a file."""

    start: int  # start, stop: Where the samples stand in the file [bytes]
    stop: int
    count: Statement[int] | None = None  # Number of samples
    time_step: Statement[float] | None = None  # Interval between samples [s]
    units: Statement[AccelerationUnit] | None = None  # Units of the samples
    # Units by definition of the format, where the header states none
    default_units: AccelerationUnit | None = None
    scale: float = 1.0  # Factor from the numbers in the file to the units
    # Whether the mean of the whole record is an instrument's offset and is subtracted
    remove_mean: bool = False
    width: int | None = None  # Columns that each number takes, where the format fixes it
    # Numbers in each line, where that matters: one sample, or two with the sample's time first
    columns: int | None = None
    delimiter: str = ""  # What separates numbers, besides blanks
    missing: float | None = None  # The number that marks a missing sample
    event: str = ""  # The earthquake, where the header identifies it
    channel: str = ""  # The component, as the header calls it


def number(text: str) -> float | None:
    """Turn a printed number into a float; None if it is not a number."""
    return float(_decimal(text)) if re.fullmatch(NUMBER, text) else None


def last_place(text: str) -> float:
    """Value of one unit in the last printed place of a number."""
    return float(Decimal(1).scaleb(int(_decimal(text).as_tuple().exponent)))


def may_round(time_step: float, step_of_header: Statement[float]) -> bool:
    """Tell whether a header may print this true step as it does: rounded, cut off, or off by 5 % at most."""
    excess = time_step - step_of_header.value
    place = step_of_header.tolerance * _SLACK
    return -place / 2 <= excess <= place or abs(excess) <= _CORRECTION * step_of_header.value


def _decimal(text: str) -> Decimal:
    try:
        return Decimal(text.upper().replace("D", "E"))
    except InvalidOperation:
        return Decimal("NaN")


def state_count(text: str, line: int, report: Report) -> Statement[int] | None:
    """Read a number of samples, or report that the text is not one."""
    if re.fullmatch(r"\+?[0-9]{1,9}\.?", text):
        count = int(text.rstrip("."))
        if count > 1:
            return Statement(value=count, line=line)
    report.add(
        "The number of samples in a header must be a whole number from 2 on",
        line=line,
        value=text or "nothing",
        remedy="Correct the header",
    )
    return None


def state_time_step(text: str, line: int, report: Report, *, factor: float = 1.0) -> Statement[float] | None:
    """Read a time step, or report that the text is not one; the factor turns its unit into seconds."""
    value = number(text)
    if value is not None and 0 < value * factor < float("inf"):
        return Statement(value=value * factor, line=line, tolerance=last_place(text) * factor)
    report.add(
        "The time step in a header must be a positive number",
        line=line,
        value=text or "nothing",
        remedy="Correct the header or leave the record out",
    )
    return None


def state_units(text: str, line: int, report: Report) -> Statement[AccelerationUnit] | None:
    """Read the units of the samples, or report that the text names none."""
    unit = find_unit(text)
    if unit is not None:
        return Statement(value=unit, line=line)
    report.add(
        "The units in a header must be g, cm/s2 or m/s2",
        line=line,
        value=repr(text.strip()),
        remedy="Convert the record to acceleration in one of them",
    )
    return None
