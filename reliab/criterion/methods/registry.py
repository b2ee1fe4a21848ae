"""Methods by the names they have on the command line."""

from typing import Final

from reliab.criterion.methods.method import Method
from reliab.criterion.methods.quantile import Quantile
from reliab.errors import InputError

METHODS: Final[dict[str, type[Method]]] = {each.name: each for each in (Quantile,)}
"""Every method by its name."""


def method_of(name: str) -> Method:
    """Make the method of a name, with its default settings.

    Parameters
    ----------
    name : str
        One of `METHODS`.

    Returns
    -------
    Method
        The method.

    Raises
    ------
    InputError
        If there is none of that name.
    """
    if name not in METHODS:
        raise InputError("The method must be known", value=name, remedy=f"Choose among {', '.join(METHODS)}")
    return METHODS[name]()
