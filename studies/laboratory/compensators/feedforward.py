"""First-order feedforward."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.effects.kernel import Kernel, Numbers
from reliab.simulation.hybrid_test.closed_loop import Compensator


def _compensate(motion: Numbers, _time: float, _step: float, coefficients: Numbers, _state: Numbers) -> float:
    motion[0] += coefficients[0] * motion[1]
    motion[1] += coefficients[0] * motion[2]
    return 0.0


@dataclass(frozen=True, kw_only=True)
class Feedforward(Compensator):
    """Sends x + Tv, the inverse of a first-order lag and, to first order, of a delay T.

    Jung, R.-Y. and Shing, P. B. (2006). Performance evaluation of a real-time pseudodynamic test
    system. *Earthquake Eng. Struct. Dyn.* 35(7), 789–810.
    """

    kernel: ClassVar[Kernel] = Kernel(function=_compensate)
    name: ClassVar[str] = "feedforward"

    time: float  # Time constant or delay T [s], not negative

    def __post_init__(self) -> None:
        if not (math.isfinite(self.time) and self.time >= 0.0):
            raise InputError(
                "The time constant of feedforward must be finite and not negative",
                value=f"{self.time} s",
                remedy="Give the actuator's delay in seconds",
            )

    def coefficients(self, step: float) -> Array:  # noqa: ARG002 - in seconds
        """Return the time constant [s]."""
        return np.array([self.time])
