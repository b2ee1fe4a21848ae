"""Motions that are learned from and those that are judged, divided by the earthquakes they are of.

Motions of one earthquake are similar, so that they are never divided: a motion is judged only by criteria
learned from other earthquakes. `SCHEMES` lists the divisions by the names that studies and commands use.
A catalogue says "KOBE" where a header says "KOBE JAPAN 1995-01-16"; they are recognised by the same record,
date or name.
"""

import datetime as dt
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, product
from typing import Final

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from reliab.core.errors import InputError
from reliab.core.significant_digits import significant
from reliab.criterion.scope import Position, compare_with_scope, magnitudes_of, regions_of, scope_of
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


@dataclass(frozen=True, kw_only=True, eq=False)
class Fold:
    """One division."""

    name: str  # What is judged
    # learned, judged: Which motions, boolean, shape (motions,); no earthquake is both. Where another suite is
    # learned from, the first is about the motions of that suite
    learned: NDArray[np.bool_]
    judged: NDArray[np.bool_]
    # A dimension, "f" or "xi", and its value that is judged but not learned from; by default all structures
    # are learned from and judged
    left_out: tuple[str, float] | None = None

    def judges(self, frequency: float, damping_ratio: float) -> bool:
        """Whether a structure [Hz, -] is judged."""
        if self.left_out is None:
            return True
        dimension, value = self.left_out
        return value == (frequency if dimension == "f" else damping_ratio)


def leave_one_event_out(events: NDArray[np.str_]) -> Iterator[Fold]:
    """Judge each earthquake by all others.

    `events` (motions,).
    """
    for event in _distinct(events, 2):
        is_judged = events == event
        yield Fold(name=str(event), learned=~is_judged, judged=is_judged)


def k_fold(events: NDArray[np.str_], folds: int, *, seed: int = 0) -> Iterator[Fold]:
    """Divide the earthquakes at random into groups and judge each group by the others.

    `events` (motions,).
    """
    random_order = np.random.default_rng(seed).permutation(_distinct(events, folds))
    for number, group in enumerate(np.array_split(random_order, folds), start=1):
        is_judged = np.isin(events, group)
        yield Fold(name=f"group {number}", learned=~is_judged, judged=is_judged)


def random_halves(events: NDArray[np.str_], splits: int, *, seed: int = 0) -> Iterator[Fold]:
    """Learn from a random half of the earthquakes and judge the other, again and again.

    `events` (motions,).
    """
    distinct = _distinct(events, 4)
    rng = np.random.default_rng(seed)
    for number in range(1, splits + 1):
        training_events = rng.permutation(distinct)[: distinct.size // 2]
        is_learned = np.isin(events, training_events)
        yield Fold(name=f"half {number}", learned=is_learned, judged=~is_learned)


def leave_structures_out(folds: Iterable[Fold], dimension: str, values: Sequence[float]) -> Iterator[Fold]:
    """Leave out one frequency, or one damping ratio, in addition to the motions of each fold."""
    for fold in folds:
        for value in values:
            yield replace(fold, name=f"{fold.name}, {dimension} = {value:g}", left_out=(dimension, value))


def transfer(
    sets: NDArray[np.str_], events: NDArray[np.str_], *, learned: Sequence[str], judged: Sequence[str]
) -> Iterator[Fold]:
    """Learn from some sets of motions and judge others, never by motions of the same earthquake.

    `sets`, `events` (motions,).
    """
    unknown = sorted({*learned, *judged} - set(sets.tolist()))
    if unknown:
        raise InputError(
            "The motions have no such set",
            value=unknown[0],
            remedy=f"Choose among {', '.join(choices)}"
            if (choices := sorted(set(sets.tolist()) - {""}))
            else "State sets in the column set of a catalogue",
        )
    is_training, these = np.isin(sets, learned), np.isin(sets, judged)
    shared = np.isin(events, events[is_training])
    if (these & ~shared).any():
        yield Fold(name="other earthquakes", learned=is_training, judged=these & ~shared)
    for event in np.unique(events[these & shared]):
        is_event = events == event
        yield Fold(name=str(event), learned=is_training & ~is_event, judged=these & is_event)


def from_another(training_names: Sequence[str | None], events: NDArray[np.str_]) -> Iterator[Fold]:
    """Learn from another suite and judge all motions of this one, never by motions of the same earthquake.

    `events` (motions of the other suite,).
    """
    names = np.array([name or "" for name in training_names], dtype=np.str_)
    for name in np.unique(names):
        is_learned = events != name if name else np.ones(events.size, dtype=np.bool_)
        yield Fold(name=str(name) or "other earthquakes", learned=is_learned, judged=names == name)


def _distinct(events: NDArray[np.str_], fewest: int) -> NDArray[np.str_]:
    distinct = np.unique(events)
    if distinct.size < fewest:
        raise InputError(
            f"Too few earthquakes: this cross-validation needs {fewest}",
            value=distinct.size,
            remedy="Use more motions, or fewer folds",
        )
    return distinct


GROUPS: Final = 5
"""Groups of earthquakes of the scheme k_fold."""

SPLITS: Final = 20
"""Divisions of the scheme random_halves."""

SCHEMES: Final[Mapping[str, Callable[[NDArray[np.str_]], Iterator[Fold]]]] = {
    "leave_one_event_out": leave_one_event_out,
    "k_fold": lambda events: k_fold(events, GROUPS),
    "random_halves": lambda events: random_halves(events, SPLITS),
}
"""Every scheme by its name; each takes the earthquakes of the motions."""


GROUP_SCHEMES: Final = ("region", "magnitude", "length")
"""Schemes that leave out whole groups of motions."""

_MAGNITUDES: Final = (6.6, 7.0, 7.3)  # between classes
_LENGTHS: Final = (25.0, 40.0, 60.0)  # [s]


def leave_groups_out(groups: NDArray[np.str_], events: NDArray[np.str_]) -> Iterator[Fold]:
    """Judge each group of motions by the others, never by motions of the same earthquake.

    `groups`, `events` (motions,).
    """
    names = _distinct(groups, 2).tolist()
    for name in names:
        other_names = [other_name for other_name in names if other_name != name]
        for fold in transfer(groups, events, learned=other_names, judged=[name]):
            if fold.learned.any():
                yield replace(fold, name=f"{name}, {fold.name}")


def _groups(scheme: str, events: NDArray[np.str_], lengths: NDArray[np.float64] | None) -> NDArray[np.str_]:
    """Region, class of magnitude or class of length of each motion."""
    names = events.tolist()
    if scheme == "length" and lengths is not None:
        return _classes(lengths, _LENGTHS, " s")
    magnitudes, regions = magnitudes_of(names), regions_of(names)
    if scheme == "length" or magnitudes is None or regions is None:
        raise InputError(
            f"The {scheme} of some motions is not known",
            value="motions without lengths" if scheme == "length" else ", ".join(sorted(set(names))[:3]),
            remedy="Choose leave_one_event_out, or judge real_suite, whose earthquakes are known",
        )
    if scheme == "region":
        return np.array(regions, dtype=np.str_)
    return _classes(np.array(magnitudes), _MAGNITUDES, "")


def _classes(values: NDArray[np.float64], edges: Sequence[float], unit: str) -> NDArray[np.str_]:
    """Names of the classes between edges; a value on an edge belongs below it."""
    inner = [f"{low:g} to {high:g}{unit}" for low, high in pairwise(edges)]
    names = [f"up to {edges[0]:g}{unit}", *inner, f"above {edges[-1]:g}{unit}"]
    return np.array(names, dtype=np.str_)[np.digitize(values, edges, right=True)]


def folds_of(scheme: str, events: NDArray[np.str_], lengths: NDArray[np.float64] | None = None) -> list[Fold]:
    """Divide motions.

    `events` (motions,), `lengths` [s] (motions,), which the scheme length needs.

    >>> len(folds_of("leave_one_event_out", np.array(["K", "K", "L", "M"])))
    3
    """
    if scheme in GROUP_SCHEMES:
        return list(leave_groups_out(_groups(scheme, events, lengths), events))
    if scheme not in SCHEMES:
        raise InputError(
            "Unknown scheme",
            value=scheme,
            remedy=f"Choose among {', '.join((*SCHEMES, *GROUP_SCHEMES))}",
        )
    return list(SCHEMES[scheme](events))


@dataclass(frozen=True, kw_only=True)
class Division:
    """A division of motions into those that are learned from and those that are judged."""

    folds: list[Fold]  # The pairs of both
    name: str  # What the division is called
    learn_from: xr.Dataset | None = None  # Ellipses of another suite that is learned from
    recognised_motions: int = 0  # Motions whose earthquake that suite holds too


_UNITS = {"magnitude": "", "length": " s"}


def sentences_of_outside(ellipses: xr.Dataset, division: Division) -> Iterator[str]:
    """Say of each division which of its motions no promise is made for, by their length and magnitude.

    `ellipses`: of the motions that are judged, with their lengths where they are known.
    """
    scopes, quantities = list(_scopes(ellipses, division)), _quantities(ellipses)
    for name, quantity in product(dict.fromkeys(map(_group, division.folds)), quantities):
        judged_values: list[float] = []
        outside_values: list[float] = []
        ends: list[float] = []
        for fold, scope in scopes:
            if _group(fold) == name and quantity in scope and fold.judged.any():
                values = quantities[quantity][fold.judged].tolist()
                judged_values += values
                ends += [scope[quantity][0], scope[quantity][-1]]
                outside_values += [value for value in values if _is_outside(scope, quantity, value)]
        if outside_values:
            unit = _UNITS[quantity]
            yield (
                f"No promise for {len(outside_values)} of the {len(judged_values)} motions of {name}, of "
                f"{quantity} {_range(outside_values)}{unit}: their criterion was learned from motions of "
                f"{_range(ends)}{unit}."
            )


def motions_outside(ellipses: xr.Dataset, division: Division) -> NDArray[np.bool_]:
    """Which motions lie outside of those from which a criterion that judges them is learned, (motions,)."""
    is_outside = np.zeros(ellipses.sizes["motion"], dtype=np.bool_)
    for fold, scope in _scopes(ellipses, division):
        for quantity, values in _quantities(ellipses).items():
            flags = [_is_outside(scope, quantity, float(value)) for value in values]
            is_outside |= fold.judged & np.array(flags, dtype=np.bool_)
    return is_outside


def _scopes(ellipses: xr.Dataset, division: Division) -> Iterator[tuple[Fold, dict[str, list[float]]]]:
    """Give each fold with the scope of the motions from which its criterion is learned."""
    learned_from = ellipses if division.learn_from is None else division.learn_from
    for fold in division.folds:
        yield fold, scope_of(learned_from.isel(motion=fold.learned))


def _group(fold: Fold) -> str:
    """Name of what a division judges, whichever structures or earthquakes it leaves out beside."""
    return fold.name.partition(", ")[0]


def _is_outside(scope: Mapping[str, Sequence[float]], quantity: str, value: float) -> bool:
    return compare_with_scope(scope, {quantity: value}).position is Position.OUTSIDE


def _quantities(ellipses: xr.Dataset) -> dict[str, np.ndarray]:
    """Length [s] and magnitude of each motion, shape (motions,), as far as they are known."""
    quantities = {}
    if "duration" in ellipses.coords:
        quantities["length"] = ellipses["duration"].values.astype(np.float64)
    if (magnitudes := magnitudes_of(ellipses["event"].values.tolist())) is not None:
        quantities["magnitude"] = np.array(magnitudes)
    return quantities


def _range(values: Sequence[float]) -> str:
    ends = [significant(end(values)) for end in (min, max)]
    return ends[0] if ends[0] == ends[1] else " to ".join(ends)
