"""A term outside the library: an effect with an expression."""

from dataclasses import dataclass
from typing import ClassVar

from reliab.effects import Effect, SteppedEffect


@dataclass(frozen=True, kw_only=True)
class OutsideTerm(SteppedEffect):
    """A physical term that stands for an effect which no member of the library explains.

    Attributes
    ----------
    expression : str
        The term in symbols, with the names of its parameters.
    """

    expression: ClassVar[str]


def is_outside(kind: type[Effect]) -> bool:
    """Whether an effect is no member of the library.

    Parameters
    ----------
    kind : type of Effect
        The class of the effect.

    Returns
    -------
    bool
        True for terms derived from :class:`OutsideTerm`.
    """
    return issubclass(kind, OutsideTerm)
