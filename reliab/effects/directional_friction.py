"""Coulomb friction that is stronger in one direction than in the other."""

import math
from dataclasses import dataclass

from reliab.effects.coulomb_friction import CoulombFriction
from reliab.effects.effect import Parameter
from reliab.effects.kernel import Kernel, Numbers


def _force(motion: Numbers, _time: float, _step: float, coefficients: Numbers, _state: Numbers) -> float:
    direction = math.tanh(motion[1] / coefficients[1])
    return coefficients[0] * direction * (1.0 + coefficients[2] * direction)


@dataclass(frozen=True, kw_only=True)
class DirectionalFriction(CoulombFriction):
    """A force F·s·(1 + a·s) with s = tanh(v/v_s): F(1 + a) forwards and F(1 − a) backwards."""

    name = "directional_friction"
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
    kernel = Kernel(function=_force, linear=0)

    # `force_n` is the mean friction force F of both directions [N]
    asymmetry: float = 0.0  # a [-], half the difference of both directions over their mean, between −1 and 1
