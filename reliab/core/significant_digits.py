"""Numbers in sentences: rounded to significant digits, without a power of ten where people write none.

A value with an interval has the digits that the interval allows, in sentences, tables and drawings alike.
"""

import math
import re

from reliab.core.vocabulary import PERCENT

_ORDINARY = (1e-4, 1e7)
_PREFIXES = {-6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}
_READABLE = (0.01, 1e4)  # sizes of numbers that are shown without a power of ten
_NEGATIVE_ZERO = re.compile(r"-(0(?:\.0+)?)(?![\d.])")
_TWO_DIGITS_BELOW = 5.0
"""An uncertainty that begins with 1 to 4 is written with two digits, another with one: rounding then moves a
number by at most a tenth of its uncertainty."""
_UNKNOWN_DECIMALS = 2
_MOST_OF_PERCENT = 2
"""Decimals in per cent: whatever its draws say, no error is known to a hundred-thousandth of the response."""


def significant(value: float, digits: int = 3) -> str:
    """Write a number with so many significant digits; larger ones to the unit.

    >>> [significant(value) for value in (0.05, 23.268, 999.7, 1234.5)], significant(99.97, 2)
    (['0.05', '23.3', '1000', '1234'], '100')
    """
    text = f"{value:.{digits}g}"
    ordinary = _ORDINARY[0] <= abs(value) < _ORDINARY[1]
    return f"{value:.0f}" if "e" in text and ordinary else text


def percent(share: float, digits: int = 3, *, decimals: int | None = None) -> str:
    """Write a share in per cent, to significant digits or to so many decimals.

    >>> percent(0.05), percent(0.95281), percent(0.05, decimals=2)
    ('5 %', '95.3 %', '5.00 %')
    """
    value = PERCENT * share
    return f"{significant(value, digits) if decimals is None else f'{value:.{decimals}f}'} %"


def share_in_words(share: float | None, *, decimals: int | None = None) -> str:
    """Write a share that is promised in per cent; None where none is.

    >>> share_in_words(0.95), share_in_words(None)
    ('95 %', 'no share')
    """
    return "no share" if share is None else percent(share, decimals=decimals)


def decimals_of_uncertainty(uncertainty: float, digits: int | None = None) -> int:
    """Return with how many decimals a number is written whose uncertainty is given in the same unit.

    `digits`: significant digits of the uncertainty, where it is itself what is written.

    >>> [decimals_of_uncertainty(uncertainty) for uncertainty in (18.0, 1.8, 0.54, 0.02)]
    [0, 1, 1, 3]
    """
    if not 0.0 < uncertainty < math.inf:
        return _UNKNOWN_DECIMALS
    exponent = math.floor(math.log10(uncertainty))
    digits = digits or (2 if uncertainty < _TWO_DIGITS_BELOW * 10.0**exponent else 1)
    return max(digits - 1 - exponent, 0)


def decimals_of_interval(value: float, low: float, high: float) -> int:
    """Return with how many decimals a value and its interval are written; the shorter side decides.

    >>> decimals_of_interval(2.28, 0.42, 4.83), decimals_of_interval(11.0, 3.0, 20.0)
    (1, 0)
    """
    sides = [side for side in (value - low, high - value) if side > 0.0]
    return decimals_of_uncertainty(min(sides, default=0.0))


def value_and_interval(
    value: float, low: float, high: float, *, most_decimals: int | None = None
) -> tuple[str, str]:
    """Write a value and the ends of its interval, with the digits that the interval allows.

    >>> value_and_interval(0.5969, 0.5764, 0.6160)
    ('0.597', '0.576 to 0.616')
    """
    decimals = decimals_of_interval(value, low, high)
    decimals = decimals if most_decimals is None else min(decimals, most_decimals)
    return f"{value:.{decimals}f}", f"{low:.{decimals}f} to {high:.{decimals}f}"


def percent_and_interval(value: float, low: float, high: float) -> tuple[str, str]:
    """Write a share [-] and the ends of its interval in per cent.

    >>> percent_and_interval(0.0228, 0.0042, 0.0483)
    ('2.3 %', '0.4 to 4.8 %')
    """
    ends = (PERCENT * value, PERCENT * low, PERCENT * high)
    size, interval = value_and_interval(*ends, most_decimals=_MOST_OF_PERCENT)
    return f"{size} %", f"{interval} %"


def percent_with_interval(value: float, low: float, high: float) -> str:
    """Write a share [-] in per cent, with the ends of its interval.

    >>> percent_with_interval(0.0228, 0.0042, 0.0483)
    '2.3 % (0.4 to 4.8 %)'
    """
    size, interval = percent_and_interval(value, low, high)
    return f"{size} ({interval})"


def counted(number: int, noun: str) -> str:
    """Write how many there are of a thing whose plural ends in s.

    >>> counted(1, "test"), counted(12, "test")
    ('1 test', '12 tests')
    """
    return f"{number} {noun}{'' if number == 1 else 's'}"


def quantity_and_interval(value: float, low: float, high: float, unit: str) -> str:
    """Write a value with its interval, in a unit in which they are readable.

    >>> quantity_and_interval(2300.0, 1900.0, 2700.0, "N"), quantity_and_interval(-4e-5, -0.1, 0.1, "-")
    ('2300 N (1900 to 2700)', '0.00 (−0.10 to 0.10)')
    """
    scale, name = readable_unit(unit, max(abs(value), abs(low), abs(high)))
    number, interval = value_and_interval(value / scale, low / scale, high / scale)
    is_power = name.startswith("·")
    text = f"{number} ({interval}){name}" if is_power else f"{number} {name} ({interval})"
    return _NEGATIVE_ZERO.sub(r"\1", text).replace("  ", " ").replace("-", "−")


def readable_unit(unit: str, size: float) -> tuple[float, str]:
    """Return a power of ten and its unit in which a size is readable.

    Forces are shown in N, kN, …, lengths and times in m, mm, … and s, ms, …

    >>> readable_unit("m/s", 0.004), readable_unit("N·s/m", 4.6e7), readable_unit("-", 3e-5)
    ((0.001, 'mm/s'), (1000000.0, 'MN·s/m'), (1e-06, '·10⁻⁶'))
    """
    exponent = 3 * math.floor(math.log10(size) / 3.0) if size > 0.0 else 0
    plain_unit = "" if unit == "-" else unit
    has_prefix = exponent in _PREFIXES and (
        unit.startswith("N") or (exponent < 0 and unit in ("m", "s", "m/s"))
    )
    if has_prefix and not (unit.startswith("N") and _READABLE[0] <= size < _READABLE[1]):
        return 10.0**exponent, _PREFIXES[exponent] + unit
    if _READABLE[0] <= size < _READABLE[1] or not exponent:
        return 1.0, plain_unit
    superscript = str(exponent).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return 10.0**exponent, f"·10{superscript} {plain_unit}".rstrip()
