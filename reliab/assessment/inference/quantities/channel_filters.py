"""The filters of two channels."""

from typing import TYPE_CHECKING

from reliab.assessment.budget.sizes import Equipment
from reliab.assessment.inference.quantities.quantity import Circumstances, Quantity

if TYPE_CHECKING:
    from reliab.assessment.inference.experiment import Experiment


class ChannelFilters(Quantity):
    """Delay of the filters that the two channels do not have in common."""

    name = "filter_delay"
    words = "filters of the channels"
    unit = "ms"
    factor = 1000.0
    remedy = "State the filters of both channels, or use the same on both."
    per_actuator = True
    option = "filter_delay"
    option_unit = 1000.0

    def ordinary(self, circumstances: Circumstances, equipment: Equipment) -> float:  # noqa: ARG002
        """Return the standard deviation with ordinary equipment."""
        return equipment.filter_delay_ms / 1000.0

    def apply(self, experiment: "Experiment", value: float, actuator: int) -> None:
        """Change an experiment."""
        experiment.skew[actuator] += value


QUANTITY = ChannelFilters()
