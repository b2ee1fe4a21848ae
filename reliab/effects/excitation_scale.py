"""A ground motion played at another scale than recorded."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reliab.effects.effect import RecordEffect, Role
from reliab.effects.parameter import Parameter
from reliab.vocabulary import Block


@dataclass(frozen=True, kw_only=True)
class ExcitationScale(RecordEffect):
    """The ground acceleration that acted was s·a_g, where a_g is the recorded one.

    Parameters
    ----------
    scale : float
        Factor s [-].
    """

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

    scale: float

    def applied(self, acceleration: NDArray[np.float64], step: float) -> NDArray[np.float64]:
        """Scaled ground acceleration [m/s²]."""
        del step
        return self.scale * acceleration
