"""An effect of a general kind: a term with an expression, in place of a cause that has a name."""

from dataclasses import dataclass
from typing import ClassVar

from reliab.effects.effect import Effect, SteppedEffect


@dataclass(frozen=True, kw_only=True)
class GeneralTerm(SteppedEffect):
    """A physical term that stands for an effect which no member of the library explains."""

    expression: ClassVar[str]  # The term in symbols, with the names of its parameters


def is_general(kind: type[Effect]) -> bool:
    """Whether an effect is a term of a general kind, and no member of the library."""
    return issubclass(kind, GeneralTerm)
