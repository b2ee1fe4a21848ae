"""The specimen's share of the structure."""

from typing import TYPE_CHECKING

from reliab.assessment.budget.sizes import Equipment
from reliab.assessment.inference.quantities.quantity import Circumstances, Quantity

if TYPE_CHECKING:
    from reliab.assessment.inference.experiment import Experiment

_NONE = 1e-9  # of the stiffness, below which nothing is computed


class SpecimenShare(Quantity):
    """Factor of the specimen's stiffness, damping and mass."""

    name = "experimental_fraction"
    words = "share of the stiffness"
    unit = "%"
    factor = 100.0
    remedy = "Measure the specimen's stiffness, and state the deviation of its share."
    option = "alpha"
    relative = True

    def ordinary(self, circumstances: Circumstances, equipment: Equipment) -> float:
        """Return the standard deviation with ordinary equipment."""
        return equipment.alpha if _is_shared(circumstances) else 0.0

    def apply(self, experiment: "Experiment", value: float, actuator: int) -> None:  # noqa: ARG002
        """Change an experiment."""
        experiment.share *= 1.0 + value


def _is_shared(circumstances: Circumstances) -> bool:
    """Return whether part of the stiffness is computed, so that the specimen's share can be wrong."""
    partition = circumstances.partition
    return bool(abs(partition.numerical_stiffness).max() > _NONE * abs(partition.stiffness).max())


QUANTITY = SpecimenShare()
