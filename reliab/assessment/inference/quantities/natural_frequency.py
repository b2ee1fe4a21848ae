"""The natural frequencies of the structure."""

from typing import TYPE_CHECKING

from reliab.assessment.budget.sizes import Equipment
from reliab.assessment.inference.quantities.prior import Shape
from reliab.assessment.inference.quantities.quantity import Circumstances, Quantity

if TYPE_CHECKING:
    from reliab.assessment.inference.experiment import Experiment


class NaturalFrequency(Quantity):
    """Common factor of all natural frequencies."""

    name = "frequency"
    words = "natural frequency"
    unit = "%"
    factor = 100.0
    remedy = "Measure the natural frequency in a free vibration, and state its standard deviation."
    shape = Shape.LOGNORMAL
    option = "f"
    relative = True

    def ordinary(self, circumstances: Circumstances, equipment: Equipment) -> float:  # noqa: ARG002
        """Return the standard deviation with ordinary equipment."""
        return equipment.f

    def apply(self, experiment: "Experiment", value: float, actuator: int) -> None:  # noqa: ARG002
        """Change an experiment."""
        experiment.frequency *= 1.0 + value


QUANTITY = NaturalFrequency()
