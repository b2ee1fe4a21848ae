"""The bytes of a record file, where its lines are, and what its header states."""

import os
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar

from reliab.core.arrays import Array
from reliab.core.encodings import as_utf8, decode_text
from reliab.core.files import ordinary
from reliab.motions.faults import Report
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
class RecordHeader:
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
    corrections: tuple[str, ...] = ()  # What the header says of its numbers and is applied, in words
    values: Array | None = None  # The samples of a binary file, in place of numbers in its text


def may_round(time_step: float, step_of_header: Statement[float]) -> bool:
    """Tell whether a header may print this true step as it does: rounded, cut off, or off by 5 % at most."""
    excess = time_step - step_of_header.value
    place = step_of_header.tolerance * _SLACK
    return -place / 2 <= excess <= place or abs(excess) <= _CORRECTION * step_of_header.value


HEAD = 65_536
"""Bytes in which every header of a one-record file ends."""

MOST_BYTES = 200_000_000
"""Largest size of a file: two million samples, the most of a motion, in several channels."""

LONGEST_LINE = 1000
"""Largest length of a line of a header."""

_MEGABYTE = 1e6
_END_OF_FILE = b"\x1a"  # what old DOS programs put after the text
_CONTROL = bytes(set(range(32)) - set(b"\t\n\v\f\r\x1a")) + b"\x7f"


@dataclass(frozen=True, kw_only=True)
class RecordLine:
    """One line of a file."""

    number: int  # Counted from 1
    start: int  # start, stop: Where it starts, and where the next one does [bytes]
    stop: int
    text: str  # The line without its end


@dataclass(frozen=True, kw_only=True)
class RecordText:
    r"""A file in memory."""

    path: Path  # The file
    content: bytes  # Its bytes; of a text with ``\n`` at the end of every line
    is_text: bool = True  # Whether it is a text

    def line_number(self, offset: int) -> int:
        """Line in which a byte stands, counted from 1."""
        return self.content.count(b"\n", 0, offset) + 1

    def lines(self, start: int = 0, stop: int | None = None) -> Iterator[RecordLine]:
        """Go through the lines from one byte to another."""
        end = len(self.content) if stop is None else stop
        number = self.line_number(start)
        while start < end:
            newline = self.content.find(b"\n", start, end)
            following = end if newline < 0 else newline + 1
            yield RecordLine(
                number=number, start=start, stop=following, text=decode(self.content[start:following])
            )
            start, number = following, number + 1

    def channels(
        self, announcement: re.Pattern[bytes], end: re.Pattern[bytes]
    ) -> Iterator[tuple[re.Match[bytes], int, int]]:
        """Go through the channels of a file of several.

        Yields [bytes].
        """
        begin = 0
        for match in announcement.finditer(self.content):
            next_end = end.search(self.content, match.end())
            stop = next_end.start() if next_end else len(self.content)
            yield match, begin, stop
            begin = stop


def is_file(path: Path) -> bool:
    """Tell whether a path is a file; False where the system cannot access it."""
    try:
        return path.is_file()
    except OSError:
        return False


def is_folder(path: Path) -> bool:
    """Tell whether a path is a folder; False where the system cannot access it."""
    try:
        return path.is_dir()
    except OSError:
        return False


def decode(raw: bytes) -> str:
    """Decode a piece of a header: UTF-8 where it is, Latin-1 otherwise, without the line's end."""
    return decode_text(raw).rstrip("\r\n")


def open_source(
    path: Path,
    report: Report,
    *,
    limit: int | None = None,
    byte_limit: int = MOST_BYTES,
    binary: bool = False,
) -> RecordText | None:
    """Read a file, or report why it cannot be read.

    `byte_limit` [bytes]; `binary`: whether it may be other than text.
    Returns the file; None if it is missing, unreadable, too large, empty or other than text.
    """
    raw = _read(path, report, limit, byte_limit)
    if raw is None:
        return None
    content = as_utf8(raw).rstrip(_END_OF_FILE)
    if b"\r" in content:
        content = content.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    if not content.strip():
        report.add("The file is empty", line=1, remedy="Export or download it again, or leave it out")
        return None
    if len(content[:HEAD].translate(None, _CONTROL)) < len(content[:HEAD]):
        if binary:
            return RecordText(path=path, content=raw, is_text=False)
        report.add(
            "Not a text file",
            line=1,
            value="binary data",
            remedy="Unpack it or export it as text",
        )
        return None
    return RecordText(path=path, content=content)


def _read(path: Path, report: Report, limit: int | None, byte_limit: int) -> bytes | None:
    try:
        with ordinary(path).open("rb") as stream:
            if limit is None and os.fstat(stream.fileno()).st_size > byte_limit:
                report.add(
                    f"The file is larger than {byte_limit / _MEGABYTE:,.6g} MB",
                    remedy="Keep the strong part of the record, or write its channels to files of their own",
                )
                return None
            return stream.read(limit)
    except FileNotFoundError:
        report.add("No such file", remedy="Correct the path")
    except IsADirectoryError:
        report.add("Not a file", value="a folder", remedy="Name one of its files")
    except OSError as error:
        report.add(f"Cannot read the file: {error.strerror}", remedy="Check its permissions")
    return None
