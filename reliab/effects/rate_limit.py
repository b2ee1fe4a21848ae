"""Limit of the actuator's velocity."""

from dataclasses import dataclass

from reliab.core.vocabulary import Block
from reliab.effects.effect import Parameter, Role, SteppedEffect
from reliab.effects.kernel import Kernel, Numbers


def _move(motion: Numbers, _time: float, step: float, coefficients: Numbers, state: Numbers) -> float:
    # State: started, y.
    u = motion[0]
    reach = coefficients[0] * step
    if state[0] != 0.0 and abs(u - state[1]) > reach:
        sign = 1.0 if u > state[1] else -1.0
        motion[0], motion[1], motion[2] = state[1] + sign * reach, sign * coefficients[0], 0.0
    state[0], state[1] = 1.0, motion[0]
    return 0.0


@dataclass(frozen=True, kw_only=True)
class RateLimit(SteppedEffect):
    """A piston that cannot move faster than the valve lets it, |y'| ≤ L."""

    name = "rate_limit"
    block = Block.ACTUATOR
    role = Role.PISTON
    description = "the actuator cannot move faster than a limit"
    parameters = (
        Parameter(
            name="velocity_limit_m_per_s",
            units="m/s",
            meaning="largest velocity",
            scale=(("velocity", 1.0),),
            typical=0.7,
            spread=0.8,
            lower=0.02,
            upper=1.3,
            starts=(0.97, 0.9, 0.75, 0.5, 0.25, 0.1),
        ),
    )
    kernel = Kernel(function=_move, states=2)

    velocity_limit_m_per_s: float  # Largest velocity L [m/s]
