"""Explicit integration of Chen and Ricles (CR)."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from reliab.effects import Kernel, Numbers
from reliab.simulation.integrators.integrator import Integrator, LinearSubstructure
from reliab.structures import Structure


def _advance(motion: Numbers, _early: float, late: float, coefficients: Numbers, _scratch: Numbers) -> float:
    h, alpha, c, k = coefficients[0], coefficients[1], coefficients[2], coefficients[3]
    motion[0] += h * motion[1] + alpha * h * h * motion[2]
    motion[1] += alpha * h * motion[2]
    motion[2] = late - c * motion[1] - k * motion[0]
    return 0.0


@dataclass(frozen=True, kw_only=True)
class ChenRicles(Integrator):
    """Explicit in displacement and velocity, unconditionally stable for a linear structure.

    x₊ = x + hv + αh²a, v₊ = v + αha with α = 4/(4 + 4ξω₀h + ω₀²h²) of the whole structure.

    Chen, C. and Ricles, J. M. (2008). Development of direct integration algorithms for structural
    dynamics using discrete control theory. *J. Eng. Mech.* 134(8), 676–683.
    """

    kernel: ClassVar[Kernel] = Kernel(function=_advance)
    corrections: ClassVar[int] = 1

    structure: Structure  # The whole structure, whose initial properties enter α

    def coefficients(self, substructure: LinearSubstructure, step: float) -> NDArray[np.float64]:
        """Step, α, and damping and stiffness of the numerical substructure."""
        w0, xi = self.structure.circular_frequency, self.structure.damping_ratio
        alpha = 4.0 / (4.0 + 4.0 * xi * w0 * step + (w0 * step) ** 2)
        return np.array([step, alpha, substructure.damping, substructure.stiffness])
