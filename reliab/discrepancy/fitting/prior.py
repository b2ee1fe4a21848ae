"""Prior odds against sets of effects."""

from collections.abc import Iterable

from reliab.discrepancy.terms import ClockOffset
from reliab.effects.effect import Effect
from reliab.effects.general.general_term import is_general

COST = 4.0
"""Logarithm of the prior odds against one more effect."""

GENERAL_COST = 7.0
"""The same for an effect outside the library."""

COST_BESIDE_ERROR = 1.0
"""Logarithm of the prior odds against one more effect where the best model leaves an error."""

_GENERAL_COST_BESIDE_ERROR = 4.0


def cost_beside_error(kinds: Iterable[type[Effect]]) -> float:
    """Return the same where the best model leaves an error, whose further parts are no rarity."""
    return sum(_GENERAL_COST_BESIDE_ERROR if is_general(kind) else COST_BESIDE_ERROR for kind in set(kinds))


def cost(kinds: Iterable[type[Effect]]) -> float:
    """Prior odds against a set of effects, as a logarithm; a special form of an effect counts twice.

    Clocks that differ are no rarer than clocks that do not: beside an effect they cost nothing.
    """
    effects = set(kinds)
    dear = effects - {ClockOffset} or effects
    return sum(GENERAL_COST if is_general(kind) else COST * (1 + bool(kind.refines)) for kind in dear)
