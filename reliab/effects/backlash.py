"""Play in the actuator's linkage."""

from dataclasses import dataclass

from reliab.core.vocabulary import Block
from reliab.effects.effect import Parameter, Role, SteppedEffect
from reliab.effects.kernel import Kernel, Numbers


def _move(motion: Numbers, _time: float, _step: float, coefficients: Numbers, state: Numbers) -> float:
    # State: started, y.
    u, half = motion[0], 0.5 * coefficients[0]
    y = u if state[0] == 0.0 else min(max(state[1], u - half), u + half)
    if y == state[1]:
        motion[1] = motion[2] = 0.0
    motion[0] = y
    state[0], state[1] = 1.0, y
    return 0.0


@dataclass(frozen=True, kw_only=True)
class Backlash(SteppedEffect):
    """Play: the piston rests until the drive has crossed the slack."""

    name = "backlash"
    block = Block.ACTUATOR
    role = Role.PISTON
    description = "there is play between the actuator and the specimen"
    parameters = (
        Parameter(
            name="width_m",
            units="m",
            meaning="whole play",
            scale=(("displacement", 1.0),),
            typical=0.03,
            lower=1e-5,
            upper=1.0,
            starts=(0.003, 0.01, 0.03, 0.1, 0.3),
        ),
    )
    kernel = Kernel(function=_move, states=2)

    width_m: float  # Whole play w [m]; the piston rests while it is within ±w/2 of the drive
