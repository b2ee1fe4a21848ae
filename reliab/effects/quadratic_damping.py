"""Quadratic (hydraulic) damping of the specimen."""

from dataclasses import dataclass

from reliab.core.vocabulary import Block
from reliab.effects.effect import Parameter, Role, SteppedEffect
from reliab.effects.kernel import Kernel, Numbers


def _force(motion: Numbers, _time: float, _step: float, coefficients: Numbers, _state: Numbers) -> float:
    return coefficients[0] * motion[1] * abs(motion[1])


@dataclass(frozen=True, kw_only=True)
class QuadraticDamping(SteppedEffect):
    """A force c₂·v·|v|, as that of an orifice."""

    name = "quadratic_damping"
    block = Block.SPECIMEN
    role = Role.FORCE
    description = "the specimen has damping that grows with the square of the velocity"
    parameters = (
        Parameter(
            name="coefficient_n_s2_per_m2",
            units="N·s²/m²",
            meaning="coefficient of quadratic damping",
            scale=(("force", 1.0), ("velocity", -2.0)),
            signed=True,
            typical=0.5,
            lower=0.0,
            upper=2.0,
            starts=(0.02,),
        ),
    )
    kernel = Kernel(function=_force, linear=0)

    coefficient_n_s2_per_m2: float  # Coefficient c₂ [N·s²/m²]
