"""A delay that grows with the amplitude of the command."""

from dataclasses import dataclass
from typing import ClassVar

from reliab.discrepancy.terms.outside_term import OutsideTerm
from reliab.effects import Kernel, Numbers, Parameter, Role
from reliab.vocabulary import Block


def _delay(motion: Numbers, _time: float, step: float, coefficients: Numbers, state: Numbers) -> float:
    # State: the envelope e, T·e' + e = |x|.
    state[0] += (abs(motion[0]) - state[0]) * step / (coefficients[1] + step)
    return coefficients[0] * state[0]


@dataclass(frozen=True, kw_only=True)
class AmplitudeDelay(OutsideTerm):
    """A delay κ·e more, where e is the modulus of the command, smoothed."""

    expression: ClassVar[str] = "v·envelope(|x|)"
    name = "amplitude-dependent delay"
    block = Block.ACTUATOR
    role = Role.DELAY
    description = "the delay depends on the amplitude of the command"
    parameters = (
        Parameter(
            name="delay_s_per_m", units="s/m", meaning="growth of the delay with the amplitude",
            scale=(("velocity", -1.0),), signed=True, typical=0.03, lower=-2.0, upper=2.0,
            starts=(0.003, 0.003, 0.003),
        ),
        Parameter(
            name="envelope_time_s", units="s", meaning="memory of the amplitude",
            scale=(("displacement", 1.0), ("velocity", -1.0)), typical=1.0, lower=0.01, upper=30.0,
            starts=(0.1, 1.0, 6.0),
        ),
    )  # fmt: skip
    kernel = Kernel(function=_delay, states=1)

    delay_s_per_m: float  # κ [s/m]
    envelope_time_s: float  # Time constant of the smoothing [s]
