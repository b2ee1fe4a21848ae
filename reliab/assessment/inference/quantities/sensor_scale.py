"""The scale of a displacement sensor."""

import math
from typing import TYPE_CHECKING

from reliab.assessment.budget.sizes import Equipment
from reliab.assessment.inference.quantities.prior import Prior, Source
from reliab.assessment.inference.quantities.quantity import Circumstances, Quantity

if TYPE_CHECKING:
    from reliab.assessment.inference.experiment import Experiment


class SensorScale(Quantity):
    """Readings over the motion, relative to the scale of the command."""

    name = "sensor_scale"
    words = "scale of the displacement sensor"
    unit = "%"
    factor = 100.0
    remedy = "Calibrate the displacement sensor and give its `scale`."
    per_actuator = True
    option = "scale"
    relative = True

    def prior(self, circumstances: Circumstances) -> Prior | None:
        """Prior of the scale, with the deviation that is stated of the command's scale."""
        found = super().prior(circumstances)
        of_command = circumstances.stated.get("command_scale")
        if of_command is None or not of_command.deviation:
            return found
        of_sensor = found.deviation if found is not None and found.source is Source.STATED else 0.0
        deviation = math.hypot(of_sensor, of_command.deviation / of_command.value)
        return Prior(deviation=deviation, source=Source.STATED)

    def ordinary(self, circumstances: Circumstances, equipment: Equipment) -> float:  # noqa: ARG002
        """Return the standard deviation with ordinary equipment."""
        return equipment.scale

    def apply(self, experiment: "Experiment", value: float, actuator: int) -> None:
        """Change an experiment."""
        experiment.scale[actuator] *= 1.0 + value


QUANTITY = SensorScale()
