"""Units of acceleration and of time, in every spelling that records use."""

import re
from dataclasses import dataclass
from enum import StrEnum

from reliab.core.errors import InputError
from reliab.core.vocabulary import STANDARD_GRAVITY


class AccelerationUnit(StrEnum):
    """A unit in which a record may hold its samples."""

    GRAVITY = "g"
    CENTIMETRE = "cm/s2"
    METRE = "m/s2"
    MILLIMETRE = "mm/s2"
    TENTH_OF_GRAVITY = "g/10"

    @property
    def si_factor(self) -> float:
        """One such unit [m/s²]."""
        return _SI_FACTORS[self]


_SI_FACTORS = {
    AccelerationUnit.GRAVITY: STANDARD_GRAVITY,
    AccelerationUnit.CENTIMETRE: 0.01,
    AccelerationUnit.METRE: 1.0,
    AccelerationUnit.MILLIMETRE: 0.001,
    AccelerationUnit.TENTH_OF_GRAVITY: STANDARD_GRAVITY / 10,
}

_ACCELERATION_SPELLINGS = ("{}/s2", "{}/s/s", "{}s-2", "{}ps2", "{}_s2")
_SPELLINGS = {
    **dict.fromkeys(("g", "g's", "gs", "gravity"), AccelerationUnit.GRAVITY),
    **dict.fromkeys(("gal", "gals", "gales"), AccelerationUnit.CENTIMETRE),
    "g/10": AccelerationUnit.TENTH_OF_GRAVITY,
    **{
        pattern.format(length): unit
        for length, unit in (
            ("cm", AccelerationUnit.CENTIMETRE),
            ("m", AccelerationUnit.METRE),
            ("mm", AccelerationUnit.MILLIMETRE),
        )
        for pattern in _ACCELERATION_SPELLINGS
    },
}

_EQUIVALENT = (
    (re.compile(r"[\s*^.·â()\[\]{}\"]"), ""),
    (re.compile(r"²"), "2"),
    (re.compile(r"sec(?:ond)?s?"), "s"),
    (re.compile(r"cent[i]?met(?:er|re)s?"), "cm"),
    (re.compile(r"mil[l]?[i]?met(?:er|re)s?"), "mm"),
    (re.compile(r"met(?:er|re)s?"), "m"),
    (re.compile(r"standardgravity"), "g"),
)


def find_unit(text: str) -> AccelerationUnit | None:
    """Recognise a spelling of a unit of acceleration.

    >>> find_unit("CM/SEC/SEC"), find_unit("m/s**2"), find_unit("in/s2")
    (<AccelerationUnit.CENTIMETRE: 'cm/s2'>, <AccelerationUnit.METRE: 'm/s2'>, None)
    """
    spelling = text.strip().strip(",;:")
    for pattern, replacement in _EQUIVALENT:
        spelling = pattern.sub(replacement, spelling.lower())
    return _SPELLINGS.get(spelling)


def parse_unit(text: str) -> AccelerationUnit:
    """Turn what a user or a catalogue wrote into a unit."""
    unit = find_unit(text)
    if unit is None:
        raise InputError(
            "Unknown unit of acceleration",
            value=repr(text),
            remedy=f"Use {', '.join(AccelerationUnit)}; gal is cm/s2",
        )
    return unit


@dataclass(frozen=True, kw_only=True)
class ClockUnit:
    """A unit of time, or of frequency where a rate is meant."""

    size: float  # One such unit [s or Hz]
    is_frequency: bool = False

    def convert_to_seconds(self, value: float) -> float:
        """Turn a step or a rate in this unit into a step [s]."""
        return 1.0 / (value * self.size) if self.is_frequency else value * self.size


CLOCK_UNIT = (
    r"(?:(?:milli|micro|[muµμ])?[ -]?(?:seconds?|secs?|s)|min(?:ute)?s?|(?:kilo|[km])?(?:hertz|hz)"
    r"|sps|samples?\s*(?:/|per)\s*s(?:ec(?:ond)?)?)(?![a-z0-9])"
)
"""Pattern of a unit of time or frequency, with `re.IGNORECASE`."""

_CLOCK_UNITS = {
    "s": ClockUnit(size=1.0),
    "ms": ClockUnit(size=1e-3),
    "us": ClockUnit(size=1e-6),
    "min": ClockUnit(size=60.0),
    "hz": ClockUnit(size=1.0, is_frequency=True),
    "khz": ClockUnit(size=1e3, is_frequency=True),
    "mhz": ClockUnit(size=1e6, is_frequency=True),
}
_EQUIVALENT_CLOCKS = (
    (re.compile(r"[\s-]"), ""),
    (re.compile(r"sps|samples?(?:/|per)s.*"), "hz"),
    (re.compile(r"sec(?:ond)?s?"), "s"),
    (re.compile(r"min(?:ute)?s?"), "min"),
    (re.compile(r"hertz"), "hz"),
    (re.compile(r"milli"), "m"),
    (re.compile(r"micro|[µμ]"), "u"),
    (re.compile(r"kilo"), "k"),
)


def find_clock_unit(text: str) -> ClockUnit | None:
    """Recognise a spelling of a unit of time or frequency.

    >>> find_clock_unit("msec"), find_clock_unit("kHz")
    (ClockUnit(size=0.001, is_frequency=False), ClockUnit(size=1000.0, is_frequency=True))
    """
    spelling = text.lower()
    for pattern, replacement in _EQUIVALENT_CLOCKS:
        spelling = pattern.sub(replacement, spelling)
    return _CLOCK_UNITS.get(spelling)
