"""One value or several, as users state them."""

from collections.abc import Iterable, Sequence
from typing import Any, overload

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
