"""The scale of the recorded ground acceleration."""

from typing import TYPE_CHECKING

from reliab.assessment.budget.sizes import Equipment
from reliab.assessment.inference.quantities.quantity import Circumstances, Quantity

if TYPE_CHECKING:
    from reliab.assessment.inference.experiment import Experiment


class GroundScale(Quantity):
    """Recorded ground acceleration over the one that the computer applied."""

    name = "ground_scale"
    words = "scale of the ground acceleration"
    unit = "%"
    factor = 100.0
    remedy = "Record the ground acceleration that the computer applied."

    def ordinary(self, circumstances: Circumstances, equipment: Equipment) -> float:
        """Return the standard deviation with ordinary equipment."""
        return equipment.ground_scale if circumstances.channels.ground is not None else 0.0

    def apply(self, experiment: "Experiment", value: float, actuator: int) -> None:  # noqa: ARG002
        """Change an experiment."""
        experiment.ground_scale *= 1.0 + value


QUANTITY = GroundScale()
