"""A displacement sensor that reads one side of the motion wrongly."""

from dataclasses import dataclass

from reliab.core.vocabulary import Block
from reliab.effects.effect import Parameter, Role, SteppedEffect
from reliab.effects.kernel import Kernel, Numbers


def _reading(motion: Numbers, _time: float, _step: float, coefficients: Numbers, _state: Numbers) -> float:
    return -coefficients[0] * min(motion[0], 0.0)


@dataclass(frozen=True, kw_only=True)
class RectifiedSensor(SteppedEffect):
    """A sensor that reads y + r·max(−y, 0): half-wave rectified with r = 1, the modulus with r = 2."""

    name = "rectified_sensor"
    block = Block.SENSOR
    role = Role.DISPLACEMENT_READING
    description = "the displacement sensor rectifies: it loses or folds one side of the motion"
    parameters = (
        Parameter(
            name="rectified_share",
            units="-",
            meaning="share of the negative side that is lost (1) or folded (2)",
            typical=1.2,
            spread=0.5,
            lower=0.5,
            upper=2.1,
            starts=(1.0, 1.95),
        ),
    )
    kernel = Kernel(function=_reading)

    rectified_share: float  # r [-], from 0.5 (below it is a scale that depends on the position) to 2
