"""Zero offsets of the displacement sensor and of the load cell."""

from dataclasses import dataclass

from reliab.effects.effect import Parameter, Role, SteppedEffect
from reliab.effects.kernel import Kernel, Numbers
from reliab.vocabulary import Block


def _reading(_motion: Numbers, _time: float, _step: float, coefficients: Numbers, _state: Numbers) -> float:
    return coefficients[0]


OFFSET = Kernel(function=_reading)
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


@dataclass(frozen=True, kw_only=True)
class SensorBias(SteppedEffect):
    """A displacement sensor that shows b when the piston is at zero."""

    name = "sensor_bias"
    block = Block.SENSOR
    role = Role.DISPLACEMENT_READING
    description = "the displacement sensor has a zero offset"
    parameters = (offset_parameter(name="bias_m", units="m", quantity="displacement"),)
    kernel = OFFSET

    bias_m: float  # Offset b [m]


@dataclass(frozen=True, kw_only=True)
class ForceBias(SteppedEffect):
    """A load cell that reads b without load; this reading is fed back into the loop."""

    name = "force_bias"
    block = Block.SENSOR
    role = Role.FORCE_READING
    description = "the load cell has a zero offset"
    parameters = (offset_parameter(name="bias_n", units="N", quantity="force"),)
    kernel = OFFSET

    bias_n: float  # Offset b [N]
