"""CSMIP Volume 2 (``.V2``): for each channel a header, acceleration, velocity and displacement.

One file holds all channels of a station. The line before the acceleration states everything that is needed::

    7500 points of accel data equally spaced at  .010 sec, in cm/sec2. (8f10.6)

and the numbers after it may follow each other without blanks, so that the printed format is needed to
separate them. Velocity and displacement are skipped. The channels of one file are of one event.

References
----------
Shakal, A. F. and Huang, M. J. (1985). *Standard tape format for CSMIP strong-motion data tapes.* OSMS 85-03.
"""

import re

from reliab.motions.faults import Report
from reliab.motions.readers.header import Header, Statement, state_count, state_time_step, state_units
from reliab.motions.readers.source import Source, decode
from reliab.motions.units import AccelerationUnit, find_unit

_SAMPLES = re.compile(
    rb"^[ \t]*(\S*)[ \t]+points[ \t]+of[ \t]+accel\w*[ \t]+data[ \t]+equally[ \t]+spaced[ \t]+at"
    rb"[ \t]*(\S+?)[ \t]*sec\w*\.?,?[ \t]*(?:in[ \t]+([^\n(]*?))?[ \t]*"
    rb"(?:\(\d*[a-zA-Z](\d{1,2})[^\n)]*\))?[^\n(]*$",
    re.IGNORECASE | re.MULTILINE,
)
_AFTER = re.compile(
    rb"^(?:[^\n]*\bpoints[ \t]+of[ \t]+(?:veloc|displ)|/&|[^\n]*\bend[ \t-]+of[ \t-]+data\b)",
    re.IGNORECASE | re.MULTILINE,
)
_CHANNEL = re.compile(
    rb"\bChan(?:nel)?[ \t]*(\d+)[ \t]*:[ \t]*([^\n]*?)[ \t]*(?:\bfrom)?[ \t]*$", re.IGNORECASE | re.MULTILINE
)
_ORIGIN = re.compile(rb"\bOrigin:[ \t]*(\d{1,2}/\d{1,2}/\d{2,4}[ ,\t]+\d{1,2}:\d{2}[:.\d]*)", re.IGNORECASE)
_PEAK = re.compile(rb"^[ \t]*Peak[ \t]+acceleration[ \t]*=[ \t]*\S+[ \t]+(\S+)", re.IGNORECASE | re.MULTILINE)


def recognises(source: Source) -> bool:
    """Tell whether a file announces points of acceleration data the way CSMIP does."""
    return _SAMPLES.search(source.content) is not None


def headers(source: Source, report: Report) -> list[Header]:
    """Read the headers of all channels of a CSMIP file."""
    channels = [
        _channel(source, match, begin, stop, report)
        for match, begin, stop in source.channels(_SAMPLES, _AFTER)
    ]
    if not channels:
        report.add(
            "A CSMIP Volume 2 file must announce its points of accel data",
            line=1,
            value="no such line",
            remedy="Obtain the file again",
        )
    return channels


def _channel(source: Source, match: re.Match[bytes], begin: int, stop: int, report: Report) -> Header:
    line = source.line_number(match.start(1))
    count, step, units, width = (decode(group or b"") for group in match.groups())
    label = _CHANNEL.search(source.content, begin, match.start())
    origin = _ORIGIN.search(source.content, begin, match.start())
    unit = state_units(units.strip().rstrip("."), line, report)
    _check_peak_units(source, unit, begin, match.start(), report)
    return Header(
        start=min(match.end() + 1, stop),
        stop=stop,
        count=state_count(count, line, report),
        time_step=state_time_step(step, line, report),
        units=unit,
        width=int(width) or None if width else None,
        event=" ".join(decode(origin[1]).replace(",", " ").split()) if origin else "",
        channel=decode(label[2]).strip() if label else "",
    )


def _check_peak_units(
    source: Source, unit_of_samples: Statement[AccelerationUnit] | None, begin: int, end: int, report: Report
) -> None:
    """Compare the units of the peak in the text header with those of the samples."""
    peak = _PEAK.search(source.content, begin, end)
    unit = find_unit(decode(peak[1])) if peak else None
    if peak and unit and unit_of_samples and unit is not unit_of_samples.value:
        report.add(
            "A file must state one kind of units",
            line=unit_of_samples.line,
            value=f"{unit_of_samples.value} after {unit} in line {source.line_number(peak.start(1))}",
            remedy="Correct whichever is wrong",
        )
