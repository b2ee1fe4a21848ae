"""Units of time, frequency, length and acceleration, in every spelling that programs use."""

import re
from dataclasses import dataclass
from enum import StrEnum
from typing import Final

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


_SI_FACTORS: Final = {
    AccelerationUnit.GRAVITY: STANDARD_GRAVITY,
    AccelerationUnit.CENTIMETRE: 0.01,
    AccelerationUnit.METRE: 1.0,
    AccelerationUnit.MILLIMETRE: 0.001,
    AccelerationUnit.TENTH_OF_GRAVITY: STANDARD_GRAVITY / 10,
}
_EQUIVALENT: Final = tuple(
    (re.compile(pattern), replacement)
    for pattern, replacement in (
        (r"^[\s,;:]+|[\s,;:]+$|[\s*^.·â()\[\]{}\"]", ""),
        (r"²", "2"),
        (r"^([km]?)sps$|^samples?(?:/|per)s.*", r"\1hz"),
        (r"(milli|micro|nano|kilo)-", r"\1"),
        (r"sec(?:ond)?s?", "s"),
        (r"min(?:ute)?s?$", "min"),
        (r"cent[i]?met(?:er|re)s?", "cm"),
        (r"mil[l]?[i]?met(?:er|re)s?", "mm"),
        (r"met(?:er|re)s?", "m"),
        (r"milli(?=.)", "m"),
        (r"(?:micro(?=.)|[µμ])", "u"),
        (r"nano(?=.)", "n"),
        (r"kilo(?=.)", "k"),
        (r"hertz", "hz"),
        (r"^(k?)s/s$", r"\1hz"),
        (r"(?<=m)(?:/s/s|s-2|ps2|_s2)$", "/s2"),
        (r"^(?:(?:standard)?gravity|g's|gs)$", "g"),
        (r"^gal(?:e?s)?$", "cm/s2"),
    )
)


def canonical_unit(text: str) -> str:
    """Write a unit in small letters as its shortest spelling.

    >>> [canonical_unit(text) for text in ("CM/SEC/SEC", "m s^-2", "milliseconds", "kilohertz", "Gal")]
    ['cm/s2', 'm/s2', 'ms', 'khz', 'cm/s2']
    """
    spelling = text.lower()
    for pattern, replacement in _EQUIVALENT:
        spelling = pattern.sub(replacement, spelling)
    return spelling


def find_unit(text: str) -> AccelerationUnit | None:
    """Recognise a spelling of a unit of acceleration.

    >>> find_unit("CM/SEC/SEC"), find_unit("m/s**2"), find_unit("in/s2")
    (<AccelerationUnit.CENTIMETRE: 'cm/s2'>, <AccelerationUnit.METRE: 'm/s2'>, None)
    """
    spelling = canonical_unit(text)
    return next((unit for unit in AccelerationUnit if unit == spelling), None)


@dataclass(frozen=True, kw_only=True)
class ClockUnit:
    """A unit of time, or of frequency where a rate is meant."""

    size: float  # One such unit [s or Hz]
    is_frequency: bool = False

    def convert_to_seconds(self, value: float) -> float:
        """Turn a step or a rate in this unit into a step [s]."""
        return 1.0 / (value * self.size) if self.is_frequency else value * self.size


CLOCK_UNIT: Final = (
    r"(?:(?:milli|micro|[muµμ])?[ -]?(?:seconds?|secs?|s)|min(?:ute)?s?|(?:kilo|[km])?(?:hertz|hz)"
    r"|sps|samples?\s*(?:/|per)\s*s(?:ec(?:ond)?)?)(?![a-z0-9])"
)
"""Pattern of a unit of time or frequency, with `re.IGNORECASE`."""

_SECONDS: Final = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0}
_HERTZ: Final = {"hz": 1.0, "khz": 1e3, "mhz": 1e6}


def find_clock_unit(text: str) -> ClockUnit | None:
    """Recognise a spelling of a unit of time or frequency.

    >>> find_clock_unit("msec"), find_clock_unit("kHz")
    (ClockUnit(size=0.001, is_frequency=False), ClockUnit(size=1000.0, is_frequency=True))
    """
    spelling = canonical_unit(text)
    size = {**_SECONDS, **_HERTZ}.get(spelling)
    return None if size is None else ClockUnit(size=size, is_frequency=spelling in _HERTZ)
