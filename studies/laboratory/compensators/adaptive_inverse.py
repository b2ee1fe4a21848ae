"""Adaptive inverse compensation of Chen and Ricles, controlled by the tracking indicator."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.effects.kernel import Kernel, Numbers
from reliab.simulation.hybrid_test.closed_loop import Compensator


def _compensate(
    motion: Numbers, measured: float, step: float, coefficients: Numbers, state: Numbers
) -> float:
    # State: last target, measurement that belongs to it, tracking indicator, its integral, then the last
    # displacement and velocity that were sent.
    x = motion[0]
    area = 0.5 * (x + state[0]) * (measured - state[1]) - 0.5 * (measured + state[1]) * (x - state[0])
    state[2] += 0.5 * area
    state[3] += step * state[2]
    steps = max(coefficients[0] + coefficients[1] * state[2] + coefficients[2] * state[3], 1.0)
    sent = steps * x - (steps - 1.0) * state[0]
    state[0], state[1] = x, measured
    velocity = (sent - state[4]) / step
    motion[2] = (velocity - state[5]) / step
    motion[0], motion[1] = sent, velocity
    state[4], state[5] = sent, velocity
    return 0.0


@dataclass(frozen=True, kw_only=True)
class AdaptiveInverse(Compensator):
    """Inverse compensation x_p = αx − (α − 1)x₋ whose α = α_es + k_p·TI + k_i∫TI dt follows the test.

    TI is half of the area that the trace of measured over command displacement has enclosed, positive while
    the measurement lags.

    Chen, C. and Ricles, J. M. (2010). Tracking error-based servohydraulic actuator adaptive compensation for
    real-time hybrid simulation. *J. Struct. Eng.* 136(4), 432-440.

    Without gains it is inverse compensation:

    >>> inverse = AdaptiveInverse(steps=4.0, proportional=0.0, integral=0.0)
    >>> state, motion = np.zeros(inverse.kernel.states), np.array([0.1, 0.0, 0.0])
    >>> _ = inverse.kernel(motion, 0.0, 0.001, inverse.coefficients(0.001), state)
    >>> round(float(motion[0]), 3)
    0.4
    """

    kernel: ClassVar[Kernel] = Kernel(function=_compensate, states=6)
    name: ClassVar[str] = "adaptive_inverse"

    steps: float  # Estimated delay α_es [steps], at least 1
    proportional: float = 4e5  # k_p [1/m²]
    integral: float = 4e4  # k_i [1/(m²·s)]

    def __post_init__(self) -> None:
        if not (math.isfinite(self.steps) and self.steps >= 1.0):
            raise InputError(
                "The estimated delay of inverse compensation must be at least one step",
                value=self.steps,
                remedy="Give the actuator's delay in sampling steps, counted from when the command is sent",
            )
        for field in ("proportional", "integral"):
            if not (math.isfinite(getattr(self, field)) and getattr(self, field) >= 0.0):
                raise InputError(
                    f"The {field} gain of adaptive inverse compensation must not be negative",
                    value=getattr(self, field),
                )

    def coefficients(self, step: float) -> Array:  # noqa: ARG002 - in steps
        """Estimated delay in steps and the two gains."""
        return np.array([self.steps, self.proportional, self.integral])
