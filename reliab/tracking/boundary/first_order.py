r"""Closed form of the ellipse for small errors: a and b from the record's spectrum alone.

To first order in the actuator's error u − 1 ≈ (k_p − 1) − iωτ, the measured displacement strays from the
exact response by (u − 1) times

.. math:: Z(ω) = -A_g(ω) \frac{ω_0^2 (1 - α) - ω^2 + 2iξω_0ω}{(ω_0^2 - ω^2 + 2iξω_0ω)^2}

so that RMS^R² = [(k_p − 1)² P + τ² Q] / peak² with the mean squares P of Z and Q of iωZ over the window. The
contour of an error ε is then an ellipse with a = ε² peak²/P and b = ε² peak²/Q.

**What a depends on.** With α = 1 and near resonance Z is the exact response x filtered once more by the same
oscillator and divided by 2iξ: a low-pass filter of its envelope with the time constant 1/(ξω₀). Hence

.. math:: a ≈ 4 ξ² ε² \frac{T}{T_x g},  T_x = \frac{∫x²dt}{\max x²}

with the length T of the window, the effective duration T_x of the response, and the share g ≤ 1 of its energy
that the filter lets through. g is 1/2 for a steady response to broad-band motion and for the free vibration
after a short pulse, 1 for a steady resonance, and (ξω₀T)²/3 where a steady vibration is cut before the error
has built up.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy

from reliab.core.arrays import Array, Spectrum
from reliab.core.vocabulary import MILLI
from reliab.signals.filters import filter_recursively
from reliab.simulation.excitation import Excitation, peak_of_history
from reliab.simulation.linear_loop.spectral import respond
from reliab.structures.structure import Structure


@dataclass(frozen=True, kw_only=True)
class FirstOrderEllipse:
    """Ellipse parameters per squared error, exact in the limit of small errors."""

    amplitude: float  # a/ε² [-], for a small RMS^R ε
    delay: float  # b/ε² [ms²]
    effective_duration: float  # ∫x²dt/max x² of the exact response x [s]
    duration: float  # Length of the window T [s]

    def parameters(self, threshold: float) -> tuple[float, float]:
        """Ellipse parameters of an error.

        `threshold` [-].

        >>> ellipse = FirstOrderEllipse(amplitude=0.05, delay=1000.0, effective_duration=4.0, duration=30.0)
        >>> ellipse.parameters(0.05)
        (0.000125..., 2.5...)
        """
        return self.amplitude * threshold**2, self.delay * threshold**2


def first_order_ellipse(excitation: Excitation, structure: Structure) -> FirstOrderEllipse:
    """Predict the ellipse of RMS^R from the record's spectrum, without simulating a test.

    `excitation`: the record and the window over which errors are computed. Returns a and b per squared error.

    A resonant pulse: the more damped structure tolerates more.

    >>> t = np.arange(0.0, 20.0, 0.01)
    >>> pulse = Excitation(acceleration=np.sin(2.0 * np.pi * t) * np.exp(-t), time_step=0.01)
    >>> light, heavy = (Structure(frequency=1.0, damping_ratio=xi) for xi in (0.02, 0.08))
    >>> first_order_ellipse(pulse, light).amplitude < first_order_ellipse(pulse, heavy).amplitude
    True
    """
    w0, xi = structure.circular_frequency, structure.damping_ratio
    numerical_fraction = 1.0 - structure.experimental_fraction

    def dynamic(s: Spectrum, stiffness: float) -> Spectrum:
        return np.asarray(s**2 + 2.0 * xi * w0 * s + w0**2 * stiffness)

    def to_gain(s: Spectrum) -> Spectrum:
        return np.asarray(dynamic(s, numerical_fraction) / dynamic(s, 1.0) ** 2)

    exact, step = respond(excitation, lambda s: 1.0 / dynamic(s, 1.0))
    gain_error, _ = respond(excitation, to_gain)
    delay_error, _ = respond(excitation, lambda s: -s * to_gain(s))
    peak = peak_of_history(exact)
    duration = excitation.window_duration
    squares = [float(np.trapezoid(response**2, dx=step)) for response in (exact, gain_error, delay_error)]
    return _ellipse_from_integrals(squares, peak, duration)


def ellipse_of_response(response: Array, time_step: float, structure: Structure) -> FirstOrderEllipse:
    """Predict the ellipse of RMS^R from the exact response of the structure, as a test shows it.

    `response`: exact displacement from rest, in any unit, shape (n,); `time_step`: step between samples [s].
    Returns a and b per squared error, over the whole response.

    A steady resonance, long after it began: a = 4 ξ² ε² T/T_x, and T_x is half of the length.

    >>> steady = np.sin(0.01 * np.pi * np.arange(80_000))
    >>> ellipse = ellipse_of_response(steady, 0.005, Structure(frequency=1.0, damping_ratio=0.05))
    >>> round(ellipse.effective_duration), round(ellipse.amplitude / (4 * 0.05**2), 1)
    (200, 2.0)
    """
    histories = error_histories(response, time_step, structure)
    squares = [float(np.trapezoid(history**2, dx=time_step)) for history in histories]
    return _ellipse_from_integrals(squares, float(np.abs(response).max()), (response.size - 1) * time_step)


def exact_response(acceleration: Array, time_step: float, structure: Structure) -> Array:
    """Exact displacement [m] from rest at the samples of a ground acceleration [m/s²], linear in between."""
    oscillator = _discretise_oscillator(structure.circular_frequency, structure.damping_ratio, time_step)
    return filter_recursively(*oscillator, -acceleration)


def error_histories(response: Array, time_step: float, structure: Structure) -> tuple[Array, Array, Array]:
    """Exact response x, its error Z for an amplitude error of one, and dZ/dt, that for a delay of 1 s."""
    w0, xi = structure.circular_frequency, structure.damping_ratio
    oscillator_response = filter_recursively(*_discretise_oscillator(w0, xi, time_step), response)
    gain_error = response - structure.experimental_fraction * w0**2 * oscillator_response
    return response, gain_error, np.gradient(gain_error, time_step)


@lru_cache(maxsize=1024)  # the motions of a suite share their steps
def _discretise_oscillator(w0: float, xi: float, step: float) -> tuple[Array, Array]:
    """Coefficients of the recursion of x'' + 2 ξ ω₀ x' + ω₀² x = u, exact for straight lines in a step."""
    system = np.zeros((4, 4))  # states, u and the rise of u in a step
    system[:2] = step * np.array([[0.0, 1.0, 0.0, 0.0], [-(w0**2), -2.0 * xi * w0, 1.0, 0.0]])
    system[2, 3] = 1.0
    step_matrix = scipy.linalg.expm(system)
    states, constant_load, rising = step_matrix[:2, :2], step_matrix[:2, 2:3], step_matrix[:2, 3:]
    input_vector = constant_load - rising + states @ rising
    denominator = np.poly(states)
    read = np.poly(states - input_vector @ np.array([[1.0, 0.0]]))
    return np.asarray(read + (rising[0, 0] - 1.0) * denominator), np.asarray(denominator)


def _ellipse_from_integrals(squares: Sequence[float], peak: float, duration: float) -> FirstOrderEllipse:
    """Ellipse from the integrals of the squares of x, Z and dZ/dt, the peak of x and the length [s]."""
    energy, gain_energy, delay_energy = (square / peak**2 for square in squares)
    return FirstOrderEllipse(
        amplitude=duration / gain_energy,
        delay=MILLI**2 * duration / delay_energy,
        effective_duration=energy,
        duration=duration,
    )
