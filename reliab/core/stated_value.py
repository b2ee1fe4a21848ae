"""A quantity as a user states it: a number with its standard deviation."""

import math
import re
from dataclasses import dataclass

from reliab.core.encodings import as_text
from reliab.core.errors import InputError
from reliab.core.physical_range import require_physical
from reliab.core.significant_digits import significant
from reliab.core.vocabulary import PERCENT

_QUANTITY = re.compile(
    r"^\s*(?P<value>[+-]?[\d.]+(?:e[+-]?\d+)?)\s*"
    r"(?:(?:±|\+/?-|,(?=[^,.]*\.))\s*(?P<deviation>[\d.]+(?:e[+-]?\d+)?)\s*(?P<percent>%?))?\s*$",
    re.IGNORECASE,
)
_PERCENTAGE = re.compile(r"^\s*(\d+(?:\.\d*)?|\.\d+)\s*%\s*$")


def percentage_as_number(text: str) -> str:
    """Say how a percentage is written as a number; empty for anything else.

    >>> percentage_as_number("2 %"), percentage_as_number("two")
    ('Write 0.02 for 2 %', '')
    """
    match = _PERCENTAGE.match(text)
    return f"Write {float(match[1]) / PERCENT:g} for {match[1]} %" if match else ""


@dataclass(frozen=True)
class StatedValue:
    """A number with its standard deviation.

    >>> StatedValue.parse("1±0.01"), StatedValue.parse("0.02 +- 10%")
    (StatedValue(value=1.0, deviation=0.01), StatedValue(value=0.02, deviation=0.002))
    """

    value: float  # The number, in the unit of the quantity
    deviation: float = 0.0  # Standard deviation in the same unit; 0 where the number is taken to be exact

    def __post_init__(self) -> None:
        for number in (self.value, self.deviation):
            require_physical("number", number, zero=True, signed=True)

    @classmethod
    def parse(cls, text: str, quantity: str = "quantity") -> "StatedValue":
        """Read "1", "1±0.01", "1+-0.01", "1+/-0.01", "1,0.01" or "1±1%".

        After a comma the deviation must have a decimal point: "1,5" may mean 1.5 as well as 1 ± 5.
        """
        try:
            match = _QUANTITY.match(as_text(text))
            value = float(match["value"]) if match else math.nan
            deviation = float(match["deviation"] or 0.0) if match else math.nan
        except ValueError:
            match, value, deviation = None, math.nan, math.nan
        if match is None or not (math.isfinite(value) and math.isfinite(deviation)):
            raise InputError(
                f"The {quantity} is no number",
                value=repr(text),
                remedy=percentage_as_number(str(text)) or "Write 1.5, 1±0.01, 1+-0.01, 1,0.01 or 1±1%",
            )
        return cls(value, deviation * abs(value) / PERCENT if match["percent"] else deviation)

    def __str__(self) -> str:
        return f"{self.value:g}" + (f" ± {significant(self.deviation)}" if self.deviation else "")
