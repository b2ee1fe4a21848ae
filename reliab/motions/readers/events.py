"""Which earthquake a header names, so that its components are known to belong together.

An earthquake is known by an identifier, or by its name, date and time as far as the header states them, but
never by a date alone. Components are recognised by equal labels, which are written in one way: capitals,
dates as ``1989-10-18``.
"""

import re
from collections.abc import Callable

from reliab.motions.readers.source import Line

_FLAGS = re.IGNORECASE
_EVENT = re.compile(r"^\W*event\s*[=:]\s*(.+?)\s*$", _FLAGS)
_EARTHQUAKE = r"^\W*(?:event|earthquake)"
_IDENTITY = re.compile(rf"{_EARTHQUAKE}[ _]id\s*[=:]\s*(\S+)", _FLAGS)
_NAME = re.compile(rf"{_EARTHQUAKE}(?:[ _]name)?\s*[=:]\s*(\S.*?)\s*$", _FLAGS)
_DATE = r"(\d{8}|\d{4}[/-]\d{1,2}[/-]\d{1,2}|\d{1,2}[/-]\d{1,2}[/-](?:\d{4}|\d{2}))(?!\d)"
_TIME = r"(\d{1,2}:\d{2}(?::[\d.]*\d)?|\d{6}(?:\.\d+)?)(?!\d)"
_DAY = re.compile(
    rf"(?:{_EARTHQUAKE}[ _]date\w*|^\W*fecha\s+del\s+sismo[^:]*|\borigin(?:[ _]?time)?(?:\s*\([^)]*\))*)"
    rf"\s*[=:\s]\s*{_DATE}(?:[ ,T-]+{_TIME})?",
    _FLAGS,
)
_CLOCK = re.compile(rf"(?:{_EARTHQUAKE}[ _]time\w*|^\W*hora\s+epicentro[^:]*)\s*[=:]\s*{_TIME}", _FLAGS)
_LATITUDE = re.compile(r"^\W*(?:event\s+)?lat(?:\.|itude)\W\s*([\d.+-]+)", _FLAGS)
_LONGITUDE = re.compile(r"^\W*(?:event\s+)?long?(?:\.|itude)\W\s*([\d.+-]+)", _FLAGS)
_TITLE = 1  # the second line that is not blank
_TITLE_DATE = re.compile(r"\b(\d{1,2}/\d{1,2}/(?:\d{4}|\d{2}))\b")
_SPELLED = re.compile(r"^\s*(\d{4})\s+([A-Z][a-z]{2})[a-z]*\s+(\d{1,2})\s+(\d{1,2}:\d{2}:\d{2})\s+U")
_MONTHS = ("Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec")
_DAY_AND_PLACE = re.compile(r"^\s*(\d{4})\s+(\d{1,2})\s+(\d{1,2})\s+\d{4}\s+([A-Za-z].*?)\s*$")
_CENTURY_TURNS = 30  # records of 2000 print years with two digits; 1933 is the first record
_NEVER_SET = "1980-01-01"  # the day at which the clocks of recorders begin

FindEvent = Callable[[list[Line]], str]


def find_event(lines: list[Line]) -> str:
    """Name the earthquake by what labels say of it; empty where that does not identify it."""
    return _first(_EVENT, lines) or _identify(lines)


def find_american_event(lines: list[Line]) -> str:
    """Name the earthquake where dates begin with the month."""
    return _identify(lines, month_first=True)


def find_event_with_place(lines: list[Line]) -> str:
    """Name it by origin time and epicentre, as in ``2018-01-24 19:51:00 41.0N 142.5E``."""
    origin, latitude, longitude = _identify(lines), _first(_LATITUDE, lines), _first(_LONGITUDE, lines)
    return f"{origin} {latitude}N {longitude}E" if origin and latitude and longitude else ""


def find_titled_event(lines: list[Line]) -> str:
    """Name it by name and date in the title, as in ``LOMA PRIETA 1989-10-18``; empty without both."""
    texts = [line.text for line in lines if line.text.strip()]
    title = texts[_TITLE] if len(texts) > _TITLE else ""
    match = _TITLE_DATE.search(title)
    name = _capitals(title[: match.start()]) if match else ""
    return f"{name} {_iso(match[1], month_first=True)}" if match and name else ""


def find_event_in_words(lines: list[Line]) -> str:
    """Name it by a line such as ``2016 November 13  11:02:56 UT`` or ``1989 10 18 0004 Loma Prieta``."""
    for line in lines:
        if (match := _SPELLED.match(line.text)) and match[2] in _MONTHS:
            return f"{match[1]}-{_MONTHS.index(match[2]) + 1:02}-{int(match[3]):02} {match[4]}"
        if match := _DAY_AND_PLACE.match(line.text):
            return f"{_capitals(match[4])} {match[1]}-{int(match[2]):02}-{int(match[3]):02}"
    return ""


def _identify(lines: list[Line], *, month_first: bool = False) -> str:
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


def _first(pattern: re.Pattern[str], lines: list[Line]) -> str:
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
