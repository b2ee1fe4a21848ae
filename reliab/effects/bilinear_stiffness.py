"""A spring that is softer beyond a displacement, and returns on its way."""

import math
from dataclasses import dataclass
from typing import ClassVar

from reliab.core.vocabulary import Block
from reliab.effects.effect import Parameter, Role, SteppedEffect
from reliab.effects.kernel import Kernel, Numbers


def _force(motion: Numbers, _time: float, _step: float, coefficients: Numbers, _state: Numbers) -> float:
    # 1 + |u|ⁿ is taken over the larger of its parts, so that no exponent takes it out of its range.
    place, exponent = motion[0] / coefficients[1], coefficients[2]
    unit = max(1.0, abs(place))
    ratio = math.pow(min(1.0, abs(place)) / unit, exponent)
    return coefficients[0] * place * (math.pow(1.0 + ratio, -1.0 / exponent) / unit - 1.0)


@dataclass(frozen=True, kw_only=True)
class BilinearStiffness(SteppedEffect):
    """A force f·(b(x/d) − x/d): the spring bends at a force f, where b(u) = u/(1 + |u|ⁿ)^(1/n).

    Small motions have the stiffness of the spring, large ones one that is less by f/d, as where a rocking
    wall or a prestressed joint opens. The curve is that of Richard and Abbott (1975, Journal of the
    Engineering Mechanics Division 101, 511).
    """

    name = "bilinear_stiffness"
    block = Block.SPECIMEN
    role = Role.FORCE
    description = "the specimen's spring is softer beyond a displacement, and returns on its way"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            name="force_n",
            units="N",
            meaning="force at which the spring bends",
            scale=(("force", 1.0),),
            signed=True,
            typical=0.5,
            lower=0.0,
            upper=20.0,
            starts=(0.05, 0.05, 0.05),
        ),
        Parameter(
            name="displacement_m",
            units="m",
            meaning="displacement at which it bends",
            scale=(("displacement", 1.0),),
            typical=0.3,
            lower=5e-3,
            upper=2.0,
            starts=(0.1, 0.25, 0.5),
        ),
        Parameter(
            name="exponent",
            units="-",
            meaning="sharpness of the bend",
            typical=5.0,
            spread=0.8,
            lower=1.0,
            upper=25.0,
            starts=(5.0, 5.0, 5.0),
        ),
    )
    kernel = Kernel(function=_force, linear=0, by_path=True)

    force_n: float  # Force f at which the spring bends [N]
    displacement_m: float  # Displacement d at which it bends [m]
    exponent: float = 5.0  # Sharpness n [-] of the bend
