"""How publishers of records lay out their text files, one row each; all headers are read by one lexer.

References
----------
NIED, *K-NET ASCII format* and *K-NET and KiK-net: questions and answers*, questions 1 and 2.
Shakal, A. F. and Huang, M. J. (1985). *Standard tape format for CSMIP strong-motion data tapes.* OSMS 85-03.
COSMOS Strong Motion Programs Board (2001). *COSMOS strong motion data format*, version 1.20.
Cousins, W. J. (2008). *GNS accelerogram data files: standard format.*
U.S. Geological Survey. *SMC-format data files.*
"""

import itertools
import math
import re
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from reliab.core.text_tables import parse_number
from reliab.core.units import AccelerationUnit, ClockUnit
from reliab.motions.faults import Report
from reliab.motions.readers.source import HEAD, RecordHeader, RecordLine, RecordText, Statement, split_line
from reliab.motions.readers.statements import state_time_step

_EVENT = re.compile(r"^\W*event\s*[=:]\s*(.+?)\s*$", re.IGNORECASE)
_EARTHQUAKE = r"^\W*(?:event|earthquake)"
_IDENTITY = re.compile(rf"{_EARTHQUAKE}[ _]id\s*[=:]\s*(\S+)", re.IGNORECASE)
_NAME = re.compile(rf"{_EARTHQUAKE}(?:[ _]name)?\s*[=:]\s*(\S.*?)\s*$", re.IGNORECASE)
_DATE = r"(\d{8}|\d{4}[/-]\d{1,2}[/-]\d{1,2}|\d{1,2}[/-]\d{1,2}[/-](?:\d{4}|\d{2}))(?!\d)"
_TIME = r"(\d{1,2}:\d{2}(?::[\d.]*\d)?|\d{6}(?:\.\d+)?)(?!\d)"
_DAY = re.compile(
    rf"(?:{_EARTHQUAKE}[ _]date\w*|^\W*fecha\s+del\s+sismo[^:]*|\borigin(?:[ _]?time)?(?:\s*\([^)]*\))*)"
    rf"\s*[=:\s]\s*{_DATE}(?:[ ,T-]+{_TIME})?",
    re.IGNORECASE,
)
_CLOCK = re.compile(
    rf"(?:{_EARTHQUAKE}[ _]time\w*|^\W*hora\s+epicentro[^:]*)\s*[=:]\s*{_TIME}", re.IGNORECASE
)
_LATITUDE = re.compile(r"^\W*(?:event\s+)?lat(?:\.|itude)\W\s*([\d.+-]+)", re.IGNORECASE)
_LONGITUDE = re.compile(r"^\W*(?:event\s+)?long?(?:\.|itude)\W\s*([\d.+-]+)", re.IGNORECASE)
_TITLE = 1  # the second line that is not blank
_TITLE_DATE = re.compile(r"\b(\d{1,2}/\d{1,2}/(?:\d{4}|\d{2}))\b")
_SPELLED_DATE = re.compile(r"^\s*(\d{4})\s+([A-Z][a-z]{2})[a-z]*\s+(\d{1,2})\s+(\d{1,2}:\d{2}:\d{2})\s+U")
_MONTHS = ("Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec")
_DAY_AND_PLACE = re.compile(r"^\s*(\d{4})\s+(\d{1,2})\s+(\d{1,2})\s+\d{4}\s+([A-Za-z].*?)\s*$")
_CENTURY_TURNS = 30  # records of 2000 print years with two digits; 1933 is the first record
_NEVER_SET = "1980-01-01"  # the day at which the clocks of recorders begin

FindEvent = Callable[[list[RecordLine]], str]


def find_event(lines: list[RecordLine]) -> str:
    """Name the earthquake by what labels say of it; empty where that does not identify it."""
    return _first(_EVENT, lines) or _identify(lines)


def find_american_event(lines: list[RecordLine]) -> str:
    """Name the earthquake where dates begin with the month."""
    return _identify(lines, month_first=True)


def find_event_with_place(lines: list[RecordLine]) -> str:
    """Name it by origin time and epicentre, as in ``2018-01-24 19:51:00 41.0N 142.5E``."""
    origin, latitude, longitude = _identify(lines), _first(_LATITUDE, lines), _first(_LONGITUDE, lines)
    return f"{origin} {latitude}N {longitude}E" if origin and latitude and longitude else ""


def find_titled_event(lines: list[RecordLine]) -> str:
    """Name it by name and date in the title, as in ``LOMA PRIETA 1989-10-18``; empty without both."""
    texts = [line.text for line in lines if line.text.strip()]
    title = texts[_TITLE] if len(texts) > _TITLE else ""
    match = _TITLE_DATE.search(title)
    name = _capitals(title[: match.start()]) if match else ""
    return f"{name} {_iso(match[1], month_first=True)}" if match and name else ""


def find_event_in_words(lines: list[RecordLine]) -> str:
    """Name it by a line such as ``2016 November 13  11:02:56 UT`` or ``1989 10 18 0004 Loma Prieta``."""
    for line in lines:
        if (match := _SPELLED_DATE.match(line.text)) and match[2] in _MONTHS:
            return f"{match[1]}-{_MONTHS.index(match[2]) + 1:02}-{int(match[3]):02} {match[4]}"
        if match := _DAY_AND_PLACE.match(line.text):
            return f"{_capitals(match[4])} {match[1]}-{int(match[2]):02}-{int(match[3]):02}"
    return ""


def _identify(lines: list[RecordLine], *, month_first: bool = False) -> str:
    if identity := _first(_IDENTITY, lines):
        return identity
    day = next((match for line in lines if (match := _DAY.search(line.text))), None)
    date = _iso(day[1], month_first=month_first) if day else ""
    time = (day and day[2]) or _first(_CLOCK, lines)
    time = re.sub(r"^(\d\d)(\d\d)(\d\d)", r"\1:\2:\3", time)
    name = _capitals(_first(_NAME, lines))
    if date == _NEVER_SET or not (name or (date and time)):
        return ""
    return " ".join(filter(None, (name, date, time)))


def _first(pattern: re.Pattern[str], lines: list[RecordLine]) -> str:
    return next((match[1] for line in lines if (match := pattern.search(line.text))), "")


def _capitals(text: str) -> str:
    return " ".join(text.replace(",", " ").split()).upper()


def _iso(date: str, *, month_first: bool) -> str:
    """Write a date as ``1989-10-18``."""
    parts = [date[:4], date[4:6], date[6:]] if date.isdecimal() else re.split(r"[/-]", date)
    if len(parts[0]) == 4:  # noqa: PLR2004 - a year
        year, month, day = map(int, parts)
    else:
        first, second, year = map(int, parts)
        month, day = (first, second) if month_first else (second, first)
        if len(parts[2]) == 2:  # noqa: PLR2004 - a year of two digits
            year += 1900 if year >= _CENTURY_TURNS else 2000
    if month > 12:  # noqa: PLR2004 - they are the other way round
        month, day = day, month
    return f"{year}-{month:02}-{day:02}"


_LINES_OF_REALS = {4: 6, 5: 7, 7: 7}  # after as many lines of integers: GeoNet, USC, CSMIP and those like it
_LONGEST = 15  # lines of both, and one of samples
_PAIRS, _FEWEST_PAIRS = 50, 5  # pairs whose times must increase
_INTEGERS = re.compile(r"[\s\d+-]*\d[\s\d+-]*")


def leave_as_it_is(source: RecordText, begin: int, header: RecordHeader, report: Report) -> RecordHeader:  # noqa: ARG001 - as the others
    """Read nothing: the layout has no such lines."""
    return header


def read_volume(source: RecordText, begin: int, header: RecordHeader, report: Report) -> RecordHeader:  # noqa: ARG001
    """Leave out the numeric header; find times before the samples, and velocity after them."""
    header = _skip(source, header)
    if header.count is None:
        return header
    stops = [line.stop for line in source.lines(header.start, header.stop)]
    tokens = [split_line(line, header) for line in source.lines(header.start, header.stop)]
    values = [parse_number(token) for line in tokens[:_PAIRS] for token in line]
    times = [math.nan if time is None else time for time in values[: 2 * _PAIRS : 2]]
    is_paired = len(times) >= _FEWEST_PAIRS and bool((np.diff(times) > 0).all())
    numbers = np.cumsum([len(line) for line in tokens])
    value_count = header.count.value * (2 if is_paired else 1)
    if numbers.size and numbers[-1] >= 2 * value_count:  # velocity and displacement follow
        header = replace(header, stop=stops[int(np.searchsorted(numbers, value_count))])
    if not is_paired:
        return header
    return replace(header, columns=2, column=1, time_column=0, has_rows=False)


def _skip(source: RecordText, header: RecordHeader) -> RecordHeader:
    """Leave out lines of integers and of reals; a file that ends within them has no samples."""
    lines = list(itertools.islice(source.lines(header.start, header.stop), _LONGEST))
    integers = len(list(itertools.takewhile(lambda line: _INTEGERS.fullmatch(line.text), lines)))
    if integers not in _LINES_OF_REALS:
        return replace(header, start=header.stop) if integers == len(lines) < _LONGEST else header
    size = integers + _LINES_OF_REALS[integers]
    return replace(header, start=lines[size - 1].stop if size < len(lines) else header.stop)


_COSMOS_REALS = re.compile(
    rb"^[ \t]*(\d{1,6})[ \t]+Real-header[^\n]*?\(\s*\d*\s*[A-Z]\s*(\d{1,2})[^\n]*$",
    re.IGNORECASE | re.MULTILINE,
)
_STEP_POSITION = 62  # counted from 1, as in the specification; value 34 is the step before processing
_UNKNOWN = -999.0  # marks an unknown value where the text header names no other mark
_MILLISECOND = ClockUnit(size=1e-3)


def read_cosmos(source: RecordText, begin: int, header: RecordHeader, report: Report) -> RecordHeader:
    """Read the step, value 62 of the real header; it stays open where the header marks it as unknown."""
    missing = header.missing or (_UNKNOWN,)
    matches = list(_COSMOS_REALS.finditer(source.content, begin, header.start))
    if not matches or int(matches[-1][1]) < _STEP_POSITION or int(matches[-1][2]) == 0:
        report.add(
            "The time step, value 62 of the COSMOS real header, is missing",
            line=source.line_number(begin),
            remedy="Export or download the file again",
        )
        return replace(header, missing=missing)
    fields: list[str] = []
    for line in source.lines(matches[-1].end() + 1, header.start):
        fields.extend(_fields(line, int(matches[-1][2])))
        if len(fields) >= _STEP_POSITION:
            text = fields[_STEP_POSITION - 1]
            is_open = parse_number(text) in missing
            step = None if is_open else state_time_step(text, line.number, report, unit=_MILLISECOND)
            return replace(header, missing=missing, time_step=step)
    state_time_step("", source.line_number(header.start), report, unit=_MILLISECOND)
    return replace(header, missing=missing)


_SMC_INTEGERS, _SMC_REALS = 6, 10  # lines
_SMC_COMMENTS, _SMC_COUNT, _SMC_RATE = 16, 17, 2  # positions, counted from 1 as in the specification
_FASTEST = 1e5  # Hz; a file of times and samples marks its rate as unknown by 1.7e38


def read_smc(source: RecordText, begin: int, header: RecordHeader, report: Report) -> RecordHeader:
    """Read count and rate, and leave out the comments before the samples."""
    lines = list(source.lines(header.start, header.stop))
    integers = [field for line in lines[:_SMC_INTEGERS] for field in _fields(line, 10)]
    reals = [field for line in lines[_SMC_INTEGERS:][:_SMC_REALS] for field in _fields(line, 15)]
    values = [
        parse_number(field) for field in (*integers[_SMC_COMMENTS - 1 : _SMC_COUNT], *reals[:_SMC_RATE])
    ]
    if len(values) < 2 + _SMC_RATE or None in values or not 0 <= (values[0] or 0) < len(lines):
        report.add(
            "The SMC header is incomplete: it has six lines of integers and ten of reals",
            line=source.line_number(begin),
            remedy="Download the file again, or save its samples as text below # dt: … and # units: …",
        )
        return header
    comments, count, _, rate = (value or 0.0 for value in values)
    start = lines[min(_SMC_INTEGERS + _SMC_REALS + int(comments), len(lines)) - 1].stop
    header = replace(header, start=start, width=10)
    if not 0 < rate < _FASTEST:
        return replace(header, columns=2, column=1, time_column=0, has_rows=False)
    line = lines[_SMC_INTEGERS].number
    return replace(
        header,
        count=Statement(value=int(count), line=lines[2].number) if count > 1 else None,
        time_step=Statement(value=1.0 / rate, line=line),
    )


Complete = Callable[[RecordText, int, RecordHeader, Report], RecordHeader]


def _fields(line: RecordLine, width: int) -> list[str]:
    text = line.text.rstrip()
    return [text[start : start + width].strip() for start in range(0, len(text), width)]


def _pattern(text: str) -> re.Pattern[bytes]:
    return re.compile(text.encode(), re.IGNORECASE | re.MULTILINE)


@dataclass(frozen=True, kw_only=True)
class Layout:
    """Where the parts of a text file stand, and what they mean by definition."""

    name: str  # Name shown to users
    endings: tuple[str, ...] = ()  # Endings of names by which a file counts as one
    mark: re.Pattern[bytes] | None = None  # Stands in the head of every such file, and of no other
    first: re.Pattern[bytes] | None = None  # First line of each record, where a file may hold several
    last: re.Pattern[bytes] | None = None  # Last line of a header, if lines of numbers may stand before it
    end: re.Pattern[bytes] | None = None  # First line after the samples
    states: str = "hold samples"  # What such a file must do, for messages
    is_announced: bool = False  # Whether the last line of the header alone states count, step and units
    wraps: bool = False  # Whether samples follow one another through the lines, as many as are stated
    holds_components: bool = False  # Whether each column is a component of acceleration
    has_duration: bool = False  # Whether the duration tells the count or the step
    default_units: AccelerationUnit | None = None  # Units where the header states none
    remove_mean: bool = False  # Whether the publisher subtracts the mean of the whole record
    find_event: FindEvent = find_event  # Names the earthquake
    # Reads what stands at fixed places between the header's text and the samples
    complete: Complete = leave_as_it_is

    @property
    def subject(self) -> str:
        """The file, as the beginning of a rule."""
        return "A text record" if self.mark is None else f"A {self.name} file"

    @property
    def holds_one(self) -> bool:
        """Whether a file holds one record, of which the head tells all that the header states."""
        return self.last is not None and not self.is_announced

    def recognises(self, source: RecordText) -> bool:
        """Tell from the head of a file whether it has this layout."""
        return self.mark is not None and self.mark.search(source.content[:HEAD].lstrip()) is not None


_SIZES = _pattern(
    r"^(?![ \t]*[#%!])(?=[^\n]{0,1000}$)[^\n]*(?:\bNPTS\b[^\n]*\bDT\b|\bDT\b[^\n]*\bNPTS\b)[^\n]*$"
)
_ACCELERATION_POINTS = _pattern(
    r"^[ \t]*\S*[ \t]+points[ \t]+of[ \t]+accel\w*[ \t]+data[ \t]+equally[ \t]+spaced[ \t]+at\b[^\n]*$"
)
_ACCELEROGRAM = r"(?![#%!])[^\n]*\b(?:un)?corrected accelerogram\b[^\n]*"
_END = r"/&|[^\n]*\bend[ \t-]+of[ \t-]+data\b"

LAYOUTS = (
    Layout(
        name="PEER AT2",
        endings=(".at2",),
        mark=_SIZES,
        last=_SIZES,
        states="state NPTS and DT",
        wraps=True,
        default_units=AccelerationUnit.GRAVITY,
        find_event=find_titled_event,
    ),
    Layout(
        name="K-NET",
        endings=(".ns", ".ew", ".ud", ".ns1", ".ew1", ".ud1", ".ns2", ".ew2", ".ud2"),
        mark=_pattern(r"\AOrigin Time[ \t](?:[^\n]*\n){1,30}?Scale Factor\b"),
        last=_pattern(r"^Memo\b[^\n]*$"),
        states="hold its labels from Origin Time to Memo",
        wraps=True,
        has_duration=True,
        remove_mean=True,
        find_event=find_event_with_place,
    ),
    Layout(
        name="K-NET CSV",
        mark=_pattern(r"\A#K-NET CSV\b"),
        has_duration=True,
        find_event=find_event_with_place,
    ),
    Layout(
        name="COSMOS",
        endings=(".v2c", ".v1c"),
        mark=_pattern(r"\A[^\n]*\(Format\s+v\s*[\d.]+[^\n]*text\s+lines"),
        last=_pattern(r"^[ \t]*\S+[ \t]+accel\w*[ \t]+(?:data[ \t]+)?(?:pts|points)\b[^\n]*$"),
        end=_pattern(rf"^(?:{_END}|[ \t]*\S+[ \t]+(?:veloc|displ)\w*[ \t]+(?:data[ \t]+)?(?:pts|points)\b)"),
        states="hold acceleration",
        is_announced=True,
        wraps=True,
        complete=read_cosmos,
        find_event=find_american_event,
    ),
    Layout(
        name="CSMIP",
        endings=(".v2", ".raw"),
        mark=_ACCELERATION_POINTS,
        last=_ACCELERATION_POINTS,
        end=_pattern(rf"^(?:{_END}|[^\n]*\bpoints[ \t]+of[ \t]+(?:veloc|displ))"),
        states="announce its points of accel data",
        is_announced=True,
        wraps=True,
        find_event=find_american_event,
    ),
    Layout(
        name="SMC",
        endings=(".smc",),
        mark=_pattern(r"\A[ \t]*\d[ \t]+(?:(?:UN)?CORRECTED|RESPONSE|FOURIER)\b[^\n]*\n\*"),
        last=_pattern(r"\A(?:[^\n]*\n){10}[^\n]*$"),
        states="have eleven lines of text above its numbers",
        wraps=True,
        complete=read_smc,
        default_units=AccelerationUnit.CENTIMETRE,
        find_event=find_event_in_words,
    ),
    Layout(
        name="GeoNet",
        endings=(".v1a", ".v2a"),
        mark=_pattern(rf"\A{_ACCELEROGRAM}\bGNS\b"),
        first=_pattern(rf"^{_ACCELEROGRAM}$"),
        end=_pattern(r"^[^\n]*[a-z]{3}"),
        states="state its number of points",
        wraps=True,
        complete=read_volume,
        default_units=AccelerationUnit.MILLIMETRE,
        find_event=find_event_in_words,
    ),
    Layout(  # of CSMIP, USC, RENADIC and BHRC
        name="Volume 1 or 2",
        endings=(".v1",),
        mark=_pattern(rf"\A(?:\*[ \t]*VOL[12]|{_ACCELEROGRAM})|\bUNCOR ACCEL\b"),
        first=_pattern(rf"^(?:\*[ \t]*VOL[12][^\n]*|{_ACCELEROGRAM})$"),
        end=_pattern(rf"^(?:{_END}|[^\n]*[a-z]{{3}}|\*)"),
        states="state its number of points",
        wraps=True,
        complete=read_volume,
        has_duration=True,
        find_event=find_american_event,
    ),
    Layout(name="ESM", mark=_pattern(r"\AEVENT_NAME[ \t]*:")),
    Layout(name="AFAD", mark=_pattern(r"\A[^\n]*\bstrong[ -]ground[ -]motion records?\b")),
    Layout(name="CWB", mark=_pattern(r"\A#(?:StationCode|Earthquake Information)\b")),
    Layout(
        name="ASA",
        mark=_pattern(r"\barchivo est\w+ndar de aceleraci"),
        holds_components=True,
        default_units=AccelerationUnit.CENTIMETRE,
    ),
)
"""Layouts that are recognised whatever the ending of a file's name."""

PLAIN = Layout(name="text", endings=(".txt", ".csv", ".tsv", ".dat", ".asc", ".acc"))
"""Any header that states what is needed above columns of numbers."""
