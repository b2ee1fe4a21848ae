"""The error of a test whose record begins in motion."""

from typing import TYPE_CHECKING

from reliab.assessment.budget.sizes import Equipment
from reliab.assessment.inference.quantities.quantity import Circumstances, Quantity

if TYPE_CHECKING:
    from reliab.assessment.inference.experiment import Experiment

_REMEDY = "Record from rest: the error at the first sample is not known."


class InitialDisplacement(Quantity):
    """Error of the command at the first sample."""

    name = "initial_state"
    words = "motion before the record"
    unit = "mm"
    factor = 1000.0
    remedy = _REMEDY

    def ordinary(self, circumstances: Circumstances, equipment: Equipment) -> float:  # noqa: ARG002
        """Return the standard deviation with ordinary equipment."""
        return circumstances.channels.initial_size

    def apply(self, experiment: "Experiment", value: float, actuator: int) -> None:  # noqa: ARG002
        """Change an experiment."""
        experiment.initial_displacement += value


class InitialVelocity(InitialDisplacement):
    """Rate of the same, over the lowest natural frequency."""

    name = "initial_velocity"

    def apply(self, experiment: "Experiment", value: float, actuator: int) -> None:  # noqa: ARG002
        """Change an experiment."""
        experiment.initial_velocity += value


QUANTITY = (InitialDisplacement(), InitialVelocity())
