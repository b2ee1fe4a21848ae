"""The damping ratios of the structure."""

from typing import TYPE_CHECKING

from reliab.assessment.budget.sizes import Equipment
from reliab.assessment.inference.quantities.prior import Shape
from reliab.assessment.inference.quantities.quantity import Circumstances, Quantity

if TYPE_CHECKING:
    from reliab.assessment.inference.experiment import Experiment


class DampingRatio(Quantity):
    """Common factor of all damping ratios."""

    name = "damping_ratio"
    words = "damping ratio"
    unit = "%"
    factor = 100.0
    remedy = "Measure the damping ratio in a free vibration, and state its standard deviation."
    shape = Shape.LOGNORMAL
    option = "xi"
    relative = True

    def ordinary(self, circumstances: Circumstances, equipment: Equipment) -> float:  # noqa: ARG002
        """Return the standard deviation with ordinary equipment."""
        return equipment.xi

    def apply(self, experiment: "Experiment", value: float, actuator: int) -> None:  # noqa: ARG002
        """Change an experiment."""
        experiment.damping_ratio *= 1.0 + value


QUANTITY = DampingRatio()
