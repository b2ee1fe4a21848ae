"""Parts of a structure that a user states with tolerances: floors, storeys, modes, entries of matrices."""

from typing import TYPE_CHECKING

from reliab.assessment.budget.sizes import Equipment
from reliab.assessment.inference.quantities.prior import Prior, Source
from reliab.assessment.inference.quantities.quantity import Circumstances, Quantity

if TYPE_CHECKING:
    from reliab.assessment.inference.experiment import Experiment


class StructurePart(Quantity):
    """Relative change of one part of a structure."""

    words = ""
    unit = "%"
    factor = 100.0
    remedy = ""
    attainable = 0.002

    def __init__(self, name: str) -> None:
        self.name = name  # type: ignore[misc]  # of each part its own

    def prior(self, circumstances: Circumstances) -> Prior | None:
        """Prior of the part, as its tolerance says."""
        return Prior(deviation=circumstances.tolerances[self.name], source=Source.STATED)

    def ordinary(self, circumstances: Circumstances, equipment: Equipment) -> float:  # noqa: ARG002
        """Return zero: what is not stated of a part is not assumed."""
        return 0.0

    def apply(self, experiment: "Experiment", value: float, actuator: int) -> None:  # noqa: ARG002
        """Change an experiment."""
        experiment.parts[self.name] = experiment.parts.get(self.name, 0.0) + value
