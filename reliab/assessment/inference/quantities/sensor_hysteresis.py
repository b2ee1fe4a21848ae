"""The hysteresis of a displacement sensor."""

from dataclasses import replace
from typing import TYPE_CHECKING

from reliab.assessment.budget.sizes import Equipment
from reliab.assessment.inference.quantities.prior import Prior, Shape, Source
from reliab.assessment.inference.quantities.quantity import Circumstances, Quantity

if TYPE_CHECKING:
    from reliab.assessment.inference.experiment import Experiment

_OF_STATED = 0.2  # of a width that is stated without its deviation, as calibrations find it


class SensorHysteresis(Quantity):
    """Width of the loop of the sensor over the span of its motion."""

    name = "hysteresis"
    words = "hysteresis of the displacement sensor"
    unit = "%"
    factor = 100.0
    remedy = "Measure the sensor's hysteresis by a slow cycle, and state it."
    per_actuator = True
    option = "hysteresis"

    def prior(self, circumstances: Circumstances) -> Prior | None:
        """Prior of the width: positive where none was corrected, since no reading leads."""
        stated = circumstances.stated.get(self.option)
        if stated is not None and stated.value:
            deviation = stated.deviation or _OF_STATED * stated.value
            return Prior(deviation=deviation, source=Source.STATED)
        if stated is not None and not stated.deviation:
            return None  # a calibration found none
        found = super().prior(circumstances)
        return None if found is None else replace(found, shape=Shape.POSITIVE)

    def ordinary(self, circumstances: Circumstances, equipment: Equipment) -> float:  # noqa: ARG002
        """Return the standard deviation with ordinary equipment."""
        return equipment.hysteresis

    def apply(self, experiment: "Experiment", value: float, actuator: int) -> None:
        """Change an experiment."""
        experiment.hysteresis[actuator] += value


QUANTITY = SensorHysteresis()
