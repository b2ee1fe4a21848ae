"""A damper whose force grows with a power of the velocity below one."""

import math
from dataclasses import dataclass
from typing import ClassVar

from reliab.core.vocabulary import Block
from reliab.effects.coulomb_friction import CoulombFriction
from reliab.effects.effect import Effect, Parameter, Role, SteppedEffect
from reliab.effects.kernel import Kernel, Numbers
from reliab.effects.viscous_damping import ViscousDamping


def _force(motion: Numbers, _time: float, _step: float, coefficients: Numbers, _state: Numbers) -> float:
    # |v|^p is written as (v² + ε²)^((p − 1)/2)·v, finite in its slope about zero.
    v = motion[1]
    return coefficients[0] * v * math.pow(v * v + 1e-18, 0.5 * (coefficients[1] - 1.0))


@dataclass(frozen=True, kw_only=True)
class PowerLawDamping(SteppedEffect):
    """A force c·sgn(v)·|v|ᵖ with p below one: shear thinning, between dry friction and a linear damper."""

    name = "power_law_damping"
    block = Block.SPECIMEN
    role = Role.FORCE
    description = "the specimen has a damper whose force grows with a power of the velocity below one"
    limiting_cases: ClassVar[tuple[type[Effect], ...]] = (CoulombFriction, ViscousDamping)
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            name="coefficient",
            units="N·(s/m)^p",
            meaning="force of the damper at 1 m/s",
            scale=(("force", 1.0), ("velocity", -0.5)),
            signed=True,
            typical=0.3,
            lower=0.0,
            upper=5.0,
            starts=(0.02, 0.02),
        ),
        Parameter(
            name="exponent",
            units="-",
            meaning="power of the velocity",
            typical=0.45,
            spread=0.5,
            lower=0.1,
            upper=0.9,
            starts=(0.3, 0.6),
        ),
    )
    kernel = Kernel(function=_force, linear=0)

    coefficient: float  # c [N·(s/m)ᵖ], the force at 1 m/s
    exponent: float  # p [-], between 0.1 and 0.9
