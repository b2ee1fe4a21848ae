"""Schemes by which laboratories integrate the numerical substructure."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reliab.core.arrays import Array
from reliab.effects.kernel import Kernel, Numbers
from reliab.simulation.integrators import Integrator, LinearSubstructure
from reliab.structures.structure import Structure


def _advance_central_difference(
    motion: Numbers, _early: float, late: float, coefficients: Numbers, _scratch: Numbers
) -> float:
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

    kernel: ClassVar[Kernel] = Kernel(function=_advance_central_difference)
    corrections: ClassVar[int] = 1

    def coefficients(self, substructure: LinearSubstructure, step: float) -> Array:
        """Step, damping and stiffness of the numerical substructure."""
        return np.array([step, substructure.damping, substructure.stiffness])


def _advance_chen_ricles(
    motion: Numbers, _early: float, late: float, coefficients: Numbers, _scratch: Numbers
) -> float:
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

    kernel: ClassVar[Kernel] = Kernel(function=_advance_chen_ricles)
    corrections: ClassVar[int] = 1

    structure: Structure  # The whole structure, whose initial properties enter α

    def coefficients(self, substructure: LinearSubstructure, step: float) -> Array:
        """Step, α, and damping and stiffness of the numerical substructure."""
        w0, xi = self.structure.circular_frequency, self.structure.damping_ratio
        alpha = 4.0 / (4.0 + 4.0 * xi * w0 * step + (w0 * step) ** 2)
        return np.array([step, alpha, substructure.damping, substructure.stiffness])


def _advance_operator_splitting(
    motion: Numbers, _early: float, late: float, coefficients: Numbers, _scratch: Numbers
) -> float:
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

    kernel: ClassVar[Kernel] = Kernel(function=_advance_operator_splitting)
    corrections: ClassVar[int] = 1

    structure: Structure  # The whole structure; its experimental fraction gives k_e

    def coefficients(self, substructure: LinearSubstructure, step: float) -> Array:
        """Step, damping and stiffness of the numerical substructure, initial specimen stiffness."""
        specimen = self.structure.experimental_fraction * self.structure.circular_frequency**2
        return np.array([step, substructure.damping, substructure.stiffness, specimen])
