"""Adaptive model-based compensation of Gálmez and Fermandois."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.effects.kernel import Kernel, Numbers
from reliab.simulation.hybrid_test.closed_loop import Compensator

from .low_pass import butterworth_sections, filter_two

_FACTORS = 4


def _compensate(
    motion: Numbers, measured: float, step: float, coefficients: Numbers, state: Numbers
) -> float:
    # Coefficients: 4 first factors, 4 rates, two sections b₀ b₁ b₂ a₁ a₂ of the filter.
    # State: started; 4 factors; 3 last targets; 3 last filtered measurements; filters of command and
    # measurement, 4 each; last sent displacement and velocity.
    if state[0] == 0.0:
        state[0] = 1.0
        for i in range(4):
            state[1 + i] = coefficients[i]
    x = motion[0]
    sent = state[1] * x + state[2] * (x - state[5]) / step
    sent += state[3] * (x - 2.0 * state[5] + state[6]) / step**2
    sent += state[4] * (x - 3.0 * state[5] + 3.0 * state[6] - state[7]) / step**3
    state[7], state[6], state[5] = state[6], state[5], x
    u, y = filter_two(sent, measured, state, 11, coefficients, 8)
    first = (y - state[8]) / step
    second = (y - 2.0 * state[8] + state[9]) / step**2
    third = (y - 3.0 * state[8] + 3.0 * state[9] - state[10]) / step**3
    state[10], state[9], state[8] = state[9], state[8], y
    error = u - state[1] * y - state[2] * first - state[3] * second - state[4] * third
    rate = step * error / (1.0 + y * y + first * first + second * second + third * third)
    state[1] = max(state[1] + coefficients[4] * rate * y, 0.0)
    state[2] = max(state[2] + coefficients[5] * rate * first, 0.0)
    state[3] = max(state[3] + coefficients[6] * rate * second, 0.0)
    state[4] = max(state[4] + coefficients[7] * rate * third, 0.0)
    velocity = (sent - state[19]) / step
    motion[2] = (velocity - state[20]) / step
    motion[0], motion[1] = sent, velocity
    state[19], state[20] = sent, velocity
    return 0.0


@dataclass(frozen=True, kw_only=True)
class AdaptiveModelBased(Compensator):
    """Sends a₀x + a₁Dx + a₂D²x + a₃D³x with factors that follow a gradient law while the test runs.

    Command u and measurement y pass the same Butterworth filter of fourth order; with X = (y, Dy, D²y, D³y)
    the factors move by a' = Γ ε X, ε = (u − aᵀX)/(1 + XᵀX), and stay positive.

    Gálmez, C. and Fermandois, G. (2022). Robust adaptive model-based compensator for the real-time hybrid
    simulation benchmark. *Struct. Control Health Monit.* 29(7), e2962.

    >>> adaptive = AdaptiveModelBased(factors=(1.0, 0.02, 8.4e-5, 2e-7))
    >>> adaptive.coefficients(1 / 4096).size
    18
    """

    kernel: ClassVar[Kernel] = Kernel(function=_compensate, states=21)
    name: ClassVar[str] = "adaptive_model_based"

    factors: tuple[float, ...]  # First a₀ [-], a₁ [s], a₂ [s²], a₃ [s³]
    rates: tuple[float, ...] = (10**8.4, 10**6.2, 10**2.1, 10**0.8)  # Diagonal of Γ, in SI units
    cutoff: float = 20.0  # Cutoff of the filter [Hz]

    def __post_init__(self) -> None:
        for values, lowest in ((self.factors, -math.inf), (self.rates, 0.0)):
            if len(values) != _FACTORS or not all(math.isfinite(v) and v >= lowest for v in values):
                raise InputError(
                    "Adaptive model-based compensation needs four finite factors and four rates",
                    value=f"{list(self.factors)} and {list(self.rates)}",
                    remedy="Give a₀ to a₃ and the diagonal of Γ, which is not negative",
                )

    def coefficients(self, step: float) -> Array:
        """First factors, rates and the sections of the filter."""
        return np.concatenate([self.factors, self.rates, butterworth_sections(4, self.cutoff, step)])
