"""The skew between two channels."""

from typing import TYPE_CHECKING

from reliab.assessment.budget.sizes import Equipment
from reliab.assessment.inference.quantities.quantity import Circumstances, Quantity

if TYPE_CHECKING:
    from reliab.assessment.inference.experiment import Experiment


class ChannelSkew(Quantity):
    """Time by which the measured displacement was recorded later than the command."""

    name = "time_shift"
    words = "skew of the channels"
    unit = "ms"
    factor = 1000.0
    remedy = "Feed one signal to both channels (`reliab calibrate`) and give the `skew`."
    per_actuator = True
    option = "skew"
    option_unit = 1000.0

    def ordinary(self, circumstances: Circumstances, equipment: Equipment) -> float:
        """Return the standard deviation with ordinary equipment."""
        return equipment.skew(circumstances.channels.band.record_step)

    def apply(self, experiment: "Experiment", value: float, actuator: int) -> None:
        """Change an experiment."""
        experiment.skew[actuator] += value


QUANTITY = ChannelSkew()
