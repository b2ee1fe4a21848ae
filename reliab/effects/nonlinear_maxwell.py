"""A damper whose force grows with a power of the velocity, behind a spring."""

import math
from dataclasses import dataclass, replace

import numpy as np

from reliab.core.arrays import Array
from reliab.effects.effect import Parameter, Setting
from reliab.effects.kernel import Kernel, Numbers
from reliab.effects.power_law_damping import PowerLawDamping
from reliab.effects.viscoelastic_branch import ViscoelasticBranch

_GAMMA = 1.0 - math.sqrt(0.5)
_MOST_STEPS, _TOLERANCE, _TINY = 20, 1e-10, 1e-300  # of Newton's method


def _force(motion: Numbers, _time: float, step: float, coefficients: Numbers, state: Numbers) -> float:
    # Coefficients: c, p, k. State: started, x, force over c. F' = k·(v − sgn(F)·(|F|/c)^(1/p)) under a
    # straight x, by the L-stable Runge-Kutta method of second order with two equal implicit stages. Each
    # solves F + w·sgn(F)·|F|^(1/p) = aim by Newton's method, from above, where it converges.
    stiffness, power = coefficients[2] / coefficients[0], 1.0 / coefficients[1]
    travel = stiffness * (motion[0] - state[1]) if state[0] != 0.0 else 0.0
    way = _GAMMA * stiffness * step
    force, rise = state[2], 0.0
    for _stage in range(2):
        aim = state[2] + (1.0 - _GAMMA) * rise + _GAMMA * travel
        size = abs(aim)
        found = min(size, math.pow(size / way, coefficients[1]))
        for _trial in range(_MOST_STEPS):
            moved = way * math.pow(found, power)
            excess = (found + moved - size) / (1.0 + power * moved / max(found, _TINY))
            found = max(found - excess, 0.0)
            if abs(excess) <= _TOLERANCE * found:
                break
        force = found if aim > 0.0 else -found
        rise = (force - state[2]) / _GAMMA
    state[0], state[1], state[2] = 1.0, motion[0], force
    return coefficients[0] * force


@dataclass(frozen=True, kw_only=True)
class NonlinearMaxwell(PowerLawDamping):
    """A force F with F' = k·(v − sgn(F)·(|F|/c)^(1/p)): a fluid damper behind the stiffness of oil and brace.

    Makris and Constantinou (1991), Journal of Structural Engineering 117, 2708, with a power of the velocity.
    """

    name = "nonlinear_maxwell"
    description = "the specimen has a damper of a power of the velocity below one, behind a spring"
    refines = PowerLawDamping
    limiting_cases = (PowerLawDamping, ViscoelasticBranch)
    parameters = (
        PowerLawDamping.parameters[0],
        # a smaller exponent behind a spring is dry friction or yielding there: hysteresis
        replace(PowerLawDamping.parameters[1], lower=0.25),
        Parameter(
            name="series_stiffness_n_per_m",
            units="N/m",
            meaning="stiffness in series with the damper",
            scale=(("force", 1.0), ("displacement", -1.0)),
            typical=5.0,
            spread=1.5,
            lower=0.05,
            upper=1e3,
            starts=(0.3, 3.0),
        ),
    )
    kernel = Kernel(function=_force, states=3)

    series_stiffness_n_per_m: float  # k [N/m]

    def coefficients(self, setting: Setting) -> Array:
        """Parameters; without a damper there is nothing that the spring could hold."""
        del setting
        values = self.values
        values[0] = max(values[0], math.ulp(1.0))
        return np.asarray(values)
