"""Prior odds against sets of effects, and how much an effect must explain beside others."""

from collections.abc import Iterable

from reliab.effects.clock_offset import ClockOffset
from reliab.effects.effect import Effect
from reliab.effects.general.general_term import is_general

COST = 4.0
"""Logarithm of the prior odds against one more effect."""

GENERAL_COST = 7.0
"""The same for an effect outside the library."""

COST_BESIDE_ERROR = 1.0
"""Logarithm of the prior odds against one more effect where the best model leaves an error."""

_GENERAL_COST_BESIDE_ERROR = 4.0

LEAST_SHARE = 0.01
"""Share of the gap's energy that an effect must close to be named beside others.

No model of a machine is exact: in long records even model errors of a tenth of the largest effect are
significant. One that takes a tenth off the RMS of all that is left, on left-out tests as in training,
is no trifle, however large the gap was."""

AUDIBLE = 0.02
"""Share of the noise's energy that an effect outside the library must have.

Every recording contains traces far below its noise that no effect of the library explains."""

MATERIAL = 0.19
"""Share of the error's energy on left-out tests, a tenth of its RMS, that an effect must remove where the
remainder is not noise.

An error of the model follows the motion, so that nearly any effect explains some of it. The evidence treats
this error as noise, so that a tiny improvement would appear certain."""

NOTICEABLE = 0.002
"""Share of the error's energy on left-out tests, a thousandth of its RMS in the channel's unit, that every
effect must remove: evidence alone may praise one that changes no prediction."""


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
