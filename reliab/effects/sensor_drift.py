"""Drift of the displacement sensor's zero."""

from dataclasses import dataclass

from reliab.core.vocabulary import Block
from reliab.effects.effect import Parameter, Role, SteppedEffect
from reliab.effects.kernel import Kernel, Numbers


def _reading(_motion: Numbers, time: float, _step: float, coefficients: Numbers, _state: Numbers) -> float:
    return coefficients[0] * time


@dataclass(frozen=True, kw_only=True)
class SensorDrift(SteppedEffect):
    """A displacement sensor whose zero moves in proportion to the time since the start of the test."""

    name = "sensor_drift"
    block = Block.SENSOR
    role = Role.DISPLACEMENT_READING
    description = "the zero of the displacement sensor drifts"
    parameters = (
        Parameter(
            name="drift_m_per_s",
            units="m/s",
            meaning="rate of the drift",
            scale=(("displacement", 1.0), ("duration", -1.0)),
            signed=True,
            typical=0.5,
            lower=-10.0,
            upper=10.0,
            starts=(0.05,),
        ),
    )
    kernel = Kernel(function=_reading)

    drift_m_per_s: float  # Rate of the drift [m/s]
