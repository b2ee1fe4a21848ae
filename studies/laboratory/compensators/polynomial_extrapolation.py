"""Polynomial extrapolation of Horiuchi."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.effects.kernel import Kernel, Numbers
from reliab.simulation.hybrid_test.closed_loop import Compensator

_MEMORY = 13  # displacements that fit into the state beside the last two that were sent
_HIGHEST_ORDER = 3


def _compensate(motion: Numbers, _time: float, step: float, coefficients: Numbers, state: Numbers) -> float:
    for place in range(12, 0, -1):
        state[place] = state[place - 1]
    state[0] = motion[0]
    spacing, order = int(coefficients[0]), int(coefficients[1])
    ahead = 0.0
    for node in range(order + 1):
        ahead += coefficients[2 + node] * state[node * spacing]
    velocity = (ahead - state[13]) / step
    motion[2] = (velocity - state[14]) / step
    motion[0], motion[1] = ahead, velocity
    state[13], state[14] = ahead, velocity
    return 0.0


@dataclass(frozen=True, kw_only=True)
class PolynomialExtrapolation(Compensator):
    """Sends the value at t + δ of the polynomial through the command at t, t − δ, …, t − nδ.

    Of third order 4x(t) − 6x(t−δ) + 4x(t−2δ) − x(t−3δ).

    Horiuchi, T., Inoue, M., Konno, T. and Namita, Y. (1999). Real-time hybrid experimental system with
    actuator delay compensation and its application to a piping system with energy absorber.
    *Earthquake Eng. Struct. Dyn.* 28(10), 1121–1141.
    """

    kernel: ClassVar[Kernel] = Kernel(function=_compensate, states=15)
    name: ClassVar[str] = "polynomial_extrapolation"

    steps: int  # Delay δ to be compensated [steps], at least 1; steps times order at most 12
    order: int = 3  # Order n of the polynomial, 1 to 3

    def __post_init__(self) -> None:
        if not 1 <= self.order <= _HIGHEST_ORDER:
            raise InputError("The order of the polynomial must be 1, 2 or 3", value=self.order)
        if not 1 <= self.steps * self.order < _MEMORY:
            raise InputError(
                f"Delay in steps times order must lie between 1 and {_MEMORY - 1}",
                value=self.steps * self.order,
                remedy="Choose a lower order or a longer sampling step",
            )

    def coefficients(self, step: float) -> Array:  # noqa: ARG002 - a number of steps
        """Spacing, order and weights of the nodes."""
        n = self.order + 1
        weights = [(-1.0) ** node * math.comb(n, node + 1) for node in range(n)]
        return np.array([self.steps, self.order, *weights])
