"""A delay that depends on the direction of motion, as of an actuator with unequal piston areas."""

from dataclasses import dataclass

from reliab.core.vocabulary import Block
from reliab.effects.effect import Parameter, Role, SteppedEffect
from reliab.effects.kernel import Kernel, Numbers


def _delay(motion: Numbers, _time: float, _step: float, coefficients: Numbers, _state: Numbers) -> float:
    return 0.5 * coefficients[0] if motion[1] < 0.0 else -0.5 * coefficients[0]


@dataclass(frozen=True, kw_only=True)
class DirectionalDelay(SteppedEffect):
    """A delay longer by Δ/2 moving down and shorter by Δ/2 moving up, which adds Δ|v|/2 to the piston.

    An actuator with one piston rod has unequal areas, and a table carries its own weight: Merritt (1967),
    *Hydraulic control systems*, chapter 6.
    """

    name = "directional_delay"
    block = Block.ACTUATOR
    role = Role.DELAY
    description = "the actuator's delay differs between both directions"
    parameters = (
        Parameter(
            name="difference_s",
            units="s",
            meaning="delay while moving down minus delay while moving up",
            scale=(("displacement", 1.0), ("velocity", -1.0)),
            signed=True,
            typical=0.1,
            lower=-2.0,
            upper=2.0,
            starts=(0.01,),
        ),
    )
    kernel = Kernel(function=_delay)

    difference_s: float  # Δ [s], positive when the actuator is later while it moves down
