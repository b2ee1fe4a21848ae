"""Second-order dynamics of the servo-hydraulic actuator, y'' + 2ζω·y' + ω²·y = ω²·u."""

import math
from dataclasses import dataclass

import numpy as np
import scipy

from reliab.core.arrays import Array, Spectrum
from reliab.core.vocabulary import Block
from reliab.effects.effect import LinearEffect, Parameter, Role, Setting
from reliab.effects.first_order_lag import FirstOrderLag
from reliab.effects.kernel import Kernel, Numbers


def _move(motion: Numbers, _time: float, step: float, coefficients: Numbers, state: Numbers) -> float:
    # Within a step the input counts as the straight line p through u − h²u''/12, which has the same mean;
    # rows of the transition: from y, y', p before and p after. State: started, p, y, y'.
    u = motion[0]
    line = u - step * step * motion[2] / 12.0
    if state[0] == 0.0:
        y, rate = u, 0.0
    else:
        y = coefficients[2] * state[2] + coefficients[3] * state[3]
        y += coefficients[4] * state[1] + coefficients[5] * line
        rate = coefficients[6] * state[2] + coefficients[7] * state[3]
        rate += coefficients[8] * state[1] + coefficients[9] * line
    state[0], state[1], state[2], state[3] = 1.0, line, y, rate
    motion[0], motion[1] = y, rate
    motion[2] = coefficients[0] * (u - y) - coefficients[1] * rate
    return 0.0


@dataclass(frozen=True, kw_only=True)
class SecondOrderDynamics(LinearEffect):
    """Second-order dynamics y'' + 2ζω·y' + ω²·y = ω²·u, ω = 2πf, between the command and the piston."""

    name = "second_order_dynamics"
    block = Block.ACTUATOR
    role = Role.PISTON
    description = "the actuator follows like a second-order low-pass filter"
    limiting_cases = (FirstOrderLag,)
    parameters = (
        Parameter(
            name="natural_frequency_hz",
            units="Hz",
            meaning="natural frequency of the servo",
            scale=(("velocity", 1.0), ("displacement", -1.0)),
            typical=1.0,
            lower=0.02,
            upper=60.0,
            starts=(0.3, 1.0, 3.0, 3.0, 10.0),
        ),
        Parameter(
            name="damping_ratio",
            units="-",
            meaning="damping ratio of the servo",
            typical=0.7,
            spread=0.5,
            lower=0.05,
            upper=1.2,
            starts=(0.7, 0.7, 0.3, 1.0, 0.7),
        ),
    )
    kernel = Kernel(function=_move, states=4)

    natural_frequency_hz: float  # Natural frequency f [Hz]
    # Damping ratio ζ [-]; a fit goes up to 1.2, beyond which a servo is a first-order lag and some delay
    damping_ratio: float

    def coefficients(self, setting: Setting) -> Array:
        """ω², 2ζω and the two rows of the transition over a step."""
        omega = 2.0 * math.pi * self.natural_frequency_hz
        stiffness, damping = omega**2, 2.0 * self.damping_ratio * omega
        # The state holds y, y', u and the slope of u.
        system = np.zeros((4, 4))
        system[0, 1] = 1.0
        system[1, :3] = -stiffness, -damping, stiffness
        system[2, 3] = 1.0
        transition = scipy.linalg.expm(setting.step * system)[:2]
        slope = transition[:, 3] / setting.step
        rows = np.column_stack([transition[:, :2], transition[:, 2] - slope, slope])
        return np.concatenate([[stiffness, damping], rows.ravel()])

    def transfer(self, s: Spectrum) -> Spectrum:
        """Transfer function ω²/(s² + 2ζωs + ω²)."""
        omega = 2.0 * math.pi * self.natural_frequency_hz
        return omega**2 / (s**2 + 2.0 * self.damping_ratio * omega * s + omega**2)
