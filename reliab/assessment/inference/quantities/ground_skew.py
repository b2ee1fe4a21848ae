"""The skew of the recorded ground acceleration."""

from typing import TYPE_CHECKING

import numpy as np

from reliab.assessment.budget.sizes import Equipment
from reliab.assessment.inference.quantities.quantity import Circumstances, Quantity

if TYPE_CHECKING:
    from reliab.assessment.inference.experiment import Experiment


class GroundSkew(Quantity):
    """Time by which it was recorded later than the command."""

    name = "ground_skew"
    words = "skew of the ground acceleration"
    unit = "ms"
    factor = 1000.0
    remedy = "Record the ground acceleration at the same instants as the command."
    attainable = 2e-5

    def ordinary(self, circumstances: Circumstances, equipment: Equipment) -> float:
        """Return the standard deviation with ordinary equipment."""
        if circumstances.channels.ground is None:
            return 0.0
        return float(
            np.hypot(
                equipment.skew(circumstances.channels.band.record_step), equipment.filter_delay_ms / 1000.0
            )
        )

    def apply(self, experiment: "Experiment", value: float, actuator: int) -> None:  # noqa: ARG002
        """Change an experiment."""
        experiment.ground_skew += value


QUANTITY = GroundSkew()
