"""The lag of the fed-back force."""

from typing import TYPE_CHECKING

from reliab.assessment.budget.sizes import Equipment
from reliab.assessment.inference.quantities.quantity import Circumstances, Quantity

if TYPE_CHECKING:
    from reliab.assessment.inference.experiment import Experiment


class FeedbackLag(Quantity):
    """Time by which the force is fed back later than the displacement of the same instant."""

    name = "feedback_lag"
    words = "lag of the fed-back force"
    unit = "ms"
    factor = 1000.0
    remedy = "Measure by how much the force is fed back late, and state it."
    option = "feedback_lag"
    option_unit = 1000.0

    def ordinary(self, circumstances: Circumstances, equipment: Equipment) -> float:  # noqa: ARG002
        """Return the standard deviation with ordinary equipment."""
        return equipment.feedback_lag_ms / 1000.0

    def apply(self, experiment: "Experiment", value: float, actuator: int) -> None:  # noqa: ARG002
        """Change an experiment."""
        experiment.feedback_lag += value


QUANTITY = FeedbackLag()
