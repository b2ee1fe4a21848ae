"""COSMOS format (``.V2c``, ``.V1``): text, integer and real headers, comments, then one quantity per channel.

A file may hold one channel or several, and velocity and displacement beside acceleration; those are skipped.
The line before the samples states their number, units and printed format::

    42000 acceleration pts, approx  210 secs, units=cm/sec2(04),Format=(1E15.6)

The step is value 62 of the real header, in milliseconds (value 34 is the step of the raw record, before
processing).

References
----------
COSMOS Strong Motion Programs Board (2001). *COSMOS strong motion data format*, version 1.20.
"""

import re

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
from reliab.motions.readers.source import Source, decode

_FIRST_LINE = re.compile(rb"[^\n]*\(Format\s+v\s*[\d.]+[^\n]*text\s+lines", re.IGNORECASE)
_SAMPLES = re.compile(
    rb"^[ \t]*(\S+)[ \t]+(accel\w*|veloc\w*|displ\w*)[ \t]+(?:data[ \t]+)?(?:pts|points)\b[^\n]*$",
    re.IGNORECASE | re.MULTILINE,
)
_UNITS = re.compile(r"units\s*=\s*([^(,]+)", re.IGNORECASE)
_WIDTH = re.compile(r"Format\s*=\s*\(\s*\d*\s*[A-Z]\s*(\d{1,2})", re.IGNORECASE)
_END = re.compile(rb"^[ \t]*(?:/&)?[^\n\d]*\bEnd[ \t-]*of[ \t-]*data\b", re.IGNORECASE | re.MULTILINE)
_REALS = re.compile(
    rb"^[ \t]*(\d{1,6})[ \t]+Real-header[^\n]*?\(\s*\d*\s*[A-Z]\s*(\d{1,2})[^\n]*$",
    re.IGNORECASE | re.MULTILINE,
)
_MISSING = re.compile(rf"unknown[^\n]*?:[^\n]*?,\s*({NUMBER})\s*$".encode(), re.IGNORECASE | re.MULTILINE)
_CHANNEL = re.compile(rb"^Sta[ \t]+Chan[ \t]*(\S+?):[ \t]*([^\n(]*?)[ \t]*\(", re.IGNORECASE | re.MULTILINE)
_ORIGIN = re.compile(rb"^Origin:[ \t]*(\d[\d/]+[ ,\t]+\d{1,2}:\d{2}[:.\d]*)", re.IGNORECASE | re.MULTILINE)
_STEP_POSITION = 62  # counted from 1, as in the specification
_UNKNOWN = -999.0  # marks an unknown value where the text header names no other mark


def recognises(source: Source) -> bool:
    """Tell whether the first line names a version of the COSMOS format."""
    return _FIRST_LINE.match(source.content.lstrip()) is not None


def headers(source: Source, report: Report) -> list[Header]:
    """Read the headers of all acceleration channels of a COSMOS file."""
    channels = [
        _channel(source, match, begin, stop, report)
        for match, begin, stop in source.channels(_SAMPLES, _END)
        if match[2].lower().startswith(b"accel")
    ]
    if not channels:
        report.add(
            "A COSMOS file must hold acceleration",
            line=1,
            value="no line that announces acceleration points",
            remedy="Obtain the file of acceleration (.acc)",
        )
    return channels


def _channel(source: Source, match: re.Match[bytes], begin: int, stop: int, report: Report) -> Header:
    line = source.line_number(match.start(1))
    announcement = decode(match[0])
    units, width = _UNITS.search(announcement), _WIDTH.search(announcement)
    label = _CHANNEL.search(source.content, begin, match.start())
    origin = _ORIGIN.search(source.content, begin, match.start())
    missing = _missing(source, begin, match.start())
    return Header(
        start=min(match.end() + 1, stop),
        stop=stop,
        count=state_count(decode(match[1]), line, report),
        time_step=_time_step(source, begin, match.start(), missing, report),
        units=state_units(units[1] if units else "", line, report),
        width=int(width[1]) or None if width else None,
        missing=missing,
        event=" ".join(decode(origin[1]).replace("/", "-").split()) if origin else "",
        channel=decode(label[2]).strip() if label else "",
    )


def _missing(source: Source, begin: int, end: int) -> float:
    match = _MISSING.search(source.content, begin, end)
    value = number(decode(match[1])) if match else None
    return _UNKNOWN if value is None else value


def _time_step(
    source: Source, begin: int, end: int, missing: float, report: Report
) -> Statement[float] | None:
    """Value 62 of the real header; None where the header marks it as unknown."""
    match = _REALS.search(source.content, begin, end)
    if match is None or int(match[1]) < _STEP_POSITION or int(match[2]) == 0:
        report.add(
            "A COSMOS file must have a real header with the time step as value 62",
            line=source.line_number(begin),
            remedy="Obtain the file again",
        )
        return None
    width, position = int(match[2]), 0
    for line in source.lines(match.end() + 1, end):
        fields = [line.text[i : i + width].strip() for i in range(0, len(line.text.rstrip()), width)]
        if position + len(fields) >= _STEP_POSITION:
            text = fields[_STEP_POSITION - position - 1]
            return (
                None if number(text) == missing else state_time_step(text, line.number, report, factor=1e-3)
            )
        position += len(fields)
    return state_time_step("", source.line_number(end), report)
