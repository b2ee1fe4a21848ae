"""Inverse compensation of Chen and Ricles."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.effects.kernel import Kernel, Numbers
from reliab.simulation.hybrid_test.closed_loop import Compensator


def _compensate(motion: Numbers, _time: float, _step: float, coefficients: Numbers, state: Numbers) -> float:
    alpha = coefficients[0]
    for row in range(3):
        now = motion[row]
        motion[row] = alpha * now - (alpha - 1.0) * state[row]
        state[row] = now
    return 0.0


@dataclass(frozen=True, kw_only=True)
class InverseCompensation(Compensator):
    """Sends x_p = α_es x − (α_es − 1)x₋, the inverse of an actuator that moves 1/α of its way each step.

    The command is sent one step before it is due; an actuator that takes α steps from then on is
    compensated to first order when α_es = α, and otherwise keeps a delay of about (α − α_es) steps.

    Chen, C. and Ricles, J. M. (2009). Analysis of actuator delay compensation methods for real-time
    testing. *Eng. Struct.* 31(11), 2643–2655.
    """

    kernel: ClassVar[Kernel] = Kernel(function=_compensate, states=3)
    name: ClassVar[str] = "inverse"

    steps: float  # Estimated delay α_es [steps], at least 1

    def __post_init__(self) -> None:
        if not (math.isfinite(self.steps) and self.steps >= 1.0):
            raise InputError(
                "The estimated delay of inverse compensation must be at least one step",
                value=self.steps,
                remedy="Give the actuator's delay in sampling steps, counted from when the command is sent",
            )

    def coefficients(self, step: float) -> Array:  # noqa: ARG002 - a number of steps
        """Return the estimated delay in steps."""
        return np.array([self.steps])
