"""The zero of a displacement sensor."""

from typing import TYPE_CHECKING

from reliab.assessment.budget.sizes import Equipment
from reliab.assessment.inference.quantities.quantity import Circumstances, Quantity

if TYPE_CHECKING:
    from reliab.assessment.inference.experiment import Experiment


class SensorOffset(Quantity):
    """Constant part of the readings that the motion does not have."""

    name = "sensor_offset"
    words = "offset of the displacement sensor"
    unit = "mm"
    factor = 1000.0
    remedy = "Record some seconds of rest before the test, which show the sensor's offset."
    per_actuator = True

    def ordinary(self, circumstances: Circumstances, equipment: Equipment) -> float:  # noqa: ARG002
        """Return the standard deviation with ordinary equipment."""
        return float(circumstances.channels.offset_size[circumstances.actuator])

    def apply(self, experiment: "Experiment", value: float, actuator: int) -> None:
        """Change an experiment."""
        experiment.offset[actuator] += value


QUANTITY = SensorOffset()
