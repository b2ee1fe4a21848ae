"""The error of the numerical integration."""

from typing import TYPE_CHECKING

from reliab.assessment.budget.sizes import Equipment
from reliab.assessment.inference.quantities.quantity import Circumstances, Quantity

if TYPE_CHECKING:
    from reliab.assessment.inference.experiment import Experiment


class Integration(Quantity):
    """Error of the computer's time stepping, over (ω·step)² of the specimen's force."""

    name = "integration"
    words = "numerical integration"
    unit = ""
    factor = 1.0
    remedy = "Compute the numerical part in smaller steps."

    def ordinary(self, circumstances: Circumstances, equipment: Equipment) -> float:
        """Return the standard deviation with ordinary equipment."""
        return equipment.integration if circumstances.channels.ground is not None else 0.0

    def apply(self, experiment: "Experiment", value: float, actuator: int) -> None:  # noqa: ARG002
        """Change an experiment."""
        experiment.integration += value


QUANTITY = Integration()
