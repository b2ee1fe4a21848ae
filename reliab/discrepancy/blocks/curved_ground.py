"""Course of the ground acceleration between its samples, which no recording shows."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reliab.discrepancy.blocks.calibration import Calibration
from reliab.effects import Parameter, RecordEffect, Role
from reliab.vocabulary import Block

_PER_SECOND_DIFFERENCE = 1.0 / 12.0  # of the second derivative of a cubic spline, to first order


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
            name="curvature_between_samples",
            units="-",
            meaning="share of the curvature of a smooth ground acceleration",
            signed=True,
            typical=0.5,
            lower=-1e-9,
            upper=1.0,
            starts=(0.0,),
        ),
    )

    curvature_between_samples: float  # Share c of that difference, from 0 (straight) to 1 (smooth)

    def applied(self, acceleration: NDArray[np.float64], step: float) -> NDArray[np.float64]:
        """Ground acceleration [m/s²] that makes up for what the spline takes for straight."""
        del step
        changed = acceleration.copy()
        share = _PER_SECOND_DIFFERENCE * self.curvature_between_samples
        changed[1:-1] -= share * np.diff(acceleration, 2)
        return changed


def curvature_between_samples() -> Calibration:
    """Share of the curvature of a smooth ground acceleration between its samples."""
    return Calibration(
        parameter=CurvedGround.parameters[0],
        nominal=lambda _model: 0.0,
        apply=lambda model, value: model.adding(CurvedGround(curvature_between_samples=max(value, 0.0))),
    )
