"""Viscous damping of the specimen."""

from dataclasses import dataclass
from typing import ClassVar

from reliab.core.vocabulary import Block
from reliab.effects.effect import Parameter, Role, SteppedEffect
from reliab.effects.kernel import Kernel, Numbers


def _force(motion: Numbers, _time: float, _step: float, coefficients: Numbers, _state: Numbers) -> float:
    return coefficients[0] * motion[1]


@dataclass(frozen=True, kw_only=True)
class ViscousDamping(SteppedEffect):
    """A force c·v beyond the specimen's nominal damping."""

    name = "viscous_damping"
    block = Block.SPECIMEN
    role = Role.FORCE
    description = "the specimen has more viscous damping than believed"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            name="damping_n_s_per_m",
            units="N·s/m",
            meaning="damping coefficient",
            scale=(("force", 1.0), ("velocity", -1.0)),
            signed=True,
            typical=0.3,
            lower=-2.0,
            upper=2.0,
            starts=(0.02,),
        ),
    )
    kernel = Kernel(function=_force, linear=0)

    damping_n_s_per_m: float  # Damping coefficient c [N·s/m]
