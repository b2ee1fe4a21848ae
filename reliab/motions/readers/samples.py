"""Parse the samples of a record: all at once, or line by line to locate faults."""

import math
import re
from dataclasses import dataclass

import numpy as np

from reliab.core.arrays import Array
from reliab.core.text_tables import is_number, parse_number
from reliab.motions.faults import Report
from reliab.motions.readers.source import RecordHeader, RecordLine, RecordText

_PLAIN = b"0123456789+-.eE \t\n\r\v\f"
_FORTRAN_EXPONENTS = bytes.maketrans(b"Dd", b"EE")
_CLOCK = re.compile(
    r"[0-9]{4}[-/][0-9]{1,2}[-/][0-9]{1,2}[T ]+([0-9]{1,2}):([0-9]{2}):([0-9]{2})((?:\.[0-9]+)?)Z?"
)
_NOT_FINITE = re.compile(r"[-+]?(?:nan(?:\(\w*\))?|inf(?:inity)?|1\.#(?:qnan|ind|inf)\w*)", re.IGNORECASE)
_GLUED_NUMBER = re.compile(r"[-+]?[0-9]*\.[0-9]+(?:[EeDd][-+][0-9]{2}(?=[-+.]|$)|(?=[-+]|$))")

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
    return next((mark for mark in (";", ",") if mark in line.text), "")


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
