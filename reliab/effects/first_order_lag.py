"""First-order lag of the actuator, T·y' + y = u."""

import math
from dataclasses import dataclass

import numpy as np

from reliab.core.arrays import Array, Spectrum
from reliab.core.vocabulary import Block
from reliab.effects.effect import LinearEffect, Parameter, Role, Setting
from reliab.effects.kernel import Kernel, Numbers


def _move(motion: Numbers, _time: float, step: float, coefficients: Numbers, state: Numbers) -> float:
    # Within a step the input counts as the straight line p through u − h²u''/12, which has the same mean:
    # y₁ = E·y₀ + w₀·p₀ + w₁·p₁. State: started, p, y.
    time_constant, decay, early, late = coefficients[0], coefficients[1], coefficients[2], coefficients[3]
    u, u_rate = motion[0], motion[1]
    line = u - step * step * motion[2] / 12.0
    y = u if state[0] == 0.0 else decay * state[2] + early * state[1] + late * line
    rate = (u - y) / time_constant
    state[0], state[1], state[2] = 1.0, line, y
    motion[0], motion[1], motion[2] = y, rate, (u_rate - rate) / time_constant
    return 0.0


@dataclass(frozen=True, kw_only=True)
class FirstOrderLag(LinearEffect):
    """First-order lag T·y' + y = u between the command and the piston."""

    name = "first_order_lag"
    block = Block.ACTUATOR
    role = Role.PISTON
    description = "the actuator follows like a first-order low-pass filter"
    parameters = (
        Parameter(
            name="time_constant_s",
            units="s",
            meaning="time constant",
            scale=(("displacement", 1.0), ("velocity", -1.0)),
            typical=0.1,
            lower=1e-4,
            upper=20.0,
            starts=(0.01, 0.1, 1.0),
        ),
    )
    kernel = Kernel(function=_move, states=3)

    time_constant_s: float  # Time constant T [s]

    def coefficients(self, setting: Setting) -> Array:
        """Time constant, decay over a step, weights of the input before and after it."""
        ratio = setting.step / self.time_constant_s
        held = -math.expm1(-ratio)
        late = 1.0 - held / ratio
        return np.array([self.time_constant_s, 1.0 - held, held - late, late])

    def transfer(self, s: Spectrum) -> Spectrum:
        """Transfer function 1/(1 + Ts)."""
        return 1.0 / (1.0 + self.time_constant_s * s)
