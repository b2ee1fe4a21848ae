"""Inverse of an identified model of the actuator, by differences of the command."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.effects.kernel import Kernel, Numbers
from reliab.simulation.hybrid_test.closed_loop import Compensator

_HIGHEST_ORDER = 3


def _compensate(
    motion: Numbers, _measured: float, step: float, coefficients: Numbers, state: Numbers
) -> float:
    # State: the last three targets, then the last displacement and velocity that were sent.
    x = motion[0]
    first = (x - state[0]) / step
    second = (x - 2.0 * state[0] + state[1]) / (step * step)
    third = (x - 3.0 * state[0] + 3.0 * state[1] - state[2]) / (step * step * step)
    sent = coefficients[0] * x + coefficients[1] * first + coefficients[2] * second + coefficients[3] * third
    state[2], state[1], state[0] = state[1], state[0], x
    velocity = (sent - state[3]) / step
    motion[2] = (velocity - state[4]) / step
    motion[0], motion[1] = sent, velocity
    state[3], state[4] = sent, velocity
    return 0.0


@dataclass(frozen=True, kw_only=True)
class ModelInverse(Compensator):
    """Sends a₀x + a₁Dx + a₂D²x + a₃D³x, the inverse of an actuator 1/(a₀ + a₁s + a₂s² + a₃s³).

    D is the backward difference over one sampling step.

    Phillips, B. M. and Spencer, B. F. (2013). Model-based feedforward-feedback actuator control for real-time
    hybrid simulation. *J. Struct. Eng.* 139(7), 1205-1214.

    A ramp before a first-order lag of 4 ms is sent 4 ms ahead:

    >>> inverse = ModelInverse(factors=(1.0, 0.004))
    >>> state, sent = np.zeros(inverse.kernel.states), []
    >>> for place in (0.0, 0.1, 0.2):
    ...     motion = np.array([place, 100.0, 0.0])
    ...     _ = inverse.kernel(motion, 0.0, 0.001, inverse.coefficients(0.001), state)
    ...     sent.append(round(float(motion[0]), 3))
    >>> sent
    [0.0, 0.5, 0.6]
    """

    kernel: ClassVar[Kernel] = Kernel(function=_compensate, states=5)
    name: ClassVar[str] = "model_inverse"

    factors: tuple[float, ...]  # a₀ [-], a₁ [s], a₂ [s²], a₃ [s³]; one to four of them

    def __post_init__(self) -> None:
        sound = 1 <= len(self.factors) <= _HIGHEST_ORDER + 1 and all(map(math.isfinite, self.factors))
        if not sound or self.factors[0] <= 0.0:
            raise InputError(
                "An inverse needs one to four finite factors, of which the first is positive",
                value=list(self.factors),
                remedy="Give a₀ [-], a₁ [s], a₂ [s²] and a₃ [s³] of the actuator's 1/(a₀ + a₁s + …)",
            )

    def coefficients(self, step: float) -> Array:  # noqa: ARG002 - factors hold for any step
        """Return the four factors."""
        return np.concatenate([self.factors, np.zeros(_HIGHEST_ORDER + 1 - len(self.factors))])
