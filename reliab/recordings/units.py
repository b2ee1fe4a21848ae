"""Units of channels as programs write them, with their factors to SI units."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from reliab.core.vocabulary import STANDARD_GRAVITY
from reliab.recordings.words import Measurand

_POUND: Final = 4.4482216152605  # N

UNITS: Final[Mapping[Measurand, Mapping[str, float]]] = {
    Measurand.TIME: {
        **dict.fromkeys(
            ("s", "sec", "secs", "second", "seconds", "sek", "sekunden", "sn", "saniye", "秒", "초"), 1.0
        ),
        **dict.fromkeys(
            ("ms", "msec", "msecs", "millisec", "millisecs", "millisecond", "milliseconds"), 1e-3
        ),
        **dict.fromkeys(("us", "µs", "usec", "usecs", "µsec", "microsecond", "microseconds"), 1e-6),
        **dict.fromkeys(("ns", "nsec", "nanosecond", "nanoseconds"), 1e-9),
        **dict.fromkeys(("min", "minute", "minutes"), 60.0),
        **dict.fromkeys(("h", "hr", "hour", "hours", "std", "stunden"), 3600.0),
        **dict.fromkeys(("d", "day", "days", "tage"), 86400.0),
        **dict.fromkeys(("week", "weeks"), 604800.0),
    },
    Measurand.DISPLACEMENT: {
        **dict.fromkeys(("m", "meter", "metre", "meters", "metres"), 1.0),
        **dict.fromkeys(("cm", "centimeter", "centimetre", "centimeters"), 1e-2),
        **dict.fromkeys(("mm", "millimeter", "millimetre", "millimeters", "millimetres"), 1e-3),
        **dict.fromkeys(("um", "µm", "micron", "microns", "micrometer"), 1e-6),
        **dict.fromkeys(("in", "inch", "inches", "in.", '"'), 0.0254),
        **dict.fromkeys(("ft", "feet", "foot"), 0.3048),
        "mil": 2.54e-5,
    },
    Measurand.ACCELERATION: {
        **dict.fromkeys(
            (
                "m/s2",
                "m/s^2",
                "m/s²",
                "m/s/s",
                "m.s-2",
                "m s-2",
                "m*s^-2",
                "mps2",
                "ms2",
                "m/sec2",
                "m/sec^2",
            ),
            1.0,
        ),
        **dict.fromkeys(("cm/s2", "cm/s^2", "cm/s²", "cm/s/s", "cm/sec2", "cm/sec^2", "gal"), 1e-2),
        **dict.fromkeys(("mm/s2", "mm/s^2", "mm/s²", "mm/sec2", "mm/sec^2"), 1e-3),
        **dict.fromkeys(("in/s2", "in/s^2", "in/sec2", "in/sec^2"), 0.0254),
        **dict.fromkeys(("ft/s2", "ft/s^2", "ft/sec2", "ft/sec^2"), 0.3048),
        **dict.fromkeys(("g", "grav"), STANDARD_GRAVITY),
        "mg": 1e-3 * STANDARD_GRAVITY,
    },
    Measurand.FORCE: {
        **dict.fromkeys(("n", "newton", "newtons"), 1.0),
        **dict.fromkeys(("kn", "kilonewton", "kilonewtons"), 1e3),
        "MN": 1e6,
        **dict.fromkeys(("lbf", "lb", "lbs", "pound", "pounds"), _POUND),
        **dict.fromkeys(("kip", "kips", "klbf"), 1e3 * _POUND),
        **dict.fromkeys(("kgf",), STANDARD_GRAVITY),
        **dict.fromkeys(("tf", "tonf"), 1e3 * STANDARD_GRAVITY),
    },
    Measurand.VELOCITY: dict.fromkeys(
        ("m/s", "mm/s", "cm/s", "in/s", "m/sec", "mm/sec", "in/sec", "mps"), 1.0
    ),
    Measurand.VOLTAGE: dict.fromkeys(("v", "volt", "volts", "mv", "vdc"), 1.0),
    Measurand.CURRENT: dict.fromkeys(("a", "ma", "amp", "amps"), 1.0),
    Measurand.PRESSURE: dict.fromkeys(("pa", "kpa", "mpa", "bar", "psi", "ksi"), 1.0),
    Measurand.STRAIN: dict.fromkeys(
        ("ue", "µe", "ustrain", "µstrain", "microstrain", "mm/mm", "in/in", "m/m"), 1.0
    ),
    Measurand.ROTATION: {
        **dict.fromkeys(("deg", "°"), math.pi / 180.0),
        "mrad": 1e-3,
        **dict.fromkeys(("rad", "nm", "n.m", "n-m", "knm", "kn.m", "kn-m", "n*m"), 1.0),
    },
    Measurand.TEMPERATURE: dict.fromkeys(("c", "°c", "degc", "f", "°f", "degf", "k"), 1.0),
    Measurand.STATE: dict.fromkeys(("hz", "1/s", "%", "w", "kw", "j", "kj"), 1.0),
    Measurand.COUNT: dict.fromkeys(("-", "counts", "cnt", "segments", "cycles"), 1.0),
}
"""Factors to SI units; of quantities that no test is judged by they are not used and 1."""

LENGTHS: Final = UNITS[Measurand.DISPLACEMENT]
"""Units of displacement [m]."""

ANGLES: Final = ("rad", "mrad", "deg", "°")
"""Units of rotations that an actuator of several may command."""

TIMES: Final = UNITS[Measurand.TIME]
"""Units of time [s]."""

_SIGNS: Final = str.maketrans({"μ": "µ", "·": ".", "⋅": ".", "−": "-", "[": "", "]": "", "(": "", ")": ""})
_UNIT_BY_NAME: Final = {name: (quantity, name) for quantity, names in UNITS.items() for name in names}
_NOT_ENDINGS: Final = frozenset({"a", "c", "d", "f", "h", "k", "std", "-", "%", "min", "in.", '"'})
_SPACED_UNITS: Final = frozenset(
    {"mm", "cm", "kn", "ms", "sec", "kip", "kips", "lbf", "µm", "gal", "m/s2", "m/s^2", "mm/s"}
)
_BRACKETS: Final = re.compile(r"(?:[\[({]|<)\s*([^\])}>]{1,20}?)\s*(?:[\])}]|>)\s*$")
_ENDING: Final = re.compile(r"(?<=[^\W_])_([a-zµμ°]+(?:/s(?:\^?2|²)?|ps2|s2)?)$", re.IGNORECASE)
_MULTIPLE: Final = re.compile(r"(\d{0,9}\.?\d+(?:e-?\d{1,2})?)\s*[*x]?\s*([^\d/].*)", re.IGNORECASE)
_LAST_WORD: Final = re.compile(r"(?<!\d)[\s,;-]+(?:in\s+|/\s*)?([^\s\[({]+)$")


def units_text(units: Mapping[str, float]) -> str:
    """List units for a message, each by its first spelling.

    >>> units_text(LENGTHS)
    'm, cm, mm, um, in, ft, mil'
    """
    first: dict[float, str] = {}
    for name, factor in units.items():
        first.setdefault(factor, name)
    return ", ".join(first.values())


@dataclass(frozen=True, kw_only=True)
class Unit:
    """A unit of a channel."""

    text: str  # As it is written
    quantity: Measurand
    factor: float  # to the SI unit


def unit_of(text: str) -> Unit | None:
    """Read a unit as programs write it; None where it is none that is known.

    >>> unit_of("[kN]").factor, unit_of("MN").factor, unit_of("0.1 ms").factor, unit_of("furlong")
    (1000.0, 1000000.0, 0.0001, None)
    """
    plain = text.partition(" since ")[0].strip().translate(_SIGNS).strip()  # "seconds since 2026-01-01"
    multiple = _MULTIPLE.fullmatch(plain)
    single = plain if multiple is None else multiple[2]
    unit = _UNIT_BY_NAME.get(single) or _UNIT_BY_NAME.get(single.lower())
    if unit is None or single in {"mN", "mn"}:
        return None
    quantity, name = unit
    times = 1.0 if multiple is None else float(multiple[1])
    return Unit(text=plain, quantity=quantity, factor=times * UNITS[quantity][name])


def split_unit(name: str) -> tuple[str, Unit | None]:
    """Take the unit from the end of a name: "Disp (mm)", "disp_mm", "Axial Disp mm".

    >>> split_unit("Axial Displacement [mm]")[0], split_unit("command_m")[1].text
    ('Axial Displacement', 'm')
    """
    trimmed = name.strip()
    for pattern, allowed_units in (
        (_BRACKETS, bool),
        (_ENDING, lambda text: text.lower() not in _NOT_ENDINGS),
        (_LAST_WORD, lambda text: text.lower() in _SPACED_UNITS),
    ):
        match = pattern.search(trimmed)
        if match is not None and allowed_units(match[1]) and (unit := unit_of(match[1])) is not None:
            return trimmed[: match.start()].strip(), unit
    return trimmed, None
