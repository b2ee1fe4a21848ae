"""Zero offset of the displacement sensor."""

from dataclasses import dataclass

from reliab.core.vocabulary import Block
from reliab.effects.effect import Role, SteppedEffect
from reliab.effects.offset import OFFSET, offset_parameter


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
