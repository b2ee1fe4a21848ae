"""Arguments as users state them: numbers with their standard deviations, and those that would not be used.

Messages name an argument in backquotes, `` `xi` ``, or with its value, `` `time_units="ms"` ``; the command
line writes them as its options.
"""

from collections.abc import Mapping

from reliab.errors import InputError
from reliab.stated_value import StatedValue

Quantity = float | str | StatedValue
"""A number, a number with its standard deviation as text ("1±0.01"), or such a value."""


def stated_values(**quantities: Quantity | None) -> dict[str, StatedValue]:
    """Read what is stated; None where nothing is.

    >>> stated_values(f="1±0.01", xi=0.02, mass=None)
    {'f': StatedValue(value=1.0, deviation=0.01), 'xi': StatedValue(value=0.02, deviation=0.0)}
    """
    return {name: _value(quantity, name) for name, quantity in quantities.items() if quantity is not None}


def _value(quantity: Quantity, name: str) -> StatedValue:
    if isinstance(quantity, StatedValue):
        return quantity
    return StatedValue.parse(str(quantity), f"value of `{name}`")


def require_positive(stated: Mapping[str, StatedValue]) -> None:
    """Refuse a scale of the sensor or a mass that is not positive."""
    for name in ("scale", "mass"):
        if name in stated and not stated[name].value > 0.0:
            raise InputError(
                f"The value of `{name}` must be positive",
                value=str(stated[name]),
                remedy="Give 1 for a sensor that reads true" if name == "scale" else "Give it in kilograms",
            )


def unused(name: str, why: str) -> InputError:
    """Describe an argument that would have no effect.

    Parameters
    ----------
    name : str
        The argument.
    why : str
        Beside or without what it has no meaning.

    Returns
    -------
    InputError
        To be raised.
    """
    return InputError(f"`{name}` has no meaning {why}", remedy="Leave it out")
