"""A sharply yielding part of the specimen, integrated without error."""

from dataclasses import dataclass

from reliab.effects import Kernel, Numbers, Parameter, Role, SteppedEffect
from reliab.vocabulary import Block


def _force(motion: Numbers, _time: float, _step: float, coefficients: Numbers, state: Numbers) -> float:
    # State: last displacement and elastic part, both over the yield displacement.
    displacement = motion[0] / coefficients[1]
    elastic = min(max(state[1] + displacement - state[0], -1.0), 1.0)
    state[0], state[1] = displacement, elastic
    return coefficients[0] * (elastic - displacement)


@dataclass(frozen=True, kw_only=True)
class Elastoplastic(SteppedEffect):
    """A force f·(z − x/d), z following x/d and held between −1 and 1: the spring loses what yields.

    Beside a linear spring k it makes a bilinear spring of stiffness k before and k − f/d after yielding, with
    kinematic hardening. It is the limit of :class:`reliab.effects.hysteresis.Hysteresis` for an infinite
    exponent, where that equation cannot be stepped.

    `force_n`: force f of the part that yields [N]; `displacement_m`: yield displacement d [m].
    """

    name = "elastoplastic"
    block = Block.SPECIMEN
    role = Role.FORCE
    description = "a part of the specimen is elastic and perfectly plastic"
    parameters = (
        Parameter(
            name="force_n",
            units="N",
            meaning="yield force",
            scale=(("force", 1.0),),
            typical=0.5,
            lower=1e-4,
            upper=10.0,
            starts=(0.3,),
        ),
        Parameter(
            name="displacement_m",
            units="m",
            meaning="yield displacement",
            scale=(("displacement", 1.0),),
            typical=0.2,
            lower=1e-4,
            upper=10.0,
            starts=(0.3,),
        ),
    )
    kernel = Kernel(function=_force, states=2)

    force_n: float
    displacement_m: float
