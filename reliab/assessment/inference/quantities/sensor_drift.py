"""The drift of a displacement sensor."""

from typing import TYPE_CHECKING

from reliab.assessment.budget.sizes import Equipment
from reliab.assessment.inference.quantities.quantity import Circumstances, Quantity

if TYPE_CHECKING:
    from reliab.assessment.inference.experiment import Experiment


class SensorDrift(Quantity):
    """Rise of the readings over the test that the motion does not have."""

    name = "sensor_drift"
    words = "drift of the displacement sensor"
    unit = "mm"
    factor = 1000.0
    remedy = "Record rest before and after the test, which shows the sensor's drift."
    per_actuator = True

    def ordinary(self, circumstances: Circumstances, equipment: Equipment) -> float:  # noqa: ARG002
        """Return the standard deviation with ordinary equipment."""
        return float(circumstances.channels.drift_size[circumstances.actuator])

    def apply(self, experiment: "Experiment", value: float, actuator: int) -> None:
        """Change an experiment."""
        experiment.drift[actuator] += value


QUANTITY = SensorDrift()
