"""Priors of uncertain quantities, as functions of a standard normal variable z."""

import math
from dataclasses import dataclass
from enum import StrEnum

import scipy

_STEEPNESS = 4.0  # of the step between nothing and the whole
_FARTHEST = 8.0  # standard deviations, beyond which a half-normal quantile has no more digits


class Source(StrEnum):
    """Where a prior comes from."""

    STATED = "stated"
    LEARNED = "learned"  # from earlier tests of the rig
    DEFAULT = "default"  # ordinary equipment


class Shape(StrEnum):
    """Distribution of a prior."""

    NORMAL = "normal"  # deviation·z
    LOGNORMAL = "lognormal"  # the factor exp(deviation·z), less one
    POSITIVE = "positive"  # half-normal above zero
    EITHER = "either"  # nothing or the whole, one as likely as the other, with little between them


@dataclass(frozen=True, kw_only=True)
class Prior:
    """Prior of how far a quantity lies from the value that is stated for it.

    >>> Prior(deviation=0.1).value(2.0), round(Prior(deviation=1.0, shape=Shape.POSITIVE).value(0.0), 4)
    (0.2, 0.6745)
    """

    deviation: float  # Standard deviation, relative or in the SI unit of the quantity
    source: Source = Source.DEFAULT
    shape: Shape = Shape.NORMAL
    mean: float = 0.0  # What earlier tests lead to expect

    def value(self, z: float) -> float:
        """Return the difference from the stated value at a standard normal variable."""
        match self.shape:
            case Shape.NORMAL:
                return self.mean + self.deviation * z
            case Shape.LOGNORMAL:
                return math.expm1(self.mean + self.deviation * z)
            case Shape.POSITIVE:
                share = 0.5 + 0.5 * float(scipy.special.ndtr(min(z, _FARTHEST)))
                return self.deviation * float(scipy.special.ndtri(share))
            case Shape.EITHER:
                return self.deviation * float(scipy.special.ndtr(_STEEPNESS * z))
