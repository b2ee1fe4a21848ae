"""Packages whose names are imported when they are first asked for, so that commands start at once."""

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any


def exports(package: str, homes: Mapping[str, str]) -> Callable[[str], Any]:
    """Return the `__getattr__` of a package that imports each of its names on first use.

    Parameters
    ----------
    package : str
        The package, as in its `__name__`.
    homes : mapping of str to str
        For each name the module that defines it.

    Returns
    -------
    callable
        To be bound to `__getattr__` in the package.

    Examples
    --------
    >>> load = exports("geometry", {"sqrt": "math"})
    >>> load("sqrt")(9.0)
    3.0
    """

    def load(name: str) -> Any:  # noqa: ANN401 - functions, classes and constants of many types
        if name not in homes:
            message = f"module {package!r} has no attribute {name!r}"
            raise AttributeError(message)
        return getattr(import_module(homes[name]), name)

    return load
