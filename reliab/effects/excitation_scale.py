"""A ground motion played at another scale than recorded."""

from dataclasses import dataclass

from reliab.core.arrays import Array
from reliab.core.vocabulary import Block
from reliab.effects.effect import Parameter, RecordEffect, Role


@dataclass(frozen=True, kw_only=True)
class ExcitationScale(RecordEffect):
    """The ground acceleration that acted was s·a_g, where a_g is the recorded one."""

    name = "excitation_scale"
    block = Block.EXCITATION
    role = Role.RECORD
    description = "the ground motion acted at another scale than recorded"
    parameters = (
        Parameter(
            name="scale",
            units="-",
            meaning="factor on the ground acceleration",
            signed=True,
            neutral=1.0,
            typical=0.2,
            lower=-2.0,
            upper=5.0,
            starts=(1.02,),
        ),
    )

    scale: float  # Factor s [-]

    def applied(self, acceleration: Array, step: float) -> Array:
        """Scaled ground acceleration [m/s²]."""
        del step
        return self.scale * acceleration
