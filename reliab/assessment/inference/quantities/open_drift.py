"""Whether the loop felt the sensor's drift."""

from typing import TYPE_CHECKING

from reliab.assessment.budget.sizes import Equipment
from reliab.assessment.inference.quantities.prior import Shape
from reliab.assessment.inference.quantities.quantity import Circumstances, Quantity

if TYPE_CHECKING:
    from reliab.assessment.inference.experiment import Experiment


class OpenDrift(Quantity):
    """Drift of a sensor that the loop may not have felt."""

    name = "open_drift"
    words = "whether the loop felt the sensor's drift"
    unit = "mm"
    factor = 1000.0
    remedy = "Find out whether the controller used this sensor, and correct the recording if it did not."
    attainable = 1e-5
    shape = Shape.EITHER

    def ordinary(self, circumstances: Circumstances, equipment: Equipment) -> float:  # noqa: ARG002
        """Return zero: faults of the channels say where it plays a part."""
        return 0.0

    def apply(self, experiment: "Experiment", value: float, actuator: int) -> None:
        """Change an experiment."""
        experiment.drift[actuator] += value


QUANTITY = OpenDrift()
