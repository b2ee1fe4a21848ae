"""Central difference method."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from reliab.effects import Kernel, Numbers
from reliab.simulation.integrators.integrator import Integrator, LinearSubstructure


def _advance(motion: Numbers, _early: float, late: float, coefficients: Numbers, _scratch: Numbers) -> float:
    h, c, k = coefficients[0], coefficients[1], coefficients[2]
    motion[0] += h * motion[1] + 0.5 * h * h * motion[2]
    half_way = motion[1] + 0.5 * h * motion[2]
    motion[2] = (late - c * half_way - k * motion[0]) / (1.0 + 0.5 * h * c)
    motion[1] = half_way + 0.5 * h * motion[2]
    return 0.0


@dataclass(frozen=True, kw_only=True)
class CentralDifference(Integrator):
    """Central differences of displacement, stable for ω₀h < 2.

    Written with displacement, velocity and acceleration at one instant, which is Newmark's method with
    β = 0 and γ = ½.

    Nakashima, M., Kato, H. and Takaoka, E. (1992). Development of real-time pseudo dynamic testing.
    *Earthquake Eng. Struct. Dyn.* 21(1), 79–92.
    """

    kernel: ClassVar[Kernel] = Kernel(function=_advance)
    corrections: ClassVar[int] = 1

    def coefficients(self, substructure: LinearSubstructure, step: float) -> NDArray[np.float64]:
        """Step, damping and stiffness of the numerical substructure."""
        return np.array([step, substructure.damping, substructure.stiffness])
