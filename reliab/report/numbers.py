"""Numbers as they stand in tables: with a fixed number of digits, aligned at the decimal point."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

MISSING = "–"
"""What stands where there is no number."""

_LEAST_EXPONENT, _GREATEST_EXPONENT = -4, 7  # without a power of ten


@dataclass(frozen=True, kw_only=True)
class WrittenNumber:
    """A number as it is written."""

    digits: str  # Its digits, with sign and decimal point
    exponent: int | None = None  # Power of ten that follows

    @property
    def decimals(self) -> int:
        """Number of digits after the decimal point."""
        return len(self.digits.partition(".")[2])


class Number(ABC):
    """How the numbers of a column are written."""

    def __call__(self, value: float) -> WrittenNumber:
        """Write a number; NaN as a dash, infinity by its sign."""
        if np.isnan(value):
            return WrittenNumber(digits=MISSING)
        if np.isinf(value):
            return WrittenNumber(digits="∞" if value > 0.0 else "−∞")
        return self._write(value)

    @abstractmethod
    def _write(self, value: float) -> WrittenNumber:
        """Write a finite number."""


@dataclass(frozen=True, kw_only=True)
class Fixed(Number):
    """A fixed number of decimals.

    >>> Fixed(decimals=1, factor=100.0)(0.0534).digits, Fixed(decimals=2)(-0.001).digits
    ('5.3', '0.00')
    """

    decimals: int = 2  # Digits after the decimal point
    factor: float = 1.0  # What the value is multiplied with first, 100 for per cent
    signed: bool = False  # Whether a plus sign is written

    def _write(self, value: float) -> WrittenNumber:
        text = f"{self.factor * value:{'+' if self.signed else ''}.{self.decimals}f}"
        return WrittenNumber(digits=text.lstrip("+-") if float(text) == 0.0 else text.replace("-", "−"))


@dataclass(frozen=True, kw_only=True)
class Significant(Number):
    """A fixed number of significant digits; very small and large numbers with a power of ten.

    >>> [Significant(digits=3)(value).digits for value in (23.268, 0.3333, 1234.0)]
    ['23.3', '0.333', '1234']
    >>> Significant(digits=2)(1.77e-5)
    WrittenNumber(digits='1.8', exponent=-5)
    """

    digits: int = 3  # Significant digits
    factor: float = 1.0  # What the value is multiplied with first

    def _write(self, value: float) -> WrittenNumber:
        size = self.factor * value
        exponent = int(f"{size:.{self.digits - 1}e}".partition("e")[2])
        if not _LEAST_EXPONENT <= exponent <= _GREATEST_EXPONENT:
            return Scientific(decimals=self.digits - 1)(size)
        return Fixed(decimals=max(self.digits - 1 - exponent, 0))(size)


@dataclass(frozen=True, kw_only=True)
class Scientific(Number):
    """A mantissa with a fixed number of decimals and a power of ten.

    >>> Scientific(decimals=1)(5.29e-5)
    WrittenNumber(digits='5.3', exponent=-5)
    """

    decimals: int = 2  # Decimals of the mantissa

    def _write(self, value: float) -> WrittenNumber:
        mantissa, _, exponent = f"{value:.{self.decimals}e}".partition("e")
        return WrittenNumber(digits=mantissa.replace("-", "−"), exponent=int(exponent))


@dataclass(frozen=True, kw_only=True)
class Shortest(Number):
    """As few digits as the number has, for values that were chosen.

    >>> Shortest(factor=100.0)(0.05).digits, Shortest()(0.125).digits
    ('5', '0.125')
    """

    factor: float = 1.0  # What the value is multiplied with first

    def _write(self, value: float) -> WrittenNumber:
        text = f"{self.factor * value:.6f}".rstrip("0").rstrip(".")
        return WrittenNumber(digits=text.replace("-", "−"))


def cells(values: Sequence[Any], number: Number | None) -> list[str | tuple[WrittenNumber, str]]:
    """Write the values of a column: texts, or numbers with the digits that each lacks to be aligned.

    >>> cells([True, None], None), [lacks for _, lacks in cells([1.0, 0.25], Shortest())]
    (['yes', '–'], ['.00', ''])
    """
    if number is None:
        return [_write_word(value) for value in values]
    numbers = [number(float("nan") if value is None else float(value)) for value in values]
    largest_count = max((item.decimals for item in numbers), default=0)
    return [
        (item, ("." if largest_count and not item.decimals else "") + "0" * (largest_count - item.decimals))
        for item in numbers
    ]


def _write_word(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    unequal = value != value  # noqa: PLR0124 - NaN; of pandas' NA it is NA again
    missing = value is None or not isinstance(unequal, bool | np.bool_) or bool(unequal)
    return MISSING if missing else str(value)


def write_in_line(number: WrittenNumber) -> str:
    """Write a number within a text, its power of ten by raised digits.

    >>> write_in_line(Significant()(5.29e-5)), write_in_line(Significant()(1.048))
    ('5.29·10⁻⁵', '1.05')
    """
    if number.exponent is None:
        return number.digits
    return f"{number.digits}·10{str(number.exponent).translate(_SUPERSCRIPTS)}"


_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
