"""Quantities as users state them: a range for each, standard deviations, one value or several.

The ranges lie far beyond anything that was ever built or measured. Inside them squares, products and ratios
of the numbers of a description are numbers too, so that whatever reads a file or takes an option refuses at
the door what no computation could use.
"""

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, overload

from reliab.core.encodings import as_text
from reliab.core.errors import InputError
from reliab.core.significant_digits import significant
from reliab.core.vocabulary import PERCENT

if TYPE_CHECKING:
    from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler


SMALLEST: Final = 1e-30
"""Smallest size of a number whose square, and products with the numbers of a recording, are numbers."""

LARGEST: Final = 1e30
"""Largest size of such a number."""


@dataclass(frozen=True, kw_only=True)
class PhysicalRange:
    """The range of a quantity."""

    unit: str = ""
    lowest: float = SMALLEST  # Smallest size
    highest: float = LARGEST  # Largest size
    below: float = math.inf  # What the size must not reach
    remedy: str = "Check the number and its unit"

    def includes(self, size: Any) -> Any:  # noqa: ANN401 - a number or an array
        """Tell whether a size, or each of several, lies in the range."""
        return (size >= self.lowest) & (size <= self.highest) & (size < self.below)

    def text(self, value: float) -> str:
        """Write a value with its unit."""
        return f"{value:,.6g} {self.unit}".rstrip()

    @property
    def upper_bound(self) -> str:
        """Largest size in words."""
        if self.below < math.inf:
            return f"below {self.text(self.below)}"
        return f"at most {self.text(self.highest)}"

    @property
    def span(self) -> str:
        """The range in words."""
        if self.below < math.inf:
            return f"at least {self.lowest:,.6g} and {self.upper_bound}"
        return f"between {self.lowest:,.6g} and {self.text(self.highest)}"


RANGES: Final[Mapping[str, PhysicalRange]] = {
    "natural frequency": PhysicalRange(
        unit="Hz", lowest=0.01, highest=1e4, remedy="Give the frequency of the whole structure in hertz"
    ),
    "damping ratio": PhysicalRange(
        lowest=1e-12,
        below=1.0,
        remedy="Give a fraction of critical damping, 0.02 for 2 %",
    ),
    "share of the stiffness in the laboratory": PhysicalRange(
        lowest=1e-6,
        highest=1.0,
        remedy="Give the fraction that is tested physically, 0.6 for 60 %",
    ),
    "mass": PhysicalRange(unit="kg", lowest=1e-9, highest=1e12, remedy="Give it in kilograms"),
    "stiffness": PhysicalRange(unit="N/m", lowest=1e-9, highest=1e18, remedy="Give it in N/m"),
    "damping coefficient": PhysicalRange(unit="N·s/m", lowest=1e-12, highest=1e18, remedy="Give it in N·s/m"),
    "elastic modulus": PhysicalRange(unit="Pa", lowest=1.0, highest=1e15, remedy="Give it in pascals"),
    "second moment of area": PhysicalRange(unit="m⁴", lowest=1e-18, highest=1e6, remedy="Give it in m⁴"),
    "length": PhysicalRange(unit="m", lowest=1e-6, highest=1e6, remedy="Give it in metres"),
    "actuator's gain": PhysicalRange(
        lowest=1e-6,
        highest=1e6,
        remedy="Give measured over command amplitude, 1 for a perfect actuator",
    ),
    "actuator's delay": PhysicalRange(
        unit="s", highest=1e3, remedy="Give the delay in seconds, 0.001 for one millisecond"
    ),
    "time": PhysicalRange(unit="ms", highest=1e4, remedy="Give it in milliseconds"),
    "scale": PhysicalRange(
        lowest=1e-3, highest=1e3, remedy="Give reading over displacement, 1 for an exact sensor"
    ),
    "skew": PhysicalRange(
        highest=100.0, remedy="Give it as a share of a sample, 0.41 for ordinary converters"
    ),
    "hysteresis": PhysicalRange(
        highest=1.0, remedy="Give the width of the loop over the span, 0.001 for 0.1 %"
    ),
    "resolution": PhysicalRange(unit="mm", highest=1e6, remedy="Give the converter's step in millimetres"),
    "relative standard deviation": PhysicalRange(  # so that three of them leave a value above zero
        below=1.0 / 3.0, remedy="Give 0.01 for 1 %, behind a value as in 2±1%"
    ),
    "probability": PhysicalRange(highest=1.0, remedy="Give a share of 1, 0.2 for 20 %"),
    "sampling rate": PhysicalRange(unit="Hz", lowest=1e-3, highest=1e9, remedy="Give samples in a second"),
    "time step": PhysicalRange(
        unit="s",
        lowest=1e-6,
        highest=1e3,
        remedy="Write the unit of the times behind their name, as in time [d], or correct the rate",
    ),
    "error threshold": PhysicalRange(  # 2 is that of a response in opposite phase
        highest=2.0, remedy="Give a fraction, 0.05 for 5 %"
    ),
    "number": PhysicalRange(),
}
"""Ranges by the words in which users are told."""

QUANTITIES_BY_DIMENSION: Final[Mapping[str, str]] = {
    "f": "natural frequency",
    "xi": "damping ratio",
    "alpha": "share of the stiffness in the laboratory",
    "threshold": "error threshold",
}
"""Ranges of what stands along dimensions of datasets and in columns of tables."""


def require_physical(
    quantity: str,
    value: float,
    *,
    zero: bool = False,
    signed: bool = False,
    label: str = "",
    remedy: str = "",
    where: str = "",
) -> None:
    """Refuse a number that no quantity of this kind can have.

    `zero`, `signed`: whether it may be zero, and negative; `label`: its name, where it has one of its own.

    >>> require_physical("mass", 1e-320, label="mass of the specimen", where="frame.toml")
    Traceback (most recent call last):
    ...
    reliab.core.errors.InputError: frame.toml: The mass of the specimen must be between 1e-09 and 1e+12 kg;
    found 9.99989e-321 kg. Give it in kilograms.
    """
    limits = RANGES[quantity]
    if limits.includes(abs(value) if signed else value) or (zero and value == 0.0):
        return
    raise InputError(
        f"The {label or quantity} must be {_demand(limits, value, zero=zero, signed=signed)}",
        value=limits.text(value),
        remedy=remedy or limits.remedy,
        where=where,
    )


def _demand(limits: PhysicalRange, value: float, *, zero: bool, signed: bool) -> str:
    """Say what a number must be, as shortly as the number that was found allows."""
    suffix = " in size" if signed else ""
    if limits.lowest > SMALLEST or 0.0 < abs(value) < SMALLEST:
        return f"{'0, or ' if zero else ''}{limits.span}{suffix}"
    is_open = limits.highest == LARGEST and limits.below == math.inf
    if is_open and not math.isfinite(value):
        return "finite"
    if signed or value > 0.0:
        return f"{limits.upper_bound}{suffix}"
    least = "0 or positive" if zero else "positive"
    return least if is_open else f"{least}, and {limits.upper_bound}"


@dataclass(frozen=True)
class Physical:
    """A number in a described file: `Annotated[float, Physical("mass")]`; arguments as above."""

    quantity: str
    zero: bool = False
    signed: bool = False

    def _check(self, value: float) -> float:
        require_physical(self.quantity, value, zero=self.zero, signed=self.signed)
        return value

    def __get_pydantic_core_schema__(self, source: Any, handler: "GetCoreSchemaHandler") -> Any:  # noqa: ANN401 - of pydantic
        """Check the number after its type."""
        from pydantic import AfterValidator

        return AfterValidator(self._check).__get_pydantic_core_schema__(source, handler)

    def __get_pydantic_json_schema__(self, schema: Any, handler: "GetJsonSchemaHandler") -> dict[str, Any]:  # noqa: ANN401
        """State the range for the reference of the file."""
        limits = RANGES[self.quantity]
        lowest = -limits.highest if self.signed else 0.0 if self.zero else limits.lowest
        upper = (
            {"maximum": limits.highest} if limits.below == math.inf else {"exclusiveMaximum": limits.below}
        )
        return {**handler(schema), "minimum": lowest, **upper}


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


Numbers = float | Sequence[float]
"""One number, or several."""
Names = str | Sequence[str]
"""One name, or several."""


@overload
def as_names(values: Names) -> tuple[str, ...]: ...
@overload
def as_names(values: Numbers) -> tuple[float, ...]: ...


def as_names(values: Any) -> tuple[Any, ...]:
    """Take one value, or several of them.

    `values`: a number or a name, or several; NumPy's arrays as well.

    >>> as_names(0.05), as_names([0.05, 0.10]), as_names("rms")
    ((0.05,), (0.05, 0.1), ('rms',))
    """
    if isinstance(values, str):
        return (values,)
    return tuple(values) if isinstance(values, Iterable) else (values,)
