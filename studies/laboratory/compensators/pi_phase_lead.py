"""Proportional-integral control of the displacement behind a phase lead."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.effects.kernel import Kernel, Numbers
from reliab.simulation.hybrid_test.closed_loop import Compensator


def _control(motion: Numbers, measured: float, step: float, coefficients: Numbers, state: Numbers) -> float:
    # Coefficients: lead of now and before, its pole, error of now and before, quantum, range.
    # State: target, lead, error, command, velocity of the command.
    quantum, span = coefficients[5], coefficients[6]
    target = motion[0]
    if quantum > 0.0:
        target = quantum * np.rint(min(max(target, -span), span) / quantum)
    lead = coefficients[0] * target + coefficients[1] * state[0] + coefficients[2] * state[1]
    before = state[3]
    ahead = min(max(quantum * np.rint(lead / quantum), -span), span) if quantum > 0.0 else lead
    error = ahead - measured
    if quantum > 0.0:
        error = quantum * np.rint(min(max(error, -span), span) / quantum)
    command = before + coefficients[3] * error + coefficients[4] * state[2]
    state[0], state[1], state[2], state[3] = target, lead, error, command
    sent = min(max(quantum * np.rint(command / quantum), -span), span) if quantum > 0.0 else command
    velocity = (command - before) / step
    motion[2] = (velocity - state[4]) / step
    motion[0], motion[1] = sent, velocity
    state[4] = velocity
    return 0.0


@dataclass(frozen=True, kw_only=True)
class PhaseLeadControl(Compensator):
    """PI control P + I/s of the displacement error, behind the lead (λs + p)/(s + p) on the target.

    Both are discretised by Tustin's rule. The numbers of the virtual hybrid-simulation benchmark are the
    defaults, without its converters.

    Silva, C. E., Gomez, D., Maghareh, A., Dyke, S. J. and Spencer, B. F. (2020). Benchmark control problem
    for real-time hybrid simulation. *Mech. Syst. Signal Process.* 135, 106381.

    A constant error e makes the command grow by I·e each second:

    >>> control = PhaseLeadControl(proportional=0.0, integral=10.0, lead=1.0)
    >>> state, motion = np.zeros(control.kernel.states), np.zeros(3)
    >>> for _ in range(1001):
    ...     motion[0] = 0.1
    ...     _ = control.kernel(motion, 0.0, 0.001, control.coefficients(0.001), state)
    >>> round(float(motion[0]), 2)
    1.0
    """

    kernel: ClassVar[Kernel] = Kernel(function=_control, states=5)
    name: ClassVar[str] = "pi_phase_lead"

    proportional: float = 2.0  # P [-]
    integral: float = 95.0  # I [1/s]
    lead: float = 50.8316336027  # λ [-]; 1 is no lead
    lead_pole: float = 8570.3973394443  # p [1/s]
    quantum: float = 0.0  # Step [m] of the converters before and after each of the two blocks; 0 for none
    span: float = 3.8  # Largest value [m] of the converters

    def __post_init__(self) -> None:
        for field in ("proportional", "integral", "lead", "lead_pole", "quantum", "span"):
            value = getattr(self, field)
            if not (math.isfinite(value) and value >= 0.0):
                raise InputError(f"The controller's {field} must be finite and not negative", value=value)

    def coefficients(self, step: float) -> Array:
        """Rows of both recursions, then quantum and range of the converters."""
        rate = 2.0 / step
        slow = rate + self.lead_pole
        lead = [
            (self.lead * rate + self.lead_pole) / slow,
            (self.lead_pole - self.lead * rate) / slow,
            (rate - self.lead_pole) / slow,
        ]
        half = 0.5 * self.integral * step
        return np.array([*lead, self.proportional + half, half - self.proportional, self.quantum, self.span])
