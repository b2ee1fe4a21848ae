"""A spring that is touched on one side only."""

from dataclasses import dataclass
from typing import ClassVar

from reliab.discrepancy.terms.outside_term import OutsideTerm
from reliab.effects import Kernel, Numbers, Parameter, Role
from reliab.vocabulary import Block


def _force(motion: Numbers, _time: float, _step: float, coefficients: Numbers, _state: Numbers) -> float:
    return coefficients[0] * max(motion[0] - coefficients[1], 0.0)


@dataclass(frozen=True, kw_only=True)
class OneSidedSpring(OutsideTerm):
    """A force k·max(x − x₀, 0)."""

    expression: ClassVar[str] = "max(x − start, 0)"
    name = "one-sided spring"
    block = Block.SPECIMEN
    role = Role.FORCE
    description = "a spring is touched on one side only"
    parameters = (
        Parameter(
            name="stiffness_n_per_m", units="N/m", meaning="stiffness of the one-sided spring",
            scale=(("force", 1.0), ("displacement", -1.0)), signed=True, typical=0.2, lower=-5.0, upper=5.0,
            starts=(0.02, 0.02, 0.02, 0.02, 0.02, 0.02),
        ),
        Parameter(
            name="start_m", units="m", meaning="displacement at which it is touched",
            scale=(("displacement", 1.0),), signed=True, typical=0.4, lower=-1.0, upper=1.0,
            starts=(0.02, 0.2, 0.5, -0.02, -0.2, -0.5),
        ),
    )  # fmt: skip
    kernel = Kernel(function=_force)

    stiffness_n_per_m: float  # Stiffness k [N/m]
    start_m: float  # Displacement x₀ at which it is touched [m]
