"""Asymmetric spring, stiffer to one side."""

from dataclasses import dataclass

from reliab.core.vocabulary import Block
from reliab.effects.effect import Parameter, Role, SteppedEffect
from reliab.effects.kernel import Kernel, Numbers


def _force(motion: Numbers, _time: float, _step: float, coefficients: Numbers, _state: Numbers) -> float:
    return coefficients[0] * motion[0] ** 2


@dataclass(frozen=True, kw_only=True)
class QuadraticStiffness(SteppedEffect):
    """A force k₂x² beside the linear spring, which is stiffer to one side than to the other."""

    name = "quadratic_stiffness"
    block = Block.SPECIMEN
    role = Role.FORCE
    description = "the specimen's spring is stiffer to one side, with the square of the displacement"
    parameters = (
        Parameter(
            name="quadratic_n_per_m2",
            units="N/m²",
            meaning="quadratic stiffness",
            scale=(("force", 1.0), ("displacement", -2.0)),
            signed=True,
            typical=0.5,
            lower=-3.0,
            upper=3.0,
            starts=(0.05,),
        ),
    )
    kernel = Kernel(function=_force, linear=0, by_path=True)

    quadratic_n_per_m2: float  # Coefficient k₂ [N/m²]
