"""Mass that moves with the piston."""

from dataclasses import dataclass

from reliab.core.vocabulary import Block
from reliab.effects.effect import Parameter, Role, SteppedEffect
from reliab.effects.kernel import Kernel, Numbers


def _force(motion: Numbers, _time: float, _step: float, coefficients: Numbers, _state: Numbers) -> float:
    return coefficients[0] * motion[2]


@dataclass(frozen=True, kw_only=True)
class AddedMass(SteppedEffect):
    """An inertia force m·a that the load cell measures because a mass moves between it and the specimen."""

    name = "added_mass"
    block = Block.SPECIMEN
    role = Role.FORCE
    description = "the load cell also measures the inertia of a moving mass"
    parameters = (
        Parameter(
            name="mass_kg",
            units="kg",
            meaning="moving mass",
            scale=(("force", 1.0), ("acceleration", -1.0)),
            signed=True,
            typical=0.3,
            lower=-2.0,
            upper=2.0,
            starts=(0.02,),
        ),
    )
    kernel = Kernel(function=_force, linear=0)

    mass_kg: float  # Mass [kg]
