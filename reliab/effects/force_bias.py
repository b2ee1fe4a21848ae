"""Zero offset of the load cell."""

from dataclasses import dataclass

from reliab.core.vocabulary import Block
from reliab.effects.effect import Role, SteppedEffect
from reliab.effects.offset import OFFSET, offset_parameter


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
