"""PEER AT2: free text, a line with NPTS and DT, then samples in g unless the header says otherwise.

The line with the number of samples and the step has been printed in many ways over the years; all of these
are read::

    NPTS=  1800, DT= .02000 SEC
    NPTS =   1984 , DT =   .0066 SEC ,
    NPTS=   9557, DT=   .0050 SEC,   4 POLE @    30.00000 HZ,  -5 POLE @      .13000
    4096    .0100    NPTS, DT

The title line of the header names the earthquake and its date; two records with the same earthquake and date
come from one event.
"""

import re

from reliab.motions.faults import Report
from reliab.motions.readers.header import NUMBER, Header, Statement, state_count, state_time_step, state_units
from reliab.motions.readers.source import LONGEST_LINE, Line, Source
from reliab.motions.units import AccelerationUnit

_HEADER_LINES = 30
_TITLE = 1  # the second line that is not blank
_VALUE = rf"({NUMBER}|[^\s,;=:]+)"
_LABEL_FIRST = re.compile(rf"\bNPTS\b\s*[=:]?\s*(?!DT\b){_VALUE}.*?\bDT\b\s*[=:]?\s*{_VALUE}", re.IGNORECASE)
_STEP_FIRST = re.compile(rf"\bDT\b\s*[=:]?\s*(?!NPTS\b){_VALUE}.*?\bNPTS\b\s*[=:]?\s*{_VALUE}", re.IGNORECASE)
_VALUE_FIRST = re.compile(rf"^\s*{_VALUE}[\s,]+{_VALUE}[\s,]+NPTS[\s,]+DT\b", re.IGNORECASE)
_LABELS_FIRST = re.compile(rf"\bNPTS[\s,]+DT\s*[=:]\s*{_VALUE}[\s,]+{_VALUE}", re.IGNORECASE)
_BOTH = re.compile(r"\bNPTS\b.*\bDT\b|\bDT\b.*\bNPTS\b", re.IGNORECASE)
_UNITS = re.compile(r"\bUNITS?\s*(?:OF|ARE|IN|[:=])\s*([^.,;:\s]+(?:\s?/\s?[^.,;:\s]+)*)", re.IGNORECASE)
_NOT_ACCELERATION = re.compile(r"\b(VELOCITY|DISPLACEMENT)\s+(?:TIME|IN UNITS)", re.IGNORECASE)
_DATE = re.compile(r"\b(\d{1,2})/(\d{1,2})/(\d{4}|\d{2})\b")
_CENTURY_TURNS = 30  # the PEER database of 2000 printed years with two digits; 1933 is its first record


def recognises(source: Source) -> bool:
    """Tell whether a file has the line with NPTS and DT, outside of a comment."""
    return _sizes_line(_top(source)) is not None


def headers(source: Source, report: Report) -> list[Header]:
    """Read the header of an AT2 file.

    Returns the header of the one record; empty if the line with NPTS and DT is missing.
    """
    top = _top(source)
    sizes = _sizes_line(top)
    if sizes is None:
        report.add(
            "The header of an AT2 file must state NPTS and DT",
            line=min(4, len(top)),
            remedy="Obtain the file again or read it as plain text",
        )
        return []
    count, time_step = _parse_sizes(sizes)
    before = top[: top.index(sizes)]
    return [
        Header(
            start=sizes.stop,
            stop=len(source.content),
            count=state_count(count, sizes.number, report),
            time_step=state_time_step(time_step, sizes.number, report),
            units=_units([*before, sizes], report),
            default_units=AccelerationUnit.GRAVITY,
            event=_event(before),
        )
    ]


def _top(source: Source) -> list[Line]:
    return [line for _, line in zip(range(_HEADER_LINES), source.lines(), strict=False)]


def _sizes_line(top: list[Line]) -> Line | None:
    for line in top:
        if (
            len(line.text) <= LONGEST_LINE
            and _BOTH.search(line.text)
            and not line.text.lstrip().startswith(("#", "%", "!"))
        ):
            return line
    return None


def _parse_sizes(line: Line) -> tuple[str, str]:
    for pattern in (_VALUE_FIRST, _LABEL_FIRST, _LABELS_FIRST):
        if match := pattern.search(line.text):
            return match[1], match[2]
    if match := _STEP_FIRST.search(line.text):
        return match[2], match[1]
    return "", ""


def _units(lines: list[Line], report: Report) -> Statement[AccelerationUnit] | None:
    of_header: Statement[AccelerationUnit] | None = None
    for line in lines:
        if kind := _NOT_ACCELERATION.search(line.text):
            report.add("A record must be of acceleration", line=line.number, value=kind[1].lower())
        elif match := _UNITS.search(line.text):
            unit = state_units(match[1], line.number, report)
            if unit and of_header and unit.value != of_header.value:
                report.add(
                    "A file must state one kind of units",
                    line=unit.line,
                    value=f"{unit.value} after {of_header.value} in line {of_header.line}",
                    remedy="Correct whichever is wrong",
                )
            of_header = of_header or unit
    return of_header


def _event(before: list[Line]) -> str:
    """Earthquake and date from the title line, as in ``LOMA PRIETA 1989-10-18``; empty without both."""
    texts = [line.text for line in before if line.text.strip()]
    title = texts[_TITLE] if len(texts) > _TITLE else ""
    match = _DATE.search(title)
    name = " ".join(title[: match.start()].replace(",", " ").split()).upper() if match else ""
    if match is None or not name:
        return ""
    month, day, year = (int(digits) for digits in match.groups())
    if len(match[3]) == 2:  # noqa: PLR2004 - a year of two digits
        year += 1900 if year >= _CENTURY_TURNS else 2000
    return f"{name} {year}-{month:02}-{day:02}"
