"""Where two answers differ: numbers by a tolerance, numbers in text by the digits that are written."""

import re
from collections.abc import Iterator
from itertools import zip_longest
from typing import Any

NUMBER = re.compile(r"(?<![\w.])[-+−]?\d+(?:[.]\d+)?(?:e[-+]?\d+)?")


def differences(found: Any, expected: Any, relative: float, where: str = "") -> Iterator[str]:
    """Name each place where an answer is not the expected one."""
    match found, expected:
        case dict(), dict():
            for key in [*expected, *(key for key in found if key not in expected)]:
                yield from differences(found.get(key), expected.get(key), relative, f"{where}/{key}")
        case list(), list():
            for place, pair in enumerate(zip_longest(found, expected)):
                yield from differences(*pair, relative, f"{where}/{place}")
        case _ if not _are_alike(found, expected, relative):
            yield f"{where}: {found!r} instead of {expected!r}"


def _are_alike(found: Any, expected: Any, relative: float) -> bool:
    match found, expected:
        case str(), str():
            return _reads_alike(found, expected, relative)
        case (bool() | None, _) | (_, bool() | None):
            return found is expected
        case int() | float(), int() | float():
            return abs(found - expected) <= relative * abs(expected) + 1e-12
        case _:
            return False


def _reads_alike(found: str, expected: str, relative: float) -> bool:
    """Whether words are the same, and numbers but for a unit of the last digit."""
    if found == expected:
        return True
    if _words(found) != _words(expected):
        return False
    pairs = zip(NUMBER.findall(found), NUMBER.findall(expected), strict=True)
    return all(
        abs(_value(one) - _value(other)) <= _unit(other) + relative * abs(_value(other))
        for one, other in pairs
    )


def _words(text: str) -> list[str]:
    return NUMBER.sub("#", text).split()


def _value(number: str) -> float:
    return float(number.replace("−", "-"))


def _unit(number: str) -> float:
    mantissa, _, exponent = number.partition("e")
    return 1.01 * 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))
