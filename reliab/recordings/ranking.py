"""How likely a column is a part of the test, by what its name and unit say; and which of two follows.

Ranks are small for the likeliest; None where a column cannot be the part.
"""

from typing import Final

from reliab.recordings.behaviour import Likeness
from reliab.recordings.naming import Named
from reliab.recordings.words import Quantity, Role

WITHOUT_ROLE: Final = 8
"""Rank from which a displacement is one that no word calls measured."""

_WEAK, _ALTERED, _OF_TABLE = 2, 4, 2
_LEAST_NOISE_RATIO = 3.0


def votes(likeness: Likeness) -> int:
    """Which of two histories is measured: 1 the second, -1 the first, 0 undecided.

    The one that follows, if it also carries more noise, or stands second and carries no less.
    """
    follows = 1 if likeness.lag > 0.0 else -1
    noisier = 0
    if not 1.0 / _LEAST_NOISE_RATIO < likeness.noise_ratio < _LEAST_NOISE_RATIO:
        noisier = 1 if likeness.noise_ratio > 1.0 else -1
    return follows if noisier == follows or (noisier == 0 and follows > 0) else 0


def _may_be(what: Named, quantity: Quantity) -> bool:
    return what.quantity in {None, quantity}


def _rank(what: Named) -> int:
    return (what.quantity is None) + _WEAK * what.weak + _ALTERED * what.altered


def rank_as_command(what: Named) -> int | None:
    """Rank a column as the commanded displacement."""
    if what.role is not Role.COMMAND or not _may_be(what, Quantity.DISPLACEMENT):
        return None
    return _rank(what)


def rank_as_measured(what: Named) -> int | None:
    """Rank a column as the measured displacement."""
    if not _may_be(what, Quantity.DISPLACEMENT):
        return None
    if what.role is Role.MEASURED:
        return _rank(what)
    if what.quantity is None or what.role is Role.COMMAND:
        return None
    return _rank(what) + WITHOUT_ROLE + _OF_TABLE * (what.role is Role.GROUND)


def rank_as_ground(what: Named) -> int | None:
    """Rank a column as the ground acceleration."""
    if what.role is not Role.GROUND or not _may_be(what, Quantity.ACCELERATION) or what.altered:
        return None
    return 0 if what.quantity is Quantity.ACCELERATION else 1


def rank_as_force(what: Named) -> int | None:
    """Rank a column as the force."""
    if what.quantity is not Quantity.FORCE or what.role is Role.COMMAND or what.altered:
        return None
    return 0 if what.role is Role.MEASURED else 1
