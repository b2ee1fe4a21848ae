"""One value or several, as users state them."""

from collections.abc import Iterable, Sequence
from typing import Any, overload

Numbers = float | Sequence[float]
"""One number, or several."""
Names = str | Sequence[str]
"""One name, or several."""


@overload
def several(values: Names) -> tuple[str, ...]: ...
@overload
def several(values: Numbers) -> tuple[float, ...]: ...


def several(values: Any) -> tuple[Any, ...]:
    """Take one value, or several of them.

    `values`: a number or a name, or several; NumPy's arrays as well.

    >>> several(0.05), several([0.05, 0.10]), several("rms")
    ((0.05,), (0.05, 0.1), ('rms',))
    """
    if isinstance(values, str):
        return (values,)
    return tuple(values) if isinstance(values, Iterable) else (values,)
