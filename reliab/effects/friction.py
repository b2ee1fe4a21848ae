"""Coulomb friction, smooth about zero velocity, and friction that is stronger in one direction."""

import math
from dataclasses import dataclass

from reliab.effects.effect import Parameter, Role, SteppedEffect
from reliab.effects.kernel import Kernel, Numbers
from reliab.vocabulary import Block


def _force(motion: Numbers, _time: float, _step: float, coefficients: Numbers, _state: Numbers) -> float:
    return coefficients[0] * math.tanh(motion[1] / coefficients[1])


@dataclass(frozen=True, kw_only=True)
class CoulombFriction(SteppedEffect):
    """A force F·tanh(v/v_s) that opposes the motion whatever its speed."""

    name = "coulomb_friction"
    block = Block.SPECIMEN
    role = Role.FORCE
    description = "there is dry friction in the specimen"
    parameters = (
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
    kernel = Kernel(function=_force)

    force_n: float  # Friction force F [N]
    # Velocity v_s [m/s] over which the force changes sign; vanishing for ideal friction, and fitted up to 2 %
    # of the peak velocity only: a force that changes more gradually is :class:`PowerLawDamping`, not dry
    # friction
    regularisation_velocity_m_per_s: float


def _directional_force(
    motion: Numbers, _time: float, _step: float, coefficients: Numbers, _state: Numbers
) -> float:
    direction = math.tanh(motion[1] / coefficients[1])
    return coefficients[0] * direction * (1.0 + coefficients[2] * direction)


@dataclass(frozen=True, kw_only=True)
class DirectionalFriction(SteppedEffect):
    """A force F·s·(1 + a·s) with s = tanh(v/v_s): F(1 + a) forwards and F(1 − a) backwards."""

    name = "directional_friction"
    block = Block.SPECIMEN
    role = Role.FORCE
    description = "dry friction in the specimen is stronger in one direction than in the other"
    refines = CoulombFriction
    parameters = (
        *CoulombFriction.parameters,
        Parameter(
            name="asymmetry",
            units="-",
            meaning="half the difference of both directions over their mean",
            signed=True,
            typical=0.3,
            lower=-1.0,
            upper=1.0,
            starts=(0.05, -0.05),
        ),
    )
    kernel = Kernel(function=_directional_force)

    force_n: float  # Mean friction force F of both directions [N]
    regularisation_velocity_m_per_s: float  # Velocity v_s [m/s] over which the force changes sign
    asymmetry: float = 0.0  # a [-], half the difference of both directions over their mean, between −1 and 1
