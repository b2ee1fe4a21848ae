"""A reading that is off by a constant: what the biases of all sensors share."""

from reliab.effects.effect import Parameter
from reliab.effects.kernel import Kernel, Numbers


def _reading(_motion: Numbers, _time: float, _step: float, coefficients: Numbers, _state: Numbers) -> float:
    return coefficients[0]


OFFSET = Kernel(function=_reading, linear=0)
"""Kernel of a constant offset, the one coefficient."""


def offset_parameter(*, name: str, units: str, quantity: str) -> Parameter:
    """Describe the offset of a reading, of either sign.

    Returns the offset, whose prior has a standard deviation of 0.3 of the quantity's peak.

    >>> offset_parameter(name="bias_n", units="N", quantity="force").scale
    (('force', 1.0),)
    """
    return Parameter(
        name=name,
        units=units,
        meaning="offset of the reading",
        scale=((quantity, 1.0),),
        signed=True,
        typical=0.3,
        lower=-10.0,
        upper=10.0,
        starts=(0.0,),
    )
