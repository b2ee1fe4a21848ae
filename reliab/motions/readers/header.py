"""Contents of a record's header, the same for all formats."""

from dataclasses import dataclass
from typing import Generic, TypeVar

from reliab.core.arrays import Array
from reliab.motions.units import AccelerationUnit, ClockUnit

T = TypeVar("T")

_CORRECTION = 0.05  # largest error of a printed step, as a share of the step, however many digits are printed
_SLACK = 1.001  # admits a step exactly on the limit of a header's rounding


@dataclass(frozen=True, kw_only=True)
class Statement(Generic[T]):
    """One value that a header states."""

    value: T  # The value
    line: int | None  # The line that states it; None in a binary file
    tolerance: float = 0.0  # One unit in the last place that the header prints


@dataclass(frozen=True, kw_only=True)
class Header:
    """What a header says about one record of a file."""

    start: int = 0  # start, stop: Where the samples stand in the file [bytes]
    stop: int = 0
    count: Statement[int] | None = None  # Number of samples
    time_step: Statement[float] | None = None  # Interval between samples [s]
    units: Statement[AccelerationUnit] | None = None  # Units of the samples
    # Units by definition of the format, where the header states none
    default_units: AccelerationUnit | None = None
    scale: float = 1.0  # Factor from the numbers in the file to the units
    offset: float = 0.0  # The number in the file that stands for no acceleration
    # Whether the mean of the whole record is an instrument's offset and is subtracted
    remove_mean: bool = False
    width: int | None = None  # Columns that each number takes, where the format fixes it
    columns: int | None = None  # Numbers of a row, where samples stand in columns
    column: int = 0  # The column of the samples, from 0
    time_column: int | None = None  # The column of times or of sample numbers, from 0
    time_unit: ClockUnit | None = None  # Unit of the times, where the header states it
    has_rows: bool = True  # Whether each row of the columns is a line of the file
    delimiter: str = ""  # What separates numbers, besides blanks
    missing: tuple[float, ...] = ()  # Numbers that mark a missing sample
    event: str = ""  # The earthquake, where the header identifies it
    channel: str = ""  # The component, as the header calls it
    applied: tuple[str, ...] = ()  # What the header says of its numbers and is applied, in words
    values: Array | None = None  # The samples of a binary file, in place of numbers in its text


def may_round(time_step: float, step_of_header: Statement[float]) -> bool:
    """Tell whether a header may print this true step as it does: rounded, cut off, or off by 5 % at most."""
    excess = time_step - step_of_header.value
    place = step_of_header.tolerance * _SLACK
    return -place / 2 <= excess <= place or abs(excess) <= _CORRECTION * step_of_header.value
