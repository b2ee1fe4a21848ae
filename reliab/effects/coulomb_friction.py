"""Coulomb friction, smooth about zero velocity."""

import math
from dataclasses import dataclass
from typing import ClassVar

from reliab.core.vocabulary import Block
from reliab.effects.effect import Parameter, Role, SteppedEffect
from reliab.effects.kernel import Kernel, Numbers


def _force(motion: Numbers, _time: float, _step: float, coefficients: Numbers, _state: Numbers) -> float:
    return coefficients[0] * math.tanh(motion[1] / coefficients[1])


@dataclass(frozen=True, kw_only=True)
class CoulombFriction(SteppedEffect):
    """A force F·tanh(v/v_s) that opposes the motion whatever its speed."""

    name = "coulomb_friction"
    block = Block.SPECIMEN
    role = Role.FORCE
    description = "there is dry friction in the specimen"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            name="force_n",
            units="N",
            meaning="friction force",
            scale=(("force", 1.0),),
            signed=True,
            typical=0.2,
            lower=0.0,
            upper=1.0,
            starts=(0.01,),
        ),
        Parameter(
            name="regularisation_velocity_m_per_s",
            units="m/s",
            meaning="velocity over which friction changes sign",
            scale=(("velocity", 1.0),),
            typical=0.003,
            spread=1.5,
            lower=2e-4,
            upper=0.02,
            starts=(0.003, 0.003),
        ),
    )
    kernel = Kernel(function=_force, linear=0)

    force_n: float  # Friction force F [N]
    # Velocity v_s [m/s] over which the force changes sign; vanishing for ideal friction, and fitted up to 2 %
    # of the peak velocity only: a force that changes more gradually is :class:`PowerLawDamping`, not dry
    # friction
    regularisation_velocity_m_per_s: float
