"""The adaptive time series compensator of Chae, Kazemibidokhti and Ricles."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.effects.kernel import Kernel, Numbers
from reliab.simulation.hybrid_test.closed_loop import Compensator

from .low_pass import butterworth_sections, filter_two

_LONGEST = 256  # samples of the moving window
_FACTORS = 3
_RING = 27  # where the window begins in the state


def _compensate(
    motion: Numbers, measured: float, step: float, coefficients: Numbers, state: Numbers
) -> float:
    # Coefficients: 3 first factors, 3 lower and 3 upper bounds, 3 largest rates, trigger, samples, window,
    # time by which derivatives are scaled, two sections of the filter from 16 on.
    # State: 0 count; 1-3 factors; 4-5 last targets; 6-13 filters; 14-15 last filtered measurements;
    # 16 last sent, 17 last velocity; 18-26 free; then the window's rows x, Dx, D²x, u.
    if state[0] == 0.0:
        for i in range(3):
            state[1 + i] = coefficients[i]
    x = motion[0]
    sent = state[1] * x + state[2] * (x - state[4]) / step
    sent += state[3] * (x - 2.0 * state[4] + state[5]) / step**2
    state[5], state[4] = state[4], x
    u, y = filter_two(sent, measured, state, 6, coefficients, 16)
    scale, every, window = coefficients[15], int(coefficients[13]), int(coefficients[14])
    count = int(state[0])
    if count % every == 0:
        place = 27 + 4 * ((count // every) % window)
        state[place] = y
        state[place + 1] = scale * (y - state[14]) / step
        state[place + 2] = scale * scale * (y - 2.0 * state[14] + state[15]) / step**2
        state[place + 3] = u
        largest = 0.0
        m00, m01, m02, m11, m12, m22, r0, r1, r2 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for row in range(window):
            p = 27 + 4 * row
            q0, q1, q2, w = state[p], state[p + 1], state[p + 2], state[p + 3]
            m00 += q0 * q0
            m01 += q0 * q1
            m02 += q0 * q2
            m11 += q1 * q1
            m12 += q1 * q2
            m22 += q2 * q2
            r0 += q0 * w
            r1 += q1 * w
            r2 += q2 * w
            largest = max(largest, abs(q0))
        c00, c01, c02 = m11 * m22 - m12 * m12, m02 * m12 - m01 * m22, m01 * m12 - m02 * m11
        determinant = m00 * c00 + m01 * c01 + m02 * c02
        if largest >= coefficients[12] and determinant > 1e-12 * m00 * m11 * m22:
            c11, c12, c22 = m00 * m22 - m02 * m02, m01 * m02 - m00 * m12, m00 * m11 - m01 * m01
            fit0 = (c00 * r0 + c01 * r1 + c02 * r2) / determinant
            fit1 = (c01 * r0 + c11 * r1 + c12 * r2) / determinant * scale
            fit2 = (c02 * r0 + c12 * r1 + c22 * r2) / determinant * scale * scale
            for i in range(3):
                fit = fit0 if i == 0 else (fit1 if i == 1 else fit2)
                fit = min(max(fit, coefficients[3 + i]), coefficients[6 + i])
                most = coefficients[9 + i] * every * step
                state[1 + i] += min(max(fit - state[1 + i], -most), most)
    state[0] = count + 1.0
    state[15], state[14] = state[14], y
    velocity = (sent - state[16]) / step
    motion[2] = (velocity - state[17]) / step
    motion[0], motion[1] = sent, velocity
    state[16], state[17] = sent, velocity
    return 0.0


@dataclass(frozen=True, kw_only=True)
class AdaptiveTimeSeries(Compensator):
    """Sends a₀x + a₁Dx + a₂D²x with factors fitted to what was commanded and measured in the last second.

    Command and measurement pass the same Butterworth filter of fourth order; the factors are fitted by least
    squares over a moving window, so that the measurement and its differences reproduce the command. The
    factors stay within bounds and change no faster than the given rates.

    Chae, Y., Kazemibidokhti, K. and Ricles, J. M. (2013). Adaptive time series compensator for delay
    compensation of servo-hydraulic actuator systems for real-time hybrid simulation. *Earthquake Eng. Struct.
    Dyn.* 42(11), 1697-1715.

    >>> adaptive = AdaptiveTimeSeries(factors=(1.0, 0.02, 0.0002))
    >>> int(adaptive.coefficients(1 / 4096)[14])  # samples in a window of a second
    256
    """

    kernel: ClassVar[Kernel] = Kernel(function=_compensate, states=_RING + 4 * _LONGEST)
    name: ClassVar[str] = "adaptive_time_series"

    factors: tuple[float, ...]  # First a₀ [-], a₁ [s], a₂ [s²]
    lowest: tuple[float, ...] = (0.7, 0.0, 0.0)  # lowest, highest: Bounds of the factors
    highest: tuple[float, ...] = (1.3, 0.08, 0.0032)
    fastest: tuple[float, ...] = (2.0, 0.05, 0.001)  # Largest rates of the factors [1/s, -, s]
    trigger: float = 0.00025  # Displacement [m] that the window must have seen before factors are fitted
    samples: int = 16  # Samples of the test per sample of the window
    window: float = 1.0  # Length of the window [s]
    cutoff: float = 20.0  # Cutoff of the filter [Hz]

    def __post_init__(self) -> None:
        tuples = (self.factors, self.lowest, self.highest, self.fastest)
        if any(len(values) != _FACTORS or not all(map(math.isfinite, values)) for values in tuples):
            raise InputError("Factors, bounds and rates need three finite numbers each", value=str(tuples))
        if any(low > high for low, high in zip(self.lowest, self.highest, strict=True)):
            raise InputError(
                "A lower bound of a factor must not exceed the upper one",
                value=f"{list(self.lowest)} and {list(self.highest)}",
            )
        if not (self.samples >= 1 and self.window > 0.0 and self.trigger > 0.0):
            raise InputError(
                "Samples, window and trigger of an adaptive time series must be positive",
                value=f"{self.samples}, {self.window} s, {self.trigger} m",
            )

    def coefficients(self, step: float) -> Array:
        """First factors, bounds, rates, trigger, window and the sections of the filter."""
        rows = round(self.window / (self.samples * step))
        if not _FACTORS <= rows <= _LONGEST:
            raise InputError(
                f"The window must hold {_FACTORS} to {_LONGEST} of its samples",
                value=rows,
                remedy="Change the window's length or the samples of the test to one of the window",
            )
        scale = 1.0 / (2.0 * math.pi * 3.0)  # brings derivatives of seismic motion to the displacement's size
        numbers = [*self.factors, *self.lowest, *self.highest, *self.fastest]
        numbers += [self.trigger, float(self.samples), float(rows), scale]
        return np.concatenate([numbers, butterworth_sections(4, self.cutoff, step)])
