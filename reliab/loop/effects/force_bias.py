"""Zero offset of the load cell."""

from dataclasses import dataclass

from reliab.loop.effects.effect import Role, SteppedEffect
from reliab.loop.effects.kernel import Kernel, Numbers
from reliab.loop.effects.parameter import Parameter
from reliab.vocabulary import Block


def _reading(_motion: Numbers, _time: float, _step: float, coefficients: Numbers, _state: Numbers) -> float:
    return coefficients[0]


@dataclass(frozen=True, kw_only=True)
class ForceBias(SteppedEffect):
    """A load cell that reads b without load; this reading is fed back into the loop.

    Parameters
    ----------
    bias_n : float
        Offset b [N].
    """

    name = "force_bias"
    block = Block.SENSOR
    role = Role.FORCE_READING
    description = "the load cell has a zero offset"
    parameters = (
        Parameter(
            name="bias_n",
            units="N",
            meaning="offset of the reading",
            scale=(("force", 1.0),),
            signed=True,
            typical=0.3,
            lower=-10.0,
            upper=10.0,
            starts=(0.0,),
        ),
    )
    kernel = Kernel(function=_reading)

    bias_n: float
