"""Prior odds against sets of effects."""

from collections.abc import Iterable

from reliab.discrepancy.terms.clock_offset import ClockOffset
from reliab.discrepancy.terms.outside_term import is_outside
from reliab.effects.effect import Effect

COST = 4.0
"""Logarithm of the prior odds against one more effect."""

OUTSIDE_COST = 7.0
"""The same for an effect outside the library."""


def cost(kinds: Iterable[type[Effect]]) -> float:
    """Prior odds against a set of effects, as a logarithm; a special form of an effect counts twice.

    Clocks that differ are no rarer than clocks that do not: beside an effect they cost nothing.
    """
    effects = set(kinds)
    dear = effects - {ClockOffset} or effects
    return sum(OUTSIDE_COST if is_outside(kind) else COST * (1 + bool(kind.refines)) for kind in dear)
