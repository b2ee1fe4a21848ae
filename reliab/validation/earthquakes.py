"""Identification of the earthquake of a ground motion among those of a suite, despite different names.

Motions of one earthquake are similar, so that a motion must not be judged by a criterion that was learned
from its own earthquake. A catalogue says "KOBE" where a header says "KOBE JAPAN 1995-01-16"; they are
recognised by the same record, date or name.
"""

import datetime as dt
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Final

import numpy as np
import xarray as xr

from reliab.motions.motion import are_copies

_SUITE_EVENTS: Final[Mapping[str, tuple[str, str]]] = {
    "CAPEMEND": ("Cape Mendocino", "1992-04-25"),
    "CHICHI": ("Chi-Chi", "1999-09-20"),
    "DENALI": ("Denali", "2002-11-03"),
    "DUZCE": ("Duzce", "1999-11-12"),
    "ERZIKAN": ("Erzican", "1992-03-13"),
    "FRIULI": ("Friuli", "1976-05-06"),
    "GAZLI": ("Gazli", "1976-05-17"),
    "HECTOR": ("Hector Mine", "1999-10-16"),
    "IMPVALL": ("Imperial Valley", "1979-10-15"),
    "ITALY": ("Irpinia", "1980-11-23"),
    "KOBE": ("Kobe", "1995-01-16"),
    "KOCAELI": ("Kocaeli", "1999-08-17"),
    "LANDERS": ("Landers", "1992-06-28"),
    "LOMAP": ("Loma Prieta", "1989-10-18"),
    "MANJIL": ("Manjil", "1990-06-20"),
    "NAHANNI": ("Nahanni", "1985-12-23"),
    "NORTHR": ("Northridge", "1994-01-17"),
    "SFERN": ("San Fernando", "1971-02-09"),
    "SUPERST": ("Superstition Hills", "1987-11-24"),
}
"""Names and dates (UTC) of the earthquakes of the shipped suite, after the headers of its records."""

_DATE = re.compile(r"(\d{4})[-/.](\d{1,2})[-/.](\d{1,2})")
_YEAR = re.compile(r"(?<!\d)(1[89]\d\d|20\d\d)(?!\d)")
_ONE_DAY, _ONE_YEAR = dt.timedelta(days=1), dt.timedelta(days=366)
_SHORTEST_NAME = 4


def earthquakes_among(
    events: Iterable[str], checksums: Iterable[str], suite: xr.Dataset, outlines: Sequence[str] = ()
) -> list[str | None]:
    """Find the earthquakes of ground motions among those of a suite.

    Two motions are of one earthquake if their records are the same or copies of each other, if their dates
    differ by a day at most (local time against UTC), or if their names agree, one beginning with the other,
    and their dates, where both are known, do not lie more than a year apart.

    `events`: earthquake of each motion, as its catalogue or header names it; `checksums`: checksum of each
    record; empty where it is not known; `suite`: a dataset with the coordinate `event`, and `checksum` and
    `outline` where they are known, along `motion`; `outlines`: outline of each record, by which scaled and
    trimmed copies are known. Returns name of the earthquake in the suite of each motion; None where the suite
    does not have it.

    >>> suite = xr.Dataset(coords={"event": ("motion", ["KOBE", "IMPVALL"])})
    >>> earthquakes_among(
    ...     ["KOBE JAPAN 1995-01-16", "Hyogo-ken Nanbu 1995/01/17", "IMPERIAL VALLEY-02 1940-05-19"],
    ...     ["", "", ""],
    ...     suite,
    ... )
    ['KOBE', 'KOBE', None]
    """
    names = suite["event"].values.tolist()
    records = dict(zip(suite["checksum"].values.tolist(), names, strict=True)) if "checksum" in suite else {}
    event_names, copies = dict.fromkeys(names), dict[int, str]()
    if len(outlines) and "outline" in suite.coords:
        pairs = np.argwhere(are_copies(outlines, suite["outline"].values.tolist())).tolist()
        copies = {place: names[index] for place, index in pairs}
    return [
        records.get(checksum)
        or copies.get(place)
        or next((name for name in event_names if _is_same_event(event, name)), None)
        for place, (event, checksum) in enumerate(zip(events, checksums, strict=True))
    ]


def _is_same_event(event: str, name: str) -> bool:
    """Whether an earthquake is the one of a suite."""
    if event == name:
        return True
    title, date = _SUITE_EVENTS.get(name, (name, name))
    day, other_day = _date(event), _date(date)
    difference = abs(day - other_day) if day and other_day else None
    if difference is not None and difference <= _ONE_DAY and _DATE.search(event):
        return True
    has_same_name = any(_begins(_letters(event), _letters(alias)) for alias in (name, title))
    return has_same_name and (difference is None or difference <= _ONE_YEAR)


def _begins(*names: str) -> bool:
    """Whether the longer of two names begins with the shorter."""
    short, long = sorted(names, key=len)
    return len(short) >= _SHORTEST_NAME and long.startswith(short)


def _letters(text: str) -> str:
    return "".join(letter for letter in text.upper() if letter.isalpha())


def _date(text: str) -> dt.date | None:
    """Date in a name; the middle of the year where only that is given, None where neither is."""
    if match := _DATE.search(text):
        try:
            return dt.date(*(int(part) for part in match.groups()))
        except ValueError:
            return None
    if match := _YEAR.search(text):
        return dt.date(int(match[1]), 7, 1)
    return None
