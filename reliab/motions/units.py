"""Units of acceleration, in every spelling that records use."""

import re
from enum import StrEnum

from reliab.errors import InputError
from reliab.vocabulary import STANDARD_GRAVITY


class AccelerationUnit(StrEnum):
    """A unit in which a record may hold its samples."""

    GRAVITY = "g"
    CENTIMETRE = "cm/s2"
    METRE = "m/s2"

    @property
    def in_si(self) -> float:
        """One such unit [m/s²]."""
        return _IN_SI[self]


_IN_SI = {
    AccelerationUnit.GRAVITY: STANDARD_GRAVITY,
    AccelerationUnit.CENTIMETRE: 0.01,
    AccelerationUnit.METRE: 1.0,
}

_SPELLINGS = {
    **dict.fromkeys(("g", "g's", "gs", "gravity"), AccelerationUnit.GRAVITY),
    **dict.fromkeys(
        ("cm/s2", "cm/s/s", "cms-2", "cmps2", "cm_s2", "gal", "gals"), AccelerationUnit.CENTIMETRE
    ),
    **dict.fromkeys(("m/s2", "m/s/s", "ms-2", "mps2", "m_s2"), AccelerationUnit.METRE),
}

_EQUIVALENT = (
    (re.compile(r"[\s*^.·â()\[\]{}\"]"), ""),
    (re.compile(r"²"), "2"),
    (re.compile(r"sec(?:ond)?s?"), "s"),
    (re.compile(r"cent[i]?met(?:er|re)s?"), "cm"),
    (re.compile(r"met(?:er|re)s?"), "m"),
    (re.compile(r"standardgravity"), "g"),
)


def find_unit(text: str) -> AccelerationUnit | None:
    """Recognise a spelling of a unit.

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
            "The units of acceleration must be known",
            value=repr(text),
            remedy="Give g, cm/s2 (the same as gal) or m/s2",
        )
    return unit
