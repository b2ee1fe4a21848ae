"""Whether the loop felt the sensor's drift."""

from typing import TYPE_CHECKING

from reliab.assessment.inference.quantities.prior import Shape
from reliab.assessment.inference.quantities.quantity import Quantity

if TYPE_CHECKING:
    from reliab.assessment.inference.experiment import Experiment


class OpenDrift(Quantity):
    """Drift of a sensor that the loop may not have felt."""

    name = "open_drift"
    words = "whether the loop felt the sensor's drift"
    unit = "mm"
    factor = 1000.0
    remedy = "Find out whether the controller used this sensor, and correct the recording if it did not."
    per_actuator = True
    shape = Shape.EITHER

    def apply(self, experiment: "Experiment", value: float, actuator: int) -> None:
        """Change an experiment."""
        experiment.drift[actuator] += value


QUANTITY = OpenDrift()
