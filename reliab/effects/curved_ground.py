"""A ground acceleration that is curved between its samples; no member of the library."""

from dataclasses import dataclass

import numpy as np

from reliab.core.arrays import Array
from reliab.core.vocabulary import Block
from reliab.effects.effect import Parameter, RecordEffect, Role

CUBIC_SPLINE_ERROR = 1.0 / 12.0
"""Error of a cubic spline's second derivative over the second difference, to first order."""


@dataclass(frozen=True, kw_only=True)
class CurvedGround(RecordEffect):
    """A ground acceleration that is curved between samples where a model takes it for straight.

    The second derivative of the cubic spline through a command that answers the ground is exact where the
    ground is straight between samples, and too large by −δ²/12 of the sampled ground where it is smooth. A
    record that was played with straight lines m times as fine as it was sampled lies in between: 1 − m⁻².
    """

    name = "curved_ground"
    block = Block.NUMERICAL
    role = Role.RECORD
    description = "the ground acceleration is curved between its samples"
    parameters = (
        Parameter(
            name="curvature_between_samples", units="-",
            meaning="share of the curvature of a smooth ground acceleration", signed=True,
            typical=0.5, lower=-1e-9, upper=1.0, starts=(0.0,),
        ),
    )  # fmt: skip

    curvature_between_samples: float  # Share c of that difference, from 0 (straight) to 1 (smooth)

    def applied(self, acceleration: Array, step: float) -> Array:
        """Ground acceleration [m/s²] that makes up for what the spline takes for straight."""
        del step
        corrected_ground = acceleration.copy()
        corrected_ground[1:-1] -= (
            CUBIC_SPLINE_ERROR * self.curvature_between_samples * np.diff(acceleration, 2)
        )
        return corrected_ground
