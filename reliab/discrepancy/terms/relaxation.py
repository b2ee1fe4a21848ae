"""A spring in series with a dashpot, beside the specimen."""

from dataclasses import dataclass
from typing import ClassVar

from reliab.discrepancy.terms.outside_term import OutsideTerm
from reliab.effects import Kernel, Numbers, Parameter, Role
from reliab.vocabulary import Block


def _force(motion: Numbers, _time: float, step: float, coefficients: Numbers, state: Numbers) -> float:
    # State: started, x, displacement q of the dashpot; T·q' = x − q.
    ratio = step / coefficients[1]
    decay = 2.718281828459045 ** (-ratio)
    late = 1.0 - (1.0 - decay) / ratio
    x = motion[0]
    if state[0] == 0.0:
        state[2] = x
    else:
        state[2] = decay * state[2] + (1.0 - decay - late) * state[1] + late * x
    state[0], state[1] = 1.0, x
    return coefficients[0] * (x - state[2])


@dataclass(frozen=True, kw_only=True)
class Relaxation(OutsideTerm):
    """A force k(x − q) with T·q' = x − q, of a Maxwell element."""

    expression: ClassVar[str] = "(x − q), T q' = x − q"
    name = "relaxation"
    block = Block.SPECIMEN
    role = Role.FORCE
    description = "the specimen relaxes like a spring in series with a dashpot"
    parameters = (
        Parameter(
            name="stiffness_n_per_m", units="N/m", meaning="stiffness of the branch",
            scale=(("force", 1.0), ("displacement", -1.0)), signed=True, typical=0.2, lower=-10.0, upper=10.0,
            starts=(0.02, 0.02, 0.02),
        ),
        Parameter(
            name="time_s", units="s", meaning="relaxation time",
            scale=(("displacement", 1.0), ("velocity", -1.0)), typical=1.0, lower=0.02, upper=30.0,
            starts=(0.3, 1.0, 3.0),
        ),
    )  # fmt: skip
    kernel = Kernel(function=_force, states=3)

    stiffness_n_per_m: float  # Stiffness k [N/m]
    time_s: float  # Relaxation time T [s]
