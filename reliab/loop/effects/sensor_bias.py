"""Zero offset of the displacement sensor."""

from dataclasses import dataclass

from reliab.loop.effects.effect import Role, SteppedEffect
from reliab.loop.effects.kernel import Kernel, Numbers
from reliab.loop.effects.parameter import Parameter
from reliab.vocabulary import Block


def _reading(_motion: Numbers, _time: float, _step: float, coefficients: Numbers, _state: Numbers) -> float:
    return coefficients[0]


@dataclass(frozen=True, kw_only=True)
class SensorBias(SteppedEffect):
    """A displacement sensor that shows b when the piston is at zero.

    Parameters
    ----------
    bias_m : float
        Offset b [m].
    """

    name = "sensor_bias"
    block = Block.SENSOR
    role = Role.DISPLACEMENT_READING
    description = "the displacement sensor has a zero offset"
    parameters = (
        Parameter(
            name="bias_m",
            units="m",
            meaning="offset of the reading",
            scale=(("displacement", 1.0),),
            signed=True,
            typical=0.3,
            lower=-10.0,
            upper=10.0,
            starts=(0.0,),
        ),
    )
    kernel = Kernel(function=_reading)

    bias_m: float
