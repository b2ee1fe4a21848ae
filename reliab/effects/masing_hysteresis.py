"""Hysteresis by the rule of Masing, as of soils, joints and steel that yields gradually."""

from dataclasses import dataclass, replace

import numpy as np

from reliab.core.arrays import Array
from reliab.effects.effect import Setting, SteppedEffect
from reliab.effects.hysteresis import Hysteresis
from reliab.effects.kernel import Kernel, Numbers

_SPRINGS = 32
_FIRST, _RATIO = 0.01, 1.25  # yield displacements of the springs, over d


def _force(motion: Numbers, _time: float, _step: float, coefficients: Numbers, state: Numbers) -> float:
    # Coefficients: f, d, s, stiffness of each spring over f/d. State: started, place over d, stretch of each.
    place = motion[0] / coefficients[1]
    travel = place - state[1] if state[0] != 0.0 else 0.0
    state[0], state[1] = 1.0, place
    force, limit = -coefficients[2] * place, _FIRST
    for spring in range(_SPRINGS):
        stretch = min(max(state[2 + spring] + travel, -limit), limit)
        state[2 + spring] = stretch
        force += coefficients[3 + spring] * stretch
        limit *= _RATIO
    return coefficients[0] * force


@dataclass(frozen=True, kw_only=True)
class MasingHysteresis(SteppedEffect):
    """A force f·(m(x/d) − s·x/d) whose skeleton curve is m(u) = u/(1 + |u|ⁿ)^(1/n).

    Every branch is the skeleton curve, twice as large, from the last reversal on (Masing 1926), and closes
    the loop that it interrupted: elastic-plastic springs in parallel (Iwan 1966, Journal of Applied Mechanics
    33, 893). n = 1 is the hyperbola of soils (Hardin and Drnevich 1972).
    """

    name = "masing_hysteresis"
    reported_name = Hysteresis.name
    block = Hysteresis.block
    role = Hysteresis.role
    description = "the specimen yields gradually and dissipates by the rule of Masing"
    refines = Hysteresis
    parameters = tuple(
        replace(parameter, typical=1.0, upper=8.0, starts=(1.0,) * 6)
        if parameter.name == "exponent"
        else parameter
        for parameter in Hysteresis.parameters
        if parameter.name != "gamma"
    )
    kernel = Kernel(function=_force, states=2 + _SPRINGS, linear=0, by_path=True)

    force_n: float  # Force f of the skeleton curve far out [N]
    displacement_m: float  # Displacement d at which it would be reached if all stayed elastic [m]
    exponent: float = 1.0  # Sharpness n [-] of yielding
    # Share s [-] of the elastic stiffness f/d that the linear spring has lost, from 0 to 1
    lost_share: float = 0.0

    def coefficients(self, setting: Setting) -> Array:
        """Return force, displacement, share lost and the stiffnesses of springs with the skeleton curve."""
        del setting
        limits = _FIRST * _RATIO ** np.arange(_SPRINGS)
        larger = np.maximum(limits, 1.0)
        ratio = (np.minimum(limits, 1.0) / larger) ** self.exponent
        skeleton = limits / larger * (1.0 + ratio) ** (-1.0 / self.exponent)
        slopes = np.diff(skeleton, prepend=0.0) / np.diff(limits, prepend=0.0)
        stiffnesses = slopes - np.append(slopes[1:], 0.0)
        return np.array([self.force_n, self.displacement_m, self.lost_share, *stiffnesses])
