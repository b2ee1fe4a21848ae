"""The bytes of a record file: its lines, what its header states, and its samples."""

import math
import os
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar

import numpy as np

from reliab.core.arrays import Array
from reliab.core.encodings import as_utf8, decode_text
from reliab.core.files import ordinary
from reliab.core.text_tables import is_number, parse_number
from reliab.core.units import AccelerationUnit, ClockUnit
from reliab.motions.faults import Report

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


_PLAIN = b"0123456789+-.eE \t\n\r\v\f"
_FORTRAN_EXPONENTS = bytes.maketrans(b"Dd", b"EE")
_CLOCK = re.compile(
    r"[0-9]{4}[-/][0-9]{1,2}[-/][0-9]{1,2}[T ]+([0-9]{1,2}):([0-9]{2}):([0-9]{2})((?:\.[0-9]+)?)Z?"
)
_NOT_FINITE = re.compile(r"[-+]?(?:nan(?:\(\w*\))?|inf(?:inity)?|1\.#(?:qnan|ind|inf)\w*)", re.IGNORECASE)
_GLUED_NUMBER = re.compile(r"[-+]?[0-9]*\.[0-9]+(?:[EeDd][-+][0-9]{2}(?=[-+.]|$)|(?=[-+]|$))")

DECIMAL_COMMA_DELIMITER = ";"
"""Between numbers that may have a decimal comma."""

_MUST_BE_NUMBER = "Not a number"
_MUST_BE_FINITE = "Not a finite number"
_REMEDY = "Correct the line, export or download the file again, or leave it out"


def parse_samples(source: RecordText, header: RecordHeader, report: Report) -> Array | None:
    """Parse the numbers that a header announces.

    Returns (n,).
    """
    values = _parse_plain(separate_numbers(source, header))
    if values is not None:
        return values
    return _parse_lines(source, header, report)


def separate_numbers(source: RecordText, header: RecordHeader) -> bytes:
    """Return the samples with blanks between numbers, ``E`` before exponents and dates as seconds."""
    data = source.content[header.start : header.stop]
    if b":" in data:
        data = clocks_in_seconds(data.decode("latin-1")).encode("latin-1")
    if b"D" in data or b"d" in data:
        data = data.translate(_FORTRAN_EXPONENTS)
    if header.delimiter == DECIMAL_COMMA_DELIMITER:
        data = data.replace(b",", b".")
    if header.delimiter:
        data = data.replace(header.delimiter.encode(), b" ")
    return data


def clocks_in_seconds(text: str) -> str:
    """Write dates with a time as seconds of the day.

    >>> clocks_in_seconds("2026/05/05 10:00:00.01,0.78")
    '36000.01,0.78'
    """
    if ":" not in text:
        return text
    return _CLOCK.sub(
        lambda match: f"{3600 * int(match[1]) + 60 * int(match[2]) + int(match[3])}{match[4]}", text
    )


def count_rows(data: bytes) -> int:
    """Count the lines that are not empty."""
    return sum(1 for line in data.split(b"\n") if line.strip())


def find_delimiter(line: RecordLine) -> str:
    """Find what separates the numbers of a line, besides blanks."""
    return next((mark for mark in (DECIMAL_COMMA_DELIMITER, ",") if mark in line.text), "")


def _parse_plain(data: bytes) -> Array | None:
    if data.translate(None, _PLAIN):
        return None
    tokens = data.decode("ascii").split()  # numbers are read sooner from text than from bytes
    try:
        values = np.fromiter(map(float, tokens), np.float64, len(tokens))
    except ValueError:
        return None
    return values if np.isfinite(values).all() else None


@dataclass(frozen=True, kw_only=True)
class _BadToken:
    """A token that is not a finite number."""

    line: int
    rule: str
    token: str


def _parse_lines(source: RecordText, header: RecordHeader, report: Report) -> Array | None:
    values: list[float] = []
    bad: list[_BadToken] = []
    for line in source.lines(header.start, header.stop):
        for token in split_line(line, header):
            value = parse_number(token)
            if value is None or not math.isfinite(value):
                is_too_large = value is not None or _NOT_FINITE.fullmatch(token)
                rule = _MUST_BE_FINITE if is_too_large else _MUST_BE_NUMBER
                bad.append(_BadToken(line=line.number, rule=rule, token=token))
            else:
                values.append(value)
    _report_runs(bad, report)
    return None if bad else np.array(values)


def split_line(line: RecordLine, header: RecordHeader) -> list[str]:
    """Split a line into its numbers; blanks between them may be missing where the split is unambiguous."""
    text = clocks_in_seconds(line.text)
    if header.delimiter == DECIMAL_COMMA_DELIMITER:
        text = text.replace(",", ".")
    tokens = (text.replace(header.delimiter, " ") if header.delimiter else text).split()
    if all(map(is_number, tokens)):
        return tokens
    if header.width is not None:
        text, width = line.text.rstrip(), header.width
        return [text[start : start + width].strip() for start in range(0, len(text), width)]
    return [number for token in tokens for number in _split_glued(token)]


def _split_glued(token: str) -> list[str]:
    """Split ``-.1E-02-.2E-02``: a sign after no exponent letter starts a number, if each has its point."""
    parts = _GLUED_NUMBER.findall(token)
    return parts if len(parts) > 1 and "".join(parts) == token else [token]


def _report_runs(bad: list[_BadToken], report: Report) -> None:
    """Report one fault for each run of consecutive lines that break the same rule."""
    start = 0
    for position, token in enumerate(bad):
        following = bad[position + 1] if position + 1 < len(bad) else None
        if following and following.rule == token.rule and following.line <= token.line + 1:
            continue
        first = bad[start]
        end_text = f", and so on to line {token.line}" if token.line > first.line else ""
        token_text = first.token if len(first.token) <= 40 else f"{first.token[:40]}…"  # noqa: PLR2004 - fits a line
        report.add(first.rule, line=first.line, value=f"{token_text!r}{end_text}", remedy=_REMEDY)
        start = position + 1


def line_of_sample(source: RecordText, header: RecordHeader, index: int) -> int | None:
    """Line in which a sample stands, counted from 1."""
    sample_count = 0
    columns = header.columns or 1
    for line in source.lines(header.start, header.stop):
        sample_count += len(split_line(line, header))
        if sample_count > index * columns:
            return line.number
    return None
