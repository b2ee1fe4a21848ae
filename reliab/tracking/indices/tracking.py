"""Measures of actuator tracking: the frequency-domain evaluation index (FEI), and others over time.

With F[·] the discrete Fourier transform after a window, I the command and O the measured
displacement, at frequencies i = 1 … p, p half of the smallest power of two that holds the data::

    w_i = |F[I]_i|² / Σ|F[I]|²              (1)
    FEI = Σ w_j F[O]_j / F[I]_j             (2)
    A = |FEI|,  φ = arg FEI                 (3)
    f_eq = Σ w_i f_i                        (4)
    d = −φ / (2π f_eq)                      (5)

A and d of x_m(t) = k_p x_c(t − τ) are k_p and τ to first order in the spread of the frequencies. The window
suppresses errors from the ends of the record. Without it ("boxcar"), a record that ends during strong motion
gives A and d an error of about the share that its last τ seconds have in the whole record.

All compare the measured displacement x_m with the command x_c. They measure how well the actuator followed,
not how reliable the test is: tracking errors accumulate in the loop.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.core.arrays import Array, Spectrum
from reliab.core.errors import InputError
from reliab.signals.spectra import cross_correlate, taper

if TYPE_CHECKING:
    from reliab.simulation.linear_loop.tracking_sums import TrackingSums


_FEWEST_SAMPLES = 16


@dataclass(frozen=True, kw_only=True)
class FrequencyEvaluation:
    """Amplitude and delay of actuator tracking."""

    amplitude: float  # A [-], 1 for perfect tracking
    phase: float  # φ [rad], negative when the measured displacement lags
    equivalent_frequency: float  # f_eq [Hz]
    equivalent_delay: float  # d [s], positive when the measured displacement lags


def frequency_evaluation(
    command: Array, measured_displacement: Array, time_step: float, *, window: str = "hann"
) -> FrequencyEvaluation:
    """Evaluate how an actuator tracked its command, equations (1)–(5).

    `command`, `measured_displacement` [m]; `time_step` [s].

    >>> t = np.arange(0.0, 40.0, 1.0 / 1024.0)
    >>> command, measured = np.sin(2 * np.pi * t), 1.01 * np.sin(2 * np.pi * (t - 0.002))
    >>> found = frequency_evaluation(command, measured, 1.0 / 1024.0)
    >>> round(found.amplitude, 4), round(1e3 * found.equivalent_delay, 3)
    (1.01, 2.0)
    """
    return CommandSpectrum(command=command, time_step=time_step, window=window).evaluate(
        measured_displacement
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class CommandSpectrum:
    """A command [m] beside which measured displacements are evaluated, one after the other."""

    command: Array
    time_step: float  # [s]
    window: str = "hann"

    def evaluate(self, measured_displacement: Array) -> FrequencyEvaluation:
        """Evaluate one as :func:`frequency_evaluation` does."""
        _check(self.command, measured_displacement)
        command_spectrum, total, frequency = self._command_power
        index = np.sum(self._spectrum(measured_displacement) * command_spectrum.conj()) / total
        phase = float(np.angle(index))
        return FrequencyEvaluation(
            amplitude=float(np.abs(index)),
            phase=phase,
            equivalent_frequency=frequency,
            equivalent_delay=-phase / (2.0 * np.pi * frequency),
        )

    @property
    def _points(self) -> int:
        return 1 << (self.command.size - 1).bit_length()

    def _spectrum(self, values: Array) -> NDArray[np.complex128]:
        return np.fft.rfft(values * taper(self.window, values.size), self._points)[1:]

    @cached_property
    def _command_power(self) -> tuple[NDArray[np.complex128], float, float]:
        """Spectrum of the command, the sum of its power, and the equivalent frequency [Hz]."""
        spectrum = self._spectrum(self.command)
        power = np.abs(spectrum) ** 2
        total, frequencies = power.sum(), np.fft.rfftfreq(self._points, self.time_step)[1:]
        return spectrum, total, float(np.sum(power * frequencies) / total)


def evaluate_sums(sums: "TrackingSums") -> tuple[Array, Array]:
    """Evaluate tracking of many simulated tests from sums that were accumulated while stepping.

    `sums`: sums over the positive frequencies of command and measured displacement. Returns A [-] and d [s],
    shape (cells,); over the real records A is within 4e-4 and d within 0.6 % of :func:`frequency_evaluation`
    of the histories in 95 of 100 cells.
    """
    with np.errstate(all="ignore"):  # a violently unstable cell has no index
        index = sums.cross / sums.power
        delay = -np.angle(index) / (2.0 * np.pi * sums.equivalent_frequency)
    return np.abs(index), delay


def _check(command: Array, measured_displacement: Array) -> None:
    if command.shape != measured_displacement.shape or command.size < _FEWEST_SAMPLES:
        raise InputError(
            f"Command and measured displacement must have the same length of at least {_FEWEST_SAMPLES} "
            "samples",
            value=f"{command.size} and {measured_displacement.size} samples",
            remedy="Cut both histories to the same stretch of the test",
        )
    if np.ptp(command) == 0.0:
        raise InputError(
            "The command does not move",
            remedy="Check that the column of the command is the right one",
        )


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

    def interpolate(self, frequency: Array | float) -> tuple[Array, Array]:
        """Give A [-] and d [s] at frequencies [Hz]; beyond the known ones those of the nearest."""
        frequencies = np.abs(np.asarray(frequency, dtype=np.float64))
        return (
            np.interp(frequencies, self.frequency, self.amplitude),
            np.interp(frequencies, self.frequency, self.delay),
        )

    def covers(self, frequency: float) -> bool:
        """Whether a frequency [Hz] lies between those at which the test shows A and d."""
        return bool(self.frequency[0] <= frequency <= self.frequency[-1])

    def transfer(self, s: Spectrum) -> Spectrum:
        """Measured over command displacement σ = A e^(−sd) [-] at s [rad/s], near the imaginary axis."""
        amplitude, delay = self.interpolate(s.imag / (2.0 * np.pi))
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


def tracking_over_frequency(
    command: Array, measured_displacement: Array, time_step: float
) -> TrackingOverFrequency:
    """Estimate A and d over frequency.

    `command`, `measured_displacement` [m]; `time_step` [s].
    Returns A(f) and d(f), by stretches of 8 s or, in a shorter test, of two fifths of it.

    >>> noise = np.random.default_rng(0).standard_normal(40_000).cumsum()
    >>> found = tracking_over_frequency(noise[2:], 0.98 * noise[:-2], 1.0 / 1000.0)
    >>> amplitude, delay = found.interpolate(3.0)
    >>> round(float(amplitude), 2), round(1e3 * float(delay), 1)
    (0.98, 2.0)
    """
    mean_delay = frequency_evaluation(command, measured_displacement, time_step).equivalent_delay
    aligned_displacement = _advance(measured_displacement, mean_delay, time_step)
    points = min(int(_LONGEST / time_step), 2 * command.size // (_LEAST_STRETCHES + 1))
    rate = 1.0 / time_step
    frequency, cross = scipy.signal.csd(command, aligned_displacement, fs=rate, nperseg=points)
    _, power = scipy.signal.welch(command, fs=rate, nperseg=points)
    _, output_power = scipy.signal.welch(aligned_displacement, fs=rate, nperseg=points)
    coherent = (np.abs(cross) ** 2 > _COHERENT * power * output_power) & (power > _LEAST_POWER * power.max())
    coherent[0] = False
    if int(coherent.sum()) < _FEWEST:
        raise InputError(
            "The measured displacement hardly follows the command at the frequencies of the test",
            value=f"coherent at {int(coherent.sum())} frequencies",
            remedy="Record longer, or with less noise",
        )
    frequency, ratio = frequency[coherent], cross[coherent] / power[coherent]
    coherence = np.minimum(np.abs(cross[coherent]) ** 2 / (power[coherent] * output_power[coherent]), 1.0)
    stretches = (2.0 * command.size / points - 1.0) / _OVERLAP_LOSS
    relative = np.sqrt((1.0 - coherence) / (2.0 * coherence * stretches))
    turn = 2.0 * np.pi * frequency
    return TrackingOverFrequency(
        frequency=frequency,
        amplitude=np.abs(ratio),
        delay=mean_delay - np.unwrap(np.angle(ratio)) / turn,
        amplitude_deviation=np.abs(ratio) * relative,
        delay_deviation=relative / turn,
        coherence=coherence,
    )


def _advance(history: Array, time: float, time_step: float) -> Array:
    """Advance a history by a time [s] in the frequency domain, at rest before and after it."""
    points = 2 * history.size
    turns = np.fft.rfftfreq(points, time_step)
    middle = 0.5 * (history[0] + history[-1])
    advanced_history = np.fft.rfft(history - middle, points) * np.exp(2j * np.pi * turns * time)
    return np.asarray(middle + np.fft.irfft(advanced_history, points)[: history.size])


def maximum_tracking_error(command: Array, measured_displacement: Array) -> float:
    """Largest |x_m − x_c| over largest |x_c| [-].

    `command`, `measured_displacement`: displacements [m], shape (n,). Returns the error [-].
    """
    return float(np.abs(measured_displacement - command).max() / np.abs(command).max())


def rms_tracking_error(command: Array, measured_displacement: Array) -> float:
    """Root mean square of x_m − x_c over that of x_c [-].

    `command`, `measured_displacement`: displacements [m], shape (n,). Returns the error [-].
    """
    return float(np.linalg.norm(measured_displacement - command) / np.linalg.norm(command))


def tracking_indicator(command: Array, measured_displacement: Array) -> Array:
    """Tracking indicator: signed area between the two displacements, Mercan and Ricles 2007.

    Half of ∫x_c dx_m − ∫x_m dx_c by the trapezoidal rule; it grows while the actuator lags, falls
    while it leads and stays level while it follows. It is π times amplitude squared times the
    sine of the lag for each cycle of a harmonic.

    `command`, `measured_displacement`: displacements [m], shape (n,). Returns
    indicator [m²] up to each sample, shape (n,); zero at the first.

    One cycle at unit amplitude with a lag of 0.1 rad encloses an area of π sin 0.1:

    >>> phase = np.linspace(0.0, 2.0 * np.pi, 1001)
    >>> float(tracking_indicator(np.sin(phase), np.sin(phase - 0.1))[-1].round(4))
    0.3136
    """
    middle_command = 0.5 * (command[1:] + command[:-1])
    middle_measured = 0.5 * (measured_displacement[1:] + measured_displacement[:-1])
    increments = middle_command * np.diff(measured_displacement) - middle_measured * np.diff(command)
    return np.concatenate([[0.0], 0.5 * np.cumsum(increments)])


@dataclass(frozen=True, kw_only=True)
class PhaseAmplitudeErrors:
    """Phase and amplitude error indices."""

    phase: float  # Phase lag of the measured displacement [rad], negative when it leads
    amplitude: float  # Measured over command amplitude, less one [-]


def phase_amplitude_errors(command: Array, measured_displacement: Array) -> PhaseAmplitudeErrors:
    """Phase and amplitude error indices from the ellipse of x_m over x_c, Hessabi and Mercan 2012.

    The ellipse is the one with the second moments of the trace, which stays meaningful when the
    amplitude varies; for a harmonic it is the trace itself. The direction of travel gives the sign.

    `command`, `measured_displacement`: displacements [m], shape (n,). Returns phase lag and
    relative amplitude error.

    >>> phase = np.linspace(0.0, 20.0 * np.pi, 20001)
    >>> found = phase_amplitude_errors(np.sin(phase), 0.98 * np.sin(phase - 0.05))
    >>> round(found.phase, 3), round(found.amplitude, 3)
    (0.05, -0.02)
    """
    amplitude = float(np.std(measured_displacement) / np.std(command))
    correlation = float(
        np.corrcoef(command, measured_displacement)[0, 1]
    )  # within ±1, rounding errors cut by NumPy
    direction = float(np.sign(tracking_indicator(command, measured_displacement)[-1]))
    return PhaseAmplitudeErrors(phase=direction * float(np.arccos(correlation)), amplitude=amplitude - 1.0)


def energy_error(command: Array, measured_displacement: Array, force: Array) -> Array:
    """Energy that the tracking error adds to the structure, Mosqueda and others 2007.

    The specimen does the work ∫r dx_m; the numerical substructure assumes the work ∫r dx_c. The structure
    receives the difference as energy that no ground motion supplied.

    `command`, `measured_displacement`: displacements [m], shape (n,); `force`: restoring force r of the
    specimen [N], shape (n,). Returns energy error [J] up to each sample, positive when energy is added,
    shape (n,).
    """
    middle_force = 0.5 * (force[1:] + force[:-1])
    return np.concatenate(
        [[0.0], np.cumsum(middle_force * (np.diff(measured_displacement) - np.diff(command)))]
    )


def delay_by_cross_correlation(command: Array, measured_displacement: Array, time_step: float) -> float:
    """Delay at which the cross-correlation of command and measured displacement is largest [s].

    `command`, `measured_displacement`: displacements [m], shape (n,); `time_step`: step between samples [s].
    Returns delay [s], refined between samples by a parabola; positive when the measured displacement lags.

    >>> t = np.arange(0.0, 20.0, 0.001)
    >>> command, measured = np.sin(2 * np.pi * t) * np.exp(-t / 5), np.zeros_like(t)
    >>> measured[4:] = command[:-4]
    >>> round(1e3 * delay_by_cross_correlation(command, measured, 0.001), 2)
    4.0
    """
    correlation = cross_correlate(measured_displacement, command)
    lags = np.arange(1 - command.size, command.size)
    best = int(np.argmax(correlation))
    shift = 0.0
    if 0 < best < correlation.size - 1:
        value_before, peak, value_after = correlation[best - 1 : best + 2]
        shift = 0.5 * (value_before - value_after) / (value_before - 2.0 * peak + value_after)
    return float((lags[best] + shift) * time_step)
