"""How the numerical substructure is integrated: a small interface and the default.

An integrator advances x'' + c·x' + k·x = u, where u is minus the ground acceleration minus the measured
force per unit mass. The loop calls it with the force at the end of the step as far as it is known: first the
last measured one, then, once the piston has moved, the one measured there. A scheme that is explicit in the
displacement ignores the first guess and needs one correction; an implicit one repeats.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import lru_cache
from typing import ClassVar

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.effects import Kernel, Numbers


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
    def coefficients(self, substructure: LinearSubstructure, step: float) -> NDArray[np.float64]:
        """Return what the kernel reads, for a step [s]."""


def _advance(motion: Numbers, early: float, late: float, coefficients: Numbers, _scratch: Numbers) -> float:
    x, v = motion[0], motion[1]
    motion[0] = coefficients[0] * x + coefficients[1] * v + coefficients[2] * early + coefficients[3] * late
    motion[1] = coefficients[4] * x + coefficients[5] * v + coefficients[6] * early + coefficients[7] * late
    motion[2] = late - coefficients[8] * motion[1] - coefficients[9] * motion[0]
    return 0.0


class ExactIntegrator(Integrator):
    """Exact for a load that is linear within the step; its error is that of the load, (ωh)²/12."""

    kernel = Kernel(function=_advance)
    corrections = 1

    def coefficients(self, substructure: LinearSubstructure, step: float) -> NDArray[np.float64]:
        """Rows of the transition of displacement and velocity, then c and k."""
        return _transition(substructure, step)


@lru_cache(maxsize=64)
def _transition(substructure: LinearSubstructure, step: float) -> NDArray[np.float64]:
    system = np.zeros((4, 4))
    system[0, 1] = 1.0
    system[1, :3] = -substructure.stiffness, -substructure.damping, 1.0
    system[2, 3] = 1.0
    transition = scipy.linalg.expm(step * system)[:2]
    slope = transition[:, 3] / step
    rows = np.column_stack([transition[:, :2], transition[:, 2] - slope, slope])
    return np.concatenate([rows.ravel(), [substructure.damping, substructure.stiffness]])
