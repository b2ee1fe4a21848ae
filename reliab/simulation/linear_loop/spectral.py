"""Engine `spectral`: the loop solved in the frequency domain, exact for a piecewise-linear record.

The exact transform of the piecewise-linear record is multiplied by the exact transfer function on a
line slightly right of the imaginary axis, s = σ + iω, along which the periodic repetition of the
discrete transform decays, so that a lightly damped loop needs no long padding. What is neglected
lies above 256 Hz, where the record's transform and the structure's fall with ω² each.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
import scipy

from reliab.core.arrays import Array, Spectrum
from reliab.core.errors import InputError
from reliab.simulation.excitation import Deviation, Excitation, peak_of_history
from reliab.simulation.linear_loop.pole_recursion import transfer, transfer_of_shift
from reliab.structures.structure import Structure, critical_delay, refuse_long_leads

_LONGEST_STEP = 1.0 / 512.0
_WRAPAROUND = 1e-11  # what is left of a response after one period of the transform
_PERIODS_OF_LEAD = 100.0  # so that the response ahead of the record has decayed within one period

Transfer = Callable[[Spectrum], Spectrum]


def respond(
    excitation: Excitation, transfer_function: Transfer, *, longest: float = _LONGEST_STEP, lead: float = 0.0
) -> tuple[Array, float]:
    """Response of a linear system to minus the ground acceleration, inside the window.

    `transfer_function` [rad/s]; `longest`, `lead` [s].
    Returns `response`: response at equal steps from the begin to the end of the window, both included.
    """
    line = TransformLine.from_excitation(excitation, longest, lead)
    return line.response(transfer_function(line.s)), line.step


@dataclass(frozen=True, kw_only=True)
class TransformLine:
    """The record's transform on the line s = σ + iω, moved to the begin of the window."""

    s: Spectrum
    spectrum: Spectrum
    points: int
    steps: int
    step: float

    @classmethod
    def from_excitation(cls, excitation: Excitation, longest: float, lead: float) -> Self:
        """Transform a record for steps and leads up to the longest [s]."""
        begin, end = excitation.window
        steps = int(np.ceil((end - begin) / longest - 1e-9))
        step = (end - begin) / steps
        period = max(2.0 * end, _PERIODS_OF_LEAD * lead)
        points = scipy.fft.next_fast_len(int(np.ceil(period / step)) + 2, real=True)
        period = points * step
        shift = -np.log(_WRAPAROUND) / period
        s = shift + 2j * np.pi / period * np.arange(points // 2 + 1)
        spectrum = _record_transform(excitation, s) * np.exp(s * begin)
        return cls(s=s, spectrum=spectrum, points=points, steps=steps, step=step)

    def response(self, transfer: Spectrum) -> Array:
        """Response at equal steps of the window to transfer functions at s, shape (…, frequencies)."""
        damped_response = scipy.fft.irfft(self.spectrum * transfer, self.points)[..., : self.steps + 1]
        return np.asarray(damped_response * self._growth, dtype=np.float64)

    @cached_property
    def _growth(self) -> Array:
        """What undoes the decay along the line, and the sign and unit of the transform."""
        growth: Array = np.exp(self.s[0].real * self.step * np.arange(self.steps + 1))
        return growth / -self.step


def _record_transform(excitation: Excitation, s: Spectrum) -> Spectrum:
    """Laplace transform of the piecewise-linear record at equally spaced s."""
    a, h = excitation.acceleration, excitation.time_step
    spacing = (s[1] - s[0]).imag
    damped_record = a * np.exp(-s[0].real * h * np.arange(a.size))
    samples = scipy.signal.czt(damped_record, m=s.size, w=np.exp(-1j * spacing * h))
    fall = (1.0 - np.exp(-s * h)) / (s**2 * h)
    hat = fall * np.expm1(s * h)
    # The record starts with a jump: only the right half of the first hat is there.
    return np.asarray(samples * hat + a[0] * (1.0 / s - fall - hat))


def refuse_unstable(structure: Structure, gain: float, delay: float) -> None:
    """Raise an error that names the exact critical delay where the loop is unstable."""
    limit = float(critical_delay(structure, gain))
    if delay >= limit:
        raise InputError(
            f"The spectral engine needs a delay below the critical delay, which is {1e3 * limit:.6g} ms "
            f"for f = {structure.frequency:g} Hz, ξ = {structure.damping_ratio:g}, k_p = {gain:g}",
            value=f"{1e3 * delay:.6g} ms",
            remedy="Use a stepping engine for an unstable loop",
        )


def response(
    excitation: Excitation, structure: Structure, gain: float, delay: float, *, longest: float = _LONGEST_STEP
) -> tuple[Array, float]:
    """Measured displacement of one cell inside the window.

    `longest` [s]; returns displacement [m], step [s].
    """
    return respond(
        excitation,
        lambda s: transfer(structure, np.asarray(gain), np.asarray(delay), s),
        longest=longest,
        lead=max(0.0, -delay),
    )


def deviation(
    excitation: Excitation, structure: Structure, gain: Array, delay: Array, *, longest: float = _LONGEST_STEP
) -> Deviation:
    """Deviation of the measured displacement from the exact response, for many cells.

    `longest` [s].
    """
    refuse_long_leads(structure, gain, delay)
    line = TransformLine.from_excitation(excitation, longest, max(0.0, -float(delay.min(initial=0.0))))
    ideal = line.response(transfer(structure, np.ones(()), np.zeros(()), line.s))
    unstable = np.flatnonzero(delay >= critical_delay(structure, gain))
    if unstable.size:
        refuse_unstable(structure, float(gain[unstable[0]]), float(delay[unstable[0]]))
    mean_square, peak = np.empty(gain.size), np.empty(gain.size)
    for one_delay in np.unique(delay):
        shift = np.exp(-line.s * one_delay)  # the same for all gains, and dearer than all the rest
        for cell in np.flatnonzero(delay == one_delay):
            loop = transfer_of_shift(structure, np.asarray(gain[cell]), shift, line.s)
            difference = line.response(loop) - ideal
            mean_square[cell] = np.trapezoid(difference**2, dx=line.step) / excitation.window_duration
            peak[cell] = peak_of_history(difference)
    return Deviation(mean_square=mean_square, peak=peak, ideal_peak=peak_of_history(ideal))
