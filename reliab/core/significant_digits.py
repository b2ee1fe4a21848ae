"""Numbers in sentences: rounded to significant digits, without a power of ten where people write none.

What a table holds too is written with the table's decimals: significant digits would add some to a small
value and drop a last zero.
"""

from reliab.core.vocabulary import PERCENT

_ORDINARY = (1e-4, 1e7)


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


def percent_range(low: float, high: float, *, decimals: int = 2) -> str:
    """Write the ends of an interval in per cent.

    >>> percent_range(0.00078, 0.0492), percent_range(0.851, 0.92, decimals=1)
    ('0.08 to 4.92 %', '85.1 to 92.0 %')
    """
    return f"{PERCENT * low:.{decimals}f} to {percent(high, decimals=decimals)}"


def percent_with_interval(value: float, low: float, high: float) -> str:
    """Write an error [-] in per cent, with the ends of its interval.

    >>> percent_with_interval(0.0228, 0.0042, 0.0483)
    '2.28 % (0.42 to 4.83 %)'
    """
    return f"{percent(value, decimals=2)} ({percent_range(low, high)})"


def counted(number: int, noun: str) -> str:
    """Write how many there are of a thing whose plural ends in s.

    >>> counted(1, "test"), counted(12, "test")
    ('1 test', '12 tests')
    """
    return f"{number} {noun}{'' if number == 1 else 's'}"
