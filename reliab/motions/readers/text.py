"""Plain text and CSV: samples in one column, or times and samples in two.

Lines before the first number may give further data, marked with ``#``, ``%``, ``!`` or ``//`` or beginning
with a letter::

    # time_step: 0.01        or  dt = 0.01 s,  dt: 10 ms,  sampling rate: 100 Hz
    # units: m/s2            or  time [s], acceleration [m/s2]  or  time_s,acceleration_g
    # samples: 4096          or  npts = 4096
    # event: KOBE

Numbers are separated by blanks, tabs, commas or semicolons. Units that are stated nowhere are not guessed.
"""

import re
from collections.abc import Iterator
from typing import TypeVar

from reliab.motions.faults import Report
from reliab.motions.readers.header import (
    NUMBER,
    Header,
    Statement,
    number,
    state_count,
    state_time_step,
    state_units,
)
from reliab.motions.readers.samples import split_line
from reliab.motions.readers.source import HEAD, LONGEST_LINE, Line, Source
from reliab.motions.units import AccelerationUnit, find_unit

T = TypeVar("T")

_COMMENT = ("#", "%", "!", "//")
_FLAGS = re.IGNORECASE
_VALUE = rf"({NUMBER}|[^\s,;\])]+)"
_STEP = re.compile(
    rf"\b(?:dt|delta[ _]?t|time[ _]?step|sampling[ _](?:interval|period|step))(?:_s|\s*[\[(]s[\])])?"
    rf"\s*[=:]\s*{_VALUE}\s*(ms\b|msec)?",
    _FLAGS,
)
_RATE = re.compile(
    rf"\b(?:fs|rate_hz|sampl(?:ing|e)[ _](?:rate|freq(?:uency)?))(?:_hz|\s*[\[(]hz[\])])?\s*[=:]\s*{_VALUE}",
    _FLAGS,
)
_COUNT = re.compile(rf"\b(?:npts|n?samples|number[ _]of[ _](?:points|samples))\s*[=:]\s*{_VALUE}", _FLAGS)
_NAMES = re.compile(r"^[#%!/\s]*(?:motion|event|name)\s*[=:]", _FLAGS)
_EVENT = re.compile(r"^[#%!/\s]*event\s*[=:]\s*(.+?)\s*$", _FLAGS)
_UNITS = re.compile(r"\bunits?\s*(?:of|are|is|in|[=:])\s*(.+)", _FLAGS)
_PER_SECOND = re.compile(r"[a-z]\s*/\s*s", _FLAGS)
_SLASHED = r"c?m/s(?:/s|(?:\^|\*\*)?[2²])"
_COLUMN_UNITS = (
    re.compile(r"\b(?:acc\w*|a_?g?)\b[^\[(,;]*[\[(]([^\])]+(?:\)\w*)?)[\])]", _FLAGS),
    re.compile(rf"(?<![a-z])acc[a-z]*(?:_[a-z])?_(g|gal|c?mps2|c?m_s2|{_SLASHED})(?!\w)", _FLAGS),
    re.compile(r"\bacc\w*\s+in\s+(\S+)", _FLAGS),
)


def recognises(source: Source) -> bool:
    """Tell whether a file has a line of one or two numbers near its top."""
    return any(_is_data(line) for line in source.lines(0, min(HEAD, len(source.content))))


def headers(source: Source, report: Report) -> list[Header]:
    """Read the header of a plain text file.

    Returns the header of the one record; empty if there is no line of one or two numbers.
    """
    top, first = _split_top(source)
    if first is None:
        report.add(
            "A record must hold samples", line=1, value="no line of numbers", remedy="Leave the file out"
        )
        return []
    delimiter = _delimiter(first)
    columns = len(split_line(first, Header(start=0, stop=0, delimiter=delimiter)))
    if columns not in {1, 2}:
        report.add(
            "A text record must have one column, or two with times first",
            line=first.number,
            value=f"{columns} columns",
            remedy="Export the component alone, or mark lines of the header with #",
        )
        return []
    events = (match[1] for line in top if (match := _EVENT.match(line.text)))
    said = [line for line in top if len(line.text) <= LONGEST_LINE and not _NAMES.match(line.text)]
    return [
        Header(
            start=first.start,
            stop=len(source.content),
            count=_first(_counts(said, report)),
            time_step=_agreeing(list(_time_steps(said, report)), "time step", report),
            units=_agreeing(list(_stated_units(said, report)), "kind of units", report),
            columns=columns,
            delimiter=delimiter,
            event=_first(events) or "",
        )
    ]


def _split_top(source: Source) -> tuple[list[Line], Line | None]:
    """Lines before the samples, and the first line of samples."""
    top: list[Line] = []
    for line in source.lines():
        text = line.text.strip()
        if text and not text.startswith(_COMMENT) and (_is_data(line) or not _is_prose(text)):
            return top, line
        top.append(line)
    return top, None


def _is_data(line: Line) -> bool:
    """Tell whether every token of a line is a number; NaN and infinity count as numbers."""
    tokens = re.split(r"[\s,;]+", line.text.strip(" \t\r\f,;"))
    return all(
        number(token) is not None or re.fullmatch(r"[-+]?(nan|inf|infinity)", token, _FLAGS)
        for token in tokens
    )


def _is_prose(text: str) -> bool:
    return text[0].isalpha() or text[0] in "\"'([<"


def _delimiter(line: Line) -> str:
    return next((mark for mark in (";", ",") if mark in line.text), "")


def _first(statements: Iterator[T]) -> T | None:
    return next(statements, None)


def _agreeing(statements: list[Statement[T]], what: str, report: Report) -> Statement[T] | None:
    """Return the first of several statements, and report the one that contradicts it."""
    for later in statements[1:]:
        if later.value != statements[0].value:
            report.add(
                f"A file must state one {what}",
                line=later.line,
                value=f"{later.value} after {statements[0].value} in line {statements[0].line}",
                remedy="Correct whichever is wrong",
            )
    return statements[0] if statements else None


def _counts(said: list[Line], report: Report) -> Iterator[Statement[int]]:
    for line in said:
        if (match := _COUNT.search(line.text)) and (count := state_count(match[1], line.number, report)):
            yield count


def _time_steps(said: list[Line], report: Report) -> Iterator[Statement[float]]:
    for line in said:
        if match := _STEP.search(line.text):
            step = state_time_step(match[1], line.number, report, factor=1e-3 if match[2] else 1.0)
            if step:
                yield step
        elif match := _RATE.search(line.text):
            rate = number(match[1])
            if rate is None or not 0 < rate < float("inf"):
                state_time_step(match[1], line.number, report)
            else:
                yield Statement(value=1.0 / rate, line=line.number)


def _stated_units(said: list[Line], report: Report) -> Iterator[Statement[AccelerationUnit]]:
    for line in said:
        named = _named_units(line.text)
        if named and (units := state_units(named, line.number, report)):
            yield units


def _named_units(text: str) -> str | None:
    """Return what a line of the header calls the units of acceleration, known or not."""
    if match := _UNITS.search(text):
        return _unit_among(match[1])
    matches = (match[1] for pattern in _COLUMN_UNITS if (match := pattern.search(text)))
    return _first(name for name in matches if find_unit(name) or _PER_SECOND.search(name))


def _unit_among(text: str) -> str:
    """Return the part of ``s, m/s2`` or of ``acceleration: g`` that is a unit, or else all of it."""
    parts = re.split(r"[,;:=]|\band\b|\bin\b", text, flags=_FLAGS)
    return next((word for word in parts if find_unit(word)), text)
