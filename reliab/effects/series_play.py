"""Play between the piston and the specimen, which the displacement sensor does not see."""

from dataclasses import dataclass

import numpy as np

from reliab.arrays import Array
from reliab.effects.effect import Parameter, Role, Setting, SteppedEffect
from reliab.effects.kernel import Kernel, Numbers
from reliab.vocabulary import Block


def _force(motion: Numbers, _time: float, _step: float, coefficients: Numbers, state: Numbers) -> float:
    # State: started, y. What the spring and the damper miss of the piston's motion.
    x, half = motion[0], 0.5 * coefficients[0]
    y = x if state[0] == 0.0 else min(max(state[1], x - half), x + half)
    rests = state[0] != 0.0 and y == state[1]
    state[0], state[1] = 1.0, y
    return coefficients[1] * (y - x) - (coefficients[2] * motion[1] if rests else 0.0)


@dataclass(frozen=True, kw_only=True)
class SeriesPlay(SteppedEffect):
    """The linear specimen answers k·y + c·y', where y rests until the piston has crossed the play.

    Unlike the two-sided dead zone of a gap the specimen stays where it was pushed to.
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
            starts=(0.01, 0.1),
        ),
    )
    kernel = Kernel(function=_force, states=2)

    width_m: float  # Whole play w [m]

    def coefficients(self, setting: Setting) -> Array:
        """Play, stiffness and damping of the specimen."""
        return np.array([self.width_m, setting.stiffness, setting.damping])
