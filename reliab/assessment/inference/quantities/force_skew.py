"""The skew of the recorded force."""

from typing import TYPE_CHECKING

from reliab.assessment.budget.sizes import Equipment
from reliab.assessment.inference.quantities.quantity import Circumstances, Quantity, clock_deviation

if TYPE_CHECKING:
    from reliab.assessment.inference.experiment import Experiment


class ForceSkew(Quantity):
    """Time by which the force was recorded later than the command."""

    name = "force_lag"
    words = "lag of the recorded force"
    unit = "ms"
    factor = 1000.0
    remedy = "Measure by how much the force is recorded late, and state it."
    option = "force_lag"
    option_unit = 1000.0

    def ordinary(self, circumstances: Circumstances, equipment: Equipment) -> float:
        """Return the standard deviation with ordinary equipment."""
        return clock_deviation(circumstances, equipment) if circumstances.specimen_force else 0.0

    def apply(self, experiment: "Experiment", value: float, actuator: int) -> None:  # noqa: ARG002
        """Change an experiment."""
        experiment.force_skew += value


QUANTITY = ForceSkew()
