"""Play between the piston and the specimen, which the displacement sensor does not see."""

from dataclasses import dataclass

import numpy as np

from reliab.core.arrays import Array
from reliab.core.vocabulary import Block
from reliab.effects.effect import Parameter, Role, Setting, SteppedEffect
from reliab.effects.kernel import Kernel, Numbers


def _force(motion: Numbers, _time: float, _step: float, coefficients: Numbers, state: Numbers) -> float:
    # State: started, y. What spring and damper miss of the piston's motion; the effects that come after it
    # in the specimen see the motion beyond the play.
    x, v, half = motion[0], motion[1], 0.5 * coefficients[0]
    y = x if state[0] == 0.0 else min(max(state[1], x - half), x + half)
    rests = state[0] != 0.0 and y == state[1]
    state[0], state[1], motion[0] = 1.0, y, y
    if rests:
        motion[1] = motion[2] = 0.0
    return coefficients[1] * (y - x) - (coefficients[2] * v if rests else 0.0)


@dataclass(frozen=True, kw_only=True)
class SeriesPlay(SteppedEffect):
    """The specimen answers the motion y, which rests until the piston has crossed the play.

    Unlike the two-sided dead zone of a gap the specimen stays where it was pushed to. Play is in series with
    all of it: the linear spring and damper, and every other effect in the specimen.
    """

    name = "series_play"
    block = Block.SPECIMEN
    role = Role.FORCE
    description = "there is play between the piston and the specimen, which rests while it is crossed"
    parameters = (
        Parameter(
            name="width_m",
            units="m",
            meaning="whole play",
            scale=(("displacement", 1.0),),
            typical=0.03,
            lower=1e-5,
            upper=1.0,
            starts=(0.01, 0.03, 0.1),
        ),
    )
    kernel = Kernel(function=_force, states=2)

    width_m: float  # Whole play w [m]

    def coefficients(self, setting: Setting) -> Array:
        """Play, stiffness and damping of the specimen."""
        return np.array([self.width_m, setting.stiffness, setting.damping])
