"""Whether the command passed the filter of the measured displacement."""

from typing import TYPE_CHECKING

from reliab.assessment.inference.quantities.prior import Shape
from reliab.assessment.inference.quantities.quantity import Quantity

if TYPE_CHECKING:
    from reliab.assessment.inference.experiment import Experiment


class OpenFilter(Quantity):
    """Delay of a filter of the measured displacement that the command may have passed, too."""

    name = "open_filter"
    words = "whether the command passed the filter of the measured displacement"
    unit = "ms"
    factor = 1000.0
    remedy = "State the filters of both channels, or use the same on both."
    per_actuator = True
    shape = Shape.EITHER

    def apply(self, experiment: "Experiment", value: float, actuator: int) -> None:
        """Change an experiment."""
        experiment.skew[actuator] += value


QUANTITY = OpenFilter()
