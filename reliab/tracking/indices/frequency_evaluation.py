"""Frequency-domain evaluation index (FEI) of actuator tracking, Guo and others 2014 and 2017.

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
"""

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.signals.spectra import taper

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
    command: Array, measured: Array, time_step: float, *, window: str = "hann"
) -> FrequencyEvaluation:
    """Evaluate how an actuator tracked its command, equations (1)–(5).

    `command`, `measured` [m]; `time_step` [s].

    >>> t = np.arange(0.0, 40.0, 1.0 / 1024.0)
    >>> command, measured = np.sin(2 * np.pi * t), 1.01 * np.sin(2 * np.pi * (t - 0.002))
    >>> found = frequency_evaluation(command, measured, 1.0 / 1024.0)
    >>> round(found.amplitude, 4), round(1e3 * found.equivalent_delay, 3)
    (1.01, 2.0)
    """
    return CommandSpectrum(command=command, time_step=time_step, window=window).evaluate(measured)


@dataclass(frozen=True, kw_only=True, eq=False)
class CommandSpectrum:
    """A command [m] beside which measured displacements are evaluated, one after the other."""

    command: Array
    time_step: float  # [s]
    window: str = "hann"

    def evaluate(self, measured: Array) -> FrequencyEvaluation:
        """Evaluate one as :func:`frequency_evaluation` does."""
        _check(self.command, measured)
        into, total, frequency = self._into
        index = np.sum(self._spectrum(measured) * into.conj()) / total
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
    def _into(self) -> tuple[NDArray[np.complex128], float, float]:
        """Spectrum of the command, the sum of its power, and the equivalent frequency [Hz]."""
        into = self._spectrum(self.command)
        power = np.abs(into) ** 2
        total, frequencies = power.sum(), np.fft.rfftfreq(self._points, self.time_step)[1:]
        return into, total, float(np.sum(power * frequencies) / total)


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


def _check(command: Array, measured: Array) -> None:
    if command.shape != measured.shape or command.size < _FEWEST_SAMPLES:
        raise InputError(
            f"Command and measured displacement must have the same length of at least {_FEWEST_SAMPLES} "
            "samples",
            value=f"{command.size} and {measured.size} samples",
            remedy="Cut both histories to the same stretch of the test",
        )
    if np.ptp(command) == 0.0:
        raise InputError(
            "The command does not move",
            remedy="Check that the column of the command is the right one",
        )
