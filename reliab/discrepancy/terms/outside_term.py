"""A term outside the library: an effect with an expression."""

from dataclasses import dataclass
from typing import ClassVar

from reliab.effects.effect import Effect, SteppedEffect


@dataclass(frozen=True, kw_only=True)
class OutsideTerm(SteppedEffect):
    """A physical term that stands for an effect which no member of the library explains."""

    expression: ClassVar[str]  # The term in symbols, with the names of its parameters


def is_outside(kind: type[Effect]) -> bool:
    """Whether an effect is no member of the library."""
    return issubclass(kind, OutsideTerm)
