"""Drift of the actuator's delay over a test, τ(t) = τ₀ + r·t."""

from dataclasses import dataclass

from reliab.core.vocabulary import Block
from reliab.effects.effect import Parameter, Role, SteppedEffect
from reliab.effects.kernel import Kernel, Numbers


def _delay(_motion: Numbers, time: float, _step: float, coefficients: Numbers, _state: Numbers) -> float:
    return coefficients[0] * time


@dataclass(frozen=True, kw_only=True)
class DelayDrift(SteppedEffect):
    """A delay that grows in proportion to the time since the start of the test."""

    name = "delay_drift"
    block = Block.ACTUATOR
    role = Role.DELAY
    description = "the actuator's delay drifts during the test"
    parameters = (
        Parameter(
            name="delay_rate_s_per_s",
            units="s/s",
            meaning="growth of the delay",
            scale=(("displacement", 1.0), ("velocity", -1.0), ("duration", -1.0)),
            signed=True,
            typical=0.3,
            lower=-2.0,
            upper=2.0,
            starts=(0.01,),
        ),
    )
    kernel = Kernel(function=_delay)

    delay_rate_s_per_s: float  # Growth r of the delay [s/s]
