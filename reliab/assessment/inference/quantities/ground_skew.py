"""The skew of the recorded ground acceleration."""

from typing import TYPE_CHECKING

from reliab.assessment.budget.sizes import Equipment
from reliab.assessment.inference.quantities.quantity import Circumstances, Quantity, clock_deviation

if TYPE_CHECKING:
    from reliab.assessment.inference.experiment import Experiment


class GroundSkew(Quantity):
    """Time by which it was recorded later than the command."""

    name = "ground_skew"
    words = "skew of the ground acceleration"
    unit = "ms"
    factor = 1000.0
    remedy = "Record the ground acceleration at the same instants as the command."

    def ordinary(self, circumstances: Circumstances, equipment: Equipment) -> float:
        """Return the standard deviation with ordinary equipment."""
        return clock_deviation(circumstances, equipment) if circumstances.channels.ground is not None else 0.0

    def apply(self, experiment: "Experiment", value: float, actuator: int) -> None:  # noqa: ARG002
        """Change an experiment."""
        experiment.ground_skew += value


QUANTITY = GroundSkew()
