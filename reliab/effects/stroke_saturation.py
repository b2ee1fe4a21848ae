"""Limit of the actuator's stroke, and of the command that the drive passes on."""

from dataclasses import dataclass
from typing import ClassVar

from reliab.core.vocabulary import Block
from reliab.effects.effect import Parameter, Role, SteppedEffect
from reliab.effects.kernel import Kernel, Numbers


def _move(motion: Numbers, _time: float, _step: float, coefficients: Numbers, _state: Numbers) -> float:
    if abs(motion[0]) > coefficients[0]:
        motion[0] = coefficients[0] if motion[0] > 0.0 else -coefficients[0]
        motion[1] = motion[2] = 0.0
    return 0.0


@dataclass(frozen=True, kw_only=True)
class StrokeSaturation(SteppedEffect):
    """A piston that stops at the end of its stroke, |y| ≤ S."""

    position: ClassVar[str] = "after the dynamics"
    name = "stroke_saturation"
    block = Block.ACTUATOR
    role = Role.PISTON
    description = "the actuator stops at the end of its stroke"
    parameters = (
        Parameter(
            name="stroke_m",
            units="m",
            meaning="stroke to either side",
            scale=(("displacement", 1.0),),
            typical=0.7,
            spread=0.8,
            lower=0.02,
            upper=1.3,
            starts=(0.97, 0.9, 0.75, 0.5, 0.25, 0.1),
        ),
    )
    kernel = Kernel(function=_move)

    stroke_m: float  # Largest displacement S to either side [m]


@dataclass(frozen=True, kw_only=True)
class CommandSaturation(StrokeSaturation):
    """A drive that clips its command, |k_p·u| ≤ S, before the dynamics, which round the corners.

    `stroke_m`: Largest command S to either side [m], after the actuator's gain, in the unit of the piston's
    motion.
    """

    position: ClassVar[str] = "before the dynamics"
    name = "command_saturation"
    reported_name = "stroke_saturation"
    description = "the drive clips the command before the actuator's dynamics"
