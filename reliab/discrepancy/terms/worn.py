"""A spring that weakens with the largest displacement so far."""

from dataclasses import dataclass
from typing import ClassVar

from reliab.discrepancy.terms.outside_term import OutsideTerm
from reliab.effects import Kernel, Numbers, Parameter, Role
from reliab.vocabulary import Block


def _force(motion: Numbers, _time: float, _step: float, coefficients: Numbers, state: Numbers) -> float:
    state[0] = max(state[0], abs(motion[0]))
    return coefficients[0] * state[0] * motion[0]


def _slack(motion: Numbers, _time: float, _step: float, coefficients: Numbers, state: Numbers) -> float:
    state[0] = max(state[0], abs(motion[0]))
    return coefficients[0] * min(max(motion[0], -coefficients[1] * state[0]), coefficients[1] * state[0])


@dataclass(frozen=True, kw_only=True)
class WornSpring(OutsideTerm):
    """A force c·x·max|x|, where the maximum is that of the test so far."""

    expression: ClassVar[str] = "x max|x|"
    name = "worn spring"
    block = Block.SPECIMEN
    role = Role.FORCE
    description = "the specimen changes with the largest displacement so far"
    parameters = (
        Parameter(
            name="coefficient", units="N/m²", meaning="change of stiffness",
            scale=(("force", 1.0), ("displacement", -2.0)), signed=True, typical=0.2, lower=-10.0, upper=10.0,
            starts=(0.02,),
        ),
    )  # fmt: skip
    kernel = Kernel(function=_force, states=1)

    coefficient: float  # c [N/m²], negative when the specimen weakens


@dataclass(frozen=True, kw_only=True)
class GrowingSlack(OutsideTerm):
    """A force c·x within ±s·max|x| and constant beyond, where the maximum is that of the test so far."""

    expression: ClassVar[str] = "min(max(x, −s max|x|), s max|x|)"
    name = "growing slack"
    block = Block.SPECIMEN
    role = Role.FORCE
    description = "there is a slack that grows with the largest displacement so far"
    parameters = (
        Parameter(
            name="stiffness_n_per_m", units="N/m", meaning="stiffness within the slack",
            scale=(("force", 1.0), ("displacement", -1.0)), signed=True, typical=0.5, lower=-10.0, upper=10.0,
            starts=(0.1, 0.1, 0.1),
        ),
        Parameter(
            name="share", units="-", meaning="slack over the largest displacement",
            typical=0.1, lower=0.003, upper=0.9, starts=(0.03, 0.1, 0.3),
        ),
    )  # fmt: skip
    kernel = Kernel(function=_slack, states=1)

    stiffness_n_per_m: float  # c [N/m], minus the spring's stiffness for a slack
    share: float  # s [-]
