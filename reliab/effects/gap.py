"""Slack on both sides of the specimen's spring."""

from dataclasses import dataclass

import numpy as np

from reliab.core.arrays import Array
from reliab.core.vocabulary import Block
from reliab.effects.effect import Parameter, Role, Setting, SteppedEffect
from reliab.effects.kernel import Kernel, Numbers


def _force(motion: Numbers, _time: float, _step: float, coefficients: Numbers, _state: Numbers) -> float:
    # What the slack takes away from the linear spring's force.
    return -coefficients[1] * min(max(motion[0], -coefficients[0]), coefficients[0])


@dataclass(frozen=True, kw_only=True)
class Gap(SteppedEffect):
    """A two-sided dead zone: the spring's force is k·sgn(x)·max(|x| − g, 0) instead of k·x."""

    name = "gap"
    block = Block.SPECIMEN
    role = Role.FORCE
    description = "there is slack between the specimen and its spring"
    parameters = (
        Parameter(
            name="gap_m",
            units="m",
            meaning="slack to either side",
            scale=(("displacement", 1.0),),
            typical=0.05,
            lower=1e-5,
            upper=1.0,
            starts=(0.003, 0.01, 0.03, 0.1, 0.3),
        ),
    )
    kernel = Kernel(function=_force, linear=1, by_path=True)

    gap_m: float  # Slack g to either side [m]

    def coefficients(self, setting: Setting) -> Array:
        """Slack and stiffness of the spring."""
        return np.array([self.gap_m, setting.stiffness])
