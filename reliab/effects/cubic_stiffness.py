"""Cubic spring, hardening or softening."""

from dataclasses import dataclass

from reliab.core.vocabulary import Block
from reliab.effects.effect import Parameter, Role, SteppedEffect
from reliab.effects.kernel import Kernel, Numbers


def _force(motion: Numbers, _time: float, _step: float, coefficients: Numbers, _state: Numbers) -> float:
    return coefficients[0] * motion[0] ** 3


@dataclass(frozen=True, kw_only=True)
class CubicStiffness(SteppedEffect):
    """A force k₃x³ in addition to the linear spring."""

    name = "cubic_stiffness"
    block = Block.SPECIMEN
    role = Role.FORCE
    description = "the specimen's spring hardens or softens with the cube of the displacement"
    parameters = (
        Parameter(
            name="cubic_n_per_m3",
            units="N/m³",
            meaning="cubic stiffness",
            scale=(("force", 1.0), ("displacement", -3.0)),
            signed=True,
            typical=0.6,
            lower=-3.0,
            upper=3.0,
            starts=(0.05,),
        ),
    )
    kernel = Kernel(function=_force, linear=0, by_path=True)

    cubic_n_per_m3: float  # Coefficient k₃ [N/m³], negative for a softening spring
