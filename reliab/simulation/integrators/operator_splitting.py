"""Operator-splitting method for real-time tests."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from reliab.effects import Kernel, Numbers
from reliab.simulation.integrators.integrator import Integrator, LinearSubstructure
from reliab.structures import Structure


def _advance(motion: Numbers, _early: float, late: float, coefficients: Numbers, _scratch: Numbers) -> float:
    h, c, k, specimen = coefficients[0], coefficients[1], coefficients[2], coefficients[3]
    corrected = motion[0] + 0.25 * h * h * motion[2]
    predicted = corrected + h * motion[1] + 0.25 * h * h * motion[2]
    half_way = motion[1] + 0.5 * h * motion[2]
    inertia = 1.0 + 0.5 * h * c + 0.25 * h * h * (k + specimen)
    motion[2] = (late - c * half_way - k * predicted) / inertia
    motion[1] = half_way + 0.5 * h * motion[2]
    motion[0] = predicted
    return 0.0


@dataclass(frozen=True, kw_only=True)
class OperatorSplitting(Integrator):
    """Newmark's average acceleration with the predicted displacement as command.

    The specimen is moved to the predictor x̃ = x + hv + h²a/4; its force is corrected with its initial
    stiffness k_e to that at x₊ = x̃ + h²a₊/4, which makes the method implicit, and unconditionally
    stable, without iteration. The command is the predictor.

    Wu, B., Xu, G., Wang, Q. and Williams, M. S. (2006). Operator-splitting method for real-time
    substructure testing. *Earthquake Eng. Struct. Dyn.* 35(3), 293–314.
    """

    kernel: ClassVar[Kernel] = Kernel(function=_advance)
    corrections: ClassVar[int] = 1

    structure: Structure  # The whole structure; its experimental fraction gives k_e

    def coefficients(self, substructure: LinearSubstructure, step: float) -> NDArray[np.float64]:
        """Step, damping and stiffness of the numerical substructure, initial specimen stiffness."""
        specimen = self.structure.experimental_fraction * self.structure.circular_frequency**2
        return np.array([step, substructure.damping, substructure.stiffness, specimen])
