"""Integration of the numerical substructure, exact and by the explicit scheme of a slow controller."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import lru_cache
from typing import ClassVar

import numpy as np
import scipy

from reliab.core.arrays import Array
from reliab.effects.kernel import Kernel, Numbers


@dataclass(frozen=True, kw_only=True)
class LinearSubstructure:
    """The numerical substructure per unit mass, x'' + c·x' + k·x = u."""

    damping: float  # c [1/s]
    stiffness: float  # k [1/s²]


class Integrator(ABC):
    """A scheme that advances the numerical substructure by one step."""

    # Called as `kernel(motion, u₀, u₁, coefficients, scratch)` with the motion at the begin of the step,
    # which it advances to the end; u₀ and u₁ [m/s²] are the loads at both ends. Its return value is ignored
    kernel: ClassVar[Kernel]
    corrections: ClassVar[int]  # How often the step is repeated with the force measured at its end

    @abstractmethod
    def coefficients(self, substructure: LinearSubstructure, step: float) -> Array:
        """Return what the kernel reads, for a step [s]."""


def _advance_exact(
    motion: Numbers, early: float, late: float, coefficients: Numbers, _scratch: Numbers
) -> float:
    x, v = motion[0], motion[1]
    motion[0] = coefficients[0] * x + coefficients[1] * v + coefficients[2] * early + coefficients[3] * late
    motion[1] = coefficients[4] * x + coefficients[5] * v + coefficients[6] * early + coefficients[7] * late
    motion[2] = late - coefficients[8] * motion[1] - coefficients[9] * motion[0]
    return 0.0


class ExactIntegrator(Integrator):
    """Exact for a load that is linear within the step; its error is that of the load, (ωh)²/12."""

    kernel = Kernel(function=_advance_exact)
    corrections = 1

    def coefficients(self, substructure: LinearSubstructure, step: float) -> Array:
        """Rows of the transition of displacement and velocity, then c and k."""
        return _transition(substructure, step)


@lru_cache(maxsize=64)
def _transition(substructure: LinearSubstructure, step: float) -> Array:
    system = np.zeros((4, 4))
    system[0, 1] = 1.0
    system[1, :3] = -substructure.stiffness, -substructure.damping, 1.0
    system[2, 3] = 1.0
    transition = scipy.linalg.expm(step * system)[:2]
    slope = transition[:, 3] / step
    rows = np.column_stack([transition[:, :2], transition[:, 2] - slope, slope])
    return np.concatenate([rows.ravel(), [substructure.damping, substructure.stiffness]])


_CALLS = 2  # to each step of the loop


def _advance_coarse(
    motion: Numbers, early: float, late: float, coefficients: Numbers, state: Numbers
) -> float:
    # The acceleration is that of the controller's last instant. The state counts calls, two to each step:
    # since that instant, and whether in the first step, before which nothing was held.
    h, c, k = coefficients[0], coefficients[1], coefficients[2]
    begin, end, straight, calls = coefficients[3], coefficients[4], coefficients[5], coefficients[6]
    if state[1] < _CALLS:
        motion[2] = early
        state[1] += 1.0
    acceleration = motion[2]
    bend = 0.0 if straight > 0.0 else h * acceleration
    motion[0] += h * (motion[1] + 0.5 * bend)
    motion[1] += bend
    state[0] += 1.0
    if state[0] > calls - 1.5:
        free = motion[1] + begin * acceleration
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

    kernel: ClassVar[Kernel] = Kernel(function=_advance_coarse)
    corrections: ClassVar[int] = 1

    gamma: float  # γ [-]
    steps: int  # Steps of the loop per step of the controller
    straight: bool  # Whether the command moves in straight lines

    def coefficients(self, substructure: LinearSubstructure, step: float) -> Array:
        """Step, damping, stiffness, weights of old and new acceleration, path, and calls to an instant."""
        coarse = self.steps * step
        end = (self.gamma + (0.5 if self.straight else 0.0)) * coarse
        begin = coarse - end if self.straight else -end
        path = float(self.straight), float(_CALLS * self.steps)
        return np.array([step, substructure.damping, substructure.stiffness, begin, end, *path])
