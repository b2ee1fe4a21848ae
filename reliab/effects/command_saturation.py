"""Limit of the command that the drive passes on."""

from dataclasses import dataclass
from typing import ClassVar

from reliab.effects.stroke_saturation import StrokeSaturation


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
