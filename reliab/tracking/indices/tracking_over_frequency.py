"""Amplitude and delay of actuator tracking as functions of frequency, A(f) and d(f).

With averaged spectra of command x_c and measured displacement x_m over half-overlapping stretches ::

    σ(f) = S_cm / S_cc,   A(f) = |σ|,   d(f) = −arg σ / 2πf,   γ² = |S_cm|² / S_cc S_mm

Before, the measured displacement is advanced by the delay of the whole test, which is added again: a stretch
then holds the same motion in both channels, and its ends do not disturb d. The command is known exactly, so
that noise of the sensor leaves σ unbiased. One standard deviation of A/|σ| and of the phase [rad] is
√((1 − γ²)/2γ²n) with n independent stretches (Bendat and Piersol, *Random Data*, 4th edition, section 9.2).
Only frequencies at which the command has power and the two are coherent are kept.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from reliab.core.arrays import Array, Spectrum
from reliab.core.errors import InputError
from reliab.tracking.indices.frequency_evaluation import frequency_evaluation

_LONGEST = 8.0  # s, in which the spectra are taken
_LEAST_STRETCHES = 4
_OVERLAP_LOSS = 1.06  # of half-overlapping Hann windows, 1 + 2·(1/6)²
_COHERENT = 0.98
_LEAST_POWER = 1e-5  # of the command's strongest frequency, below which the window leaks
_FEWEST = 2


@dataclass(frozen=True, kw_only=True, eq=False)
class TrackingOverFrequency:
    """A(f) and d(f) at the frequencies at which a test shows them."""

    frequency: Array  # Frequencies [Hz], ascending, shape (n,)
    amplitude: Array  # A [-], shape (n,)
    delay: Array  # d [s], positive when the measured displacement lags, shape (n,)
    # amplitude_deviation, delay_deviation: Their standard deviations by noise [-] and [s], shape (n,)
    amplitude_deviation: Array
    delay_deviation: Array
    coherence: Array  # γ² [-], shape (n,)

    def at(self, frequency: Array | float) -> tuple[Array, Array]:
        """Give A [-] and d [s] at frequencies [Hz]; beyond the known ones those of the nearest."""
        frequencies = np.abs(np.asarray(frequency, dtype=np.float64))
        return (
            np.interp(frequencies, self.frequency, self.amplitude),
            np.interp(frequencies, self.frequency, self.delay),
        )

    def known(self, frequency: float) -> bool:
        """Whether a frequency [Hz] lies between those at which the test shows A and d."""
        return bool(self.frequency[0] <= frequency <= self.frequency[-1])

    def transfer(self, s: Spectrum) -> Spectrum:
        """Measured over command displacement σ = A e^(−sd) [-] at s [rad/s], near the imaginary axis."""
        amplitude, delay = self.at(s.imag / (2.0 * np.pi))
        return np.asarray(amplitude * np.exp(-s * delay))

    def follow(self, command: Array, time_step: float) -> Array:
        """Displacement [m] of an actuator with this A(f) and d(f) under a command [m], shape (n,)."""
        points = 2 * command.size
        s = np.asarray(2j * np.pi * np.fft.rfftfreq(points, time_step), dtype=np.complex128)
        start = command[0]
        return np.asarray(
            start
            + np.fft.irfft(np.fft.rfft(command - start, points) * self.transfer(s), points)[: command.size]
        )

    @cached_property
    def spread(self) -> tuple[float, float]:
        """Largest minus least A [-] and d [s] over the frequencies."""
        return float(np.ptp(self.amplitude)), float(np.ptp(self.delay))


def tracking_over_frequency(command: Array, measured: Array, time_step: float) -> TrackingOverFrequency:
    """Estimate A and d over frequency.

    `command`, `measured` [m]; `time_step` [s].
    Returns A(f) and d(f), by stretches of 8 s or, in a shorter test, of two fifths of it.

    >>> noise = np.random.default_rng(0).standard_normal(40_000).cumsum()
    >>> found = tracking_over_frequency(noise[2:], 0.98 * noise[:-2], 1.0 / 1000.0)
    >>> amplitude, delay = found.at(3.0)
    >>> round(float(amplitude), 2), round(1e3 * float(delay), 1)
    (0.98, 2.0)
    """
    whole = frequency_evaluation(command, measured, time_step).equivalent_delay
    aligned = _advance(measured, whole, time_step)
    points = min(int(_LONGEST / time_step), 2 * command.size // (_LEAST_STRETCHES + 1))
    rate = 1.0 / time_step
    frequency, cross = scipy.signal.csd(command, aligned, fs=rate, nperseg=points)
    _, into = scipy.signal.welch(command, fs=rate, nperseg=points)
    _, out = scipy.signal.welch(aligned, fs=rate, nperseg=points)
    coherent = (np.abs(cross) ** 2 > _COHERENT * into * out) & (into > _LEAST_POWER * into.max())
    coherent[0] = False
    if int(coherent.sum()) < _FEWEST:
        raise InputError(
            "Command and measured displacement are hardly coherent",
            value=f"coherent at {int(coherent.sum())} frequencies",
            remedy="Record longer, or with less noise",
        )
    frequency, ratio = frequency[coherent], cross[coherent] / into[coherent]
    coherence = np.minimum(np.abs(cross[coherent]) ** 2 / (into[coherent] * out[coherent]), 1.0)
    stretches = (2.0 * command.size / points - 1.0) / _OVERLAP_LOSS
    relative = np.sqrt((1.0 - coherence) / (2.0 * coherence * stretches))
    turn = 2.0 * np.pi * frequency
    return TrackingOverFrequency(
        frequency=frequency,
        amplitude=np.abs(ratio),
        delay=whole - np.unwrap(np.angle(ratio)) / turn,
        amplitude_deviation=np.abs(ratio) * relative,
        delay_deviation=relative / turn,
        coherence=coherence,
    )


def _advance(history: Array, time: float, time_step: float) -> Array:
    """Advance a history by a time [s] in the frequency domain, at rest before and after it."""
    points = 2 * history.size
    turns = np.fft.rfftfreq(points, time_step)
    middle = 0.5 * (history[0] + history[-1])
    shifted = np.fft.rfft(history - middle, points) * np.exp(2j * np.pi * turns * time)
    return np.asarray(middle + np.fft.irfft(shifted, points)[: history.size])
