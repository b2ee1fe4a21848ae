"""A controller that integrates explicitly with a coarser step than the loop's."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from reliab.effects import Kernel, Numbers
from reliab.simulation.integrators.integrator import Integrator, LinearSubstructure

_CALLS = 2  # to each step of the loop


def _advance(motion: Numbers, early: float, late: float, coefficients: Numbers, state: Numbers) -> float:
    # The acceleration is that of the controller's last instant. The state counts calls, two to each step:
    # since that instant, and whether in the first step, before which nothing was held.
    h, c, k = coefficients[0], coefficients[1], coefficients[2]
    begin, end, straight, calls = coefficients[3], coefficients[4], coefficients[5], coefficients[6]
    if state[1] < _CALLS:
        motion[2] = early
        state[1] += 1.0
    held = motion[2]
    bend = 0.0 if straight > 0.0 else h * held
    motion[0] += h * (motion[1] + 0.5 * bend)
    motion[1] += bend
    state[0] += 1.0
    if state[0] > calls - 1.5:
        free = motion[1] + begin * held
        motion[2] = (late - c * free - k * motion[0]) / (1.0 + end * c)
        motion[1] = free + end * motion[2]
        if state[0] > calls - 0.5:
            state[0] = 0.0
    return 0.0


@dataclass(frozen=True, kw_only=True)
class CoarseExplicit(Integrator):
    """Newmark's explicit scheme with any γ and a step of several steps of the loop.

    Between its instants the command follows the parabola of its step, or a straight line: with γ = −½ that
    is forward Euler. The substructure is at rest before the first step.

    Newmark, N. M. (1959). A method of computation for structural dynamics. *J. Eng. Mech. Div.* 85(3), 67–94.
    """

    kernel: ClassVar[Kernel] = Kernel(function=_advance)
    corrections: ClassVar[int] = 1

    gamma: float  # γ [-]
    steps: int  # Steps of the loop per step of the controller
    straight: bool  # Whether the command moves in straight lines

    def coefficients(self, substructure: LinearSubstructure, step: float) -> NDArray[np.float64]:
        """Step, damping, stiffness, weights of old and new acceleration, path, and calls to an instant."""
        coarse = self.steps * step
        end = (self.gamma + (0.5 if self.straight else 0.0)) * coarse
        begin = coarse - end if self.straight else -end
        path = float(self.straight), float(_CALLS * self.steps)
        return np.array([step, substructure.damping, substructure.stiffness, begin, end, *path])
