"""The scale of the recorded force over the mass."""

from typing import TYPE_CHECKING

from reliab.assessment.budget.sizes import Equipment
from reliab.assessment.inference.quantities.quantity import Circumstances, Quantity

if TYPE_CHECKING:
    from reliab.assessment.inference.experiment import Experiment


class ForceScale(Quantity):
    """Recorded force over the true one, for the stated mass."""

    name = "mass"
    words = "mass of the structure and scale of the load cell"
    unit = "%"
    factor = 100.0
    remedy = "Calibrate the load cell, and state mass and force to a smaller deviation."
    option = "mass"
    relative = True

    def ordinary(self, circumstances: Circumstances, equipment: Equipment) -> float:
        """Return the standard deviation with ordinary equipment."""
        return equipment.force_scale if circumstances.specimen_force else 0.0

    def apply(self, experiment: "Experiment", value: float, actuator: int) -> None:  # noqa: ARG002
        """Change an experiment."""
        experiment.force_scale *= 1.0 + value


QUANTITY = ForceScale()
