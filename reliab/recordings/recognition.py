"""Which column is which, and in what unit: by their names, or as declared."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from enum import StrEnum
from typing import Final

from reliab.errors import InputError
from reliab.recordings.readers import Columns
from reliab.vocabulary import STANDARD_GRAVITY


class Part(StrEnum):
    """What a column of a test can be."""

    TIME = "time"
    COMMAND = "command"
    MEASURED = "measured"
    GROUND = "ground acceleration"
    FORCE = "force"


DISPLACEMENTS: Final = (Part.TIME, Part.COMMAND, Part.MEASURED)
"""Parts that columns without names hold, in this order."""

EXTRAS: Final = (Part.GROUND, Part.FORCE)
"""Parts that are used where a column states them by name, and never asked for."""


NAMES: Final[Mapping[Part, tuple[str, ...]]] = {
    Part.TIME: ("time", "t", "timestamp", "times", "seconds", "elapsed"),
    Part.COMMAND: (
        *("command", "commanded", "cmd", "xc", "uc", "dc", "target", "desired", "reference", "ref"),
        *("setpoint", "demand", "commandsignal", "input"),
    ),
    Part.MEASURED: (
        *("measured", "measurement", "meas", "xm", "um", "dm", "actual", "achieved", "feedback"),
        *("response", "output", "lvdt", "temposonic", "fbk"),
    ),
    Part.GROUND: (
        *("groundacceleration", "ground", "ag", "accelerationground", "groundmotion", "agm", "xgdd", "xddg"),
        *("tableacceleration", "excitation"),
    ),
    Part.FORCE: (
        *("force", "restoringforce", "measuredforce", "forcemeasured", "specimenforce", "loadcell", "fm"),
        *("actuatorforce", "fe", "reaction"),
    ),
}
"""Names by which columns are recognised, in small letters and without signs between them."""

LENGTHS: Final[Mapping[str, float]] = {
    "m": 1.0,
    "cm": 1e-2,
    "mm": 1e-3,
    "um": 1e-6,
    "µm": 1e-6,
    "in": 0.0254,
    "inch": 0.0254,
    "ft": 0.3048,
}
"""Units of displacement [m]."""

TIMES: Final[Mapping[str, float]] = {
    **dict.fromkeys(("s", "sec", "second", "seconds"), 1.0),
    "ms": 1e-3,
    "us": 1e-6,
}
"""Units of time [s]."""

ACCELERATIONS: Final[Mapping[str, float]] = {
    **dict.fromkeys(("m/s2", "m/s^2", "m/s²", "mps2", "ms2"), 1.0),
    **dict.fromkeys(("cm/s2", "cm/s^2", "cm/s²", "gal"), 1e-2),
    **dict.fromkeys(("mm/s2", "mm/s^2", "mm/s²"), 1e-3),
    "g": STANDARD_GRAVITY,
}
"""Units of acceleration [m/s²]."""

FORCES: Final[Mapping[str, float]] = {"n": 1.0, "kn": 1e3, "mn": 1e6, "lbf": 4.4482216, "kip": 4448.2216}
"""Units of force [N]."""

_UNITS: Final[Mapping[Part, Mapping[str, float]]] = {
    Part.TIME: TIMES,
    Part.COMMAND: LENGTHS,
    Part.MEASURED: LENGTHS,
    Part.GROUND: ACCELERATIONS,
    Part.FORCE: FORCES,
}

_UNIT = re.compile(
    r"[\[(]\s*([^\])]+?)\s*[\])]\s*$|(?<=[a-z0-9])_([a-zµ]+(?:/s(?:\^?2|²)|ps2|s2)?)$", re.IGNORECASE
)
_WORDS = re.compile(r"[^a-z0-9]+")
_SIMILAR = 0.7
OTHER_QUANTITIES: Final = {
    "force",
    "load",
    "acceleration",
    "accel",
    "acc",
    "velocity",
    "vel",
    "rate",
    "strain",
}
"""Words of columns that are no displacement."""


@dataclass(frozen=True, kw_only=True)
class Recognised:
    """A column that was recognised."""

    name: str  # Its name in the file
    unit: str  # Its unit as stated there; empty where none is


def recognise(
    columns: Columns, declared: Mapping[Part, str], *, wanted: Iterable[Part] = DISPLACEMENTS
) -> dict[Part, Recognised]:
    """Find time, command and measured displacement among the columns.

    Parameters
    ----------
    columns : Columns
        The file.
    declared : mapping of Part to str
        Names that the user gave.
    wanted : iterable of Part, optional
        What is looked for; a time may be missing.

    Returns
    -------
    dict of Part to Recognised
        What was found. Columns without names are taken in the order time, command, measured, or
        command, measured where there are two.

    Raises
    ------
    InputError
        If a column is missing or ambiguous; the message suggests what may be meant.
    """
    if not columns.named and not declared:
        return _by_place(columns)
    recognised: dict[Part, Recognised] = {}
    for part in wanted:
        name = _declared(columns, part, declared[part]) if part in declared else _by_name(columns, part)
        if name is not None:
            recognised[part] = Recognised(name=name, unit=_unit(columns, name, part))
    return recognised


def normal(name: str) -> str:
    """Name in small letters, without its unit and the signs between words."""
    plain = _WORDS.sub("", name.lower())
    if any(plain in names for names in NAMES.values()):
        return plain  # x_m is the measured displacement, not x in metres
    return _WORDS.sub("", _without_unit(name).lower())


def _without_unit(name: str) -> str:
    match = _UNIT.search(name.strip())
    known = match is not None and str(match[1] or match[2]).lower() in {
        unit for units in _UNITS.values() for unit in units
    }
    return _UNIT.sub("", name.strip()) if known else name


def _by_place(columns: Columns) -> dict[Part, Recognised]:
    names = list(columns.values)
    parts = DISPLACEMENTS[-len(names) :]
    if not 2 <= len(names) <= len(DISPLACEMENTS):  # noqa: PLR2004 - command and measured at least
        raise InputError(
            "Columns without names must be time, command and measured, or command and measured",
            value=f"{len(names)} columns",
            remedy="Name the columns in the first line, or give `command` and `measured`",
            where=columns.path.name,
        )
    return {part: Recognised(name=name, unit="") for part, name in zip(parts, names, strict=True)}


def _declared(columns: Columns, part: Part, name: str) -> str:
    if name in columns.values:
        return name
    close = get_close_matches(name, list(columns.values), n=1, cutoff=0.5)
    raise InputError(
        f"The column of the {part} must be in the file",
        value=repr(name),
        remedy=f"Did you mean {close[0]!r}" if close else f"The file has {_listed(columns)}",
        where=columns.path.name,
    )


def _by_name(columns: Columns, part: Part) -> str | None:
    exact = [name for name in columns.values if normal(name.rpartition(".")[2]) in NAMES[part]]
    matches = exact or [name for name in columns.values if _names_loosely(name, part)]
    if len(matches) > 1:
        raise InputError(
            f"One column must be the {part}",
            value=" and ".join(repr(name) for name in matches),
            remedy=f"Choose one with --{part}",
            where=columns.path.name,
        )
    if matches or part is Part.TIME:
        return matches[0] if matches else None
    raise InputError(
        f"A test's file must have a column of the {part} displacement",
        value=_listed(columns),
        remedy=_suggestion(columns, part),
        where=columns.path.name,
    )


def recognise_extras(columns: Columns) -> dict[Part, Recognised]:
    """Find ground acceleration and force where exactly one column states each by its name."""
    recognised: dict[Part, Recognised] = {}
    for part in EXTRAS if columns.named else ():
        names = [name for name in columns.values if normal(name.rpartition(".")[2]) in NAMES[part]]
        if len(names) == 1:
            recognised[part] = Recognised(name=names[0], unit=_unit(columns, names[0], part))
    return recognised


def _names_loosely(name: str, part: Part) -> bool:
    """Whether a word of a name means the part, and none means that it is no displacement."""
    words = _words(name)
    return bool(words & set(NAMES[part])) and (part is Part.TIME or not words & OTHER_QUANTITIES)


def _words(name: str) -> set[str]:
    """Words of a name, without its unit, that are long enough to mean something."""
    words = _WORDS.split(_without_unit(name).lower())
    return {word for word in words if len(word) > 1}


def _suggestion(columns: Columns, part: Part) -> str:
    for name in columns.values:
        candidates = {normal(name), *_words(name)}
        if any(get_close_matches(candidate, NAMES[part], n=1, cutoff=_SIMILAR) for candidate in candidates):
            return f"Did you mean {name!r}? Then rename it to {part}, or give --{part} {name!r}"
    return f"Name the column {part}, or say which it is with --{part}"


def _listed(columns: Columns) -> str:
    names = list(columns.values)
    shown = ", ".join(repr(name) for name in names[:8])
    return f"{shown} and {len(names) - 8} more" if len(names) > 8 else shown  # noqa: PLR2004 - shown


def _unit(columns: Columns, name: str, part: Part) -> str:
    known = _UNITS[part]
    stated = columns.units.get(name, "").strip().lower()
    if stated:
        return stated if stated in known else ""
    match = _UNIT.search(name)
    if match is None or _WORDS.sub("", name.lower()) in NAMES[part]:
        return ""
    unit = str(match[1] or match[2]).lower()
    return unit if unit in known else ""
