r"""Closed form of the ellipse for small errors: a and b from the record's spectrum alone.

To first order in the actuator's error u − 1 ≈ (k_p − 1) − iωτ, the measured displacement strays from the
exact response by (u − 1) times

.. math:: Z(ω) = -A_g(ω) \frac{ω_0^2 (1 - α) - ω^2 + 2iξω_0ω}{(ω_0^2 - ω^2 + 2iξω_0ω)^2}

so that RMS^R² = [(k_p − 1)² P + τ² Q] / peak² with the mean squares P of Z and Q of iωZ over the window. The
contour of an error ε is then an ellipse with a = ε² peak²/P and b = ε² peak²/Q.
"""

from dataclasses import dataclass

import numpy as np

from reliab.arrays import Spectrum
from reliab.simulation import Excitation, peak_of_history
from reliab.simulation.linear_loop import respond
from reliab.structures import Structure
from reliab.vocabulary import MILLI


@dataclass(frozen=True, kw_only=True)
class FirstOrderEllipse:
    """Ellipse parameters per squared error, exact in the limit of small errors."""

    amplitude: float  # a/ε² [-], for a small RMS^R ε
    delay: float  # b/ε² [ms²]

    def parameters(self, threshold: float) -> tuple[float, float]:
        """Ellipse parameters of an error.

        `threshold` [-].

        >>> FirstOrderEllipse(amplitude=0.05, delay=1000.0).parameters(0.05)
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
    of_gain, _ = respond(excitation, to_gain)
    of_delay, _ = respond(excitation, lambda s: -s * to_gain(s))
    peak = peak_of_history(exact)
    duration = excitation.window_duration
    by_gain, by_delay = (np.trapezoid(response**2, dx=step) / duration for response in (of_gain, of_delay))
    return FirstOrderEllipse(amplitude=float(peak**2 / by_gain), delay=float(MILLI**2 * peak**2 / by_delay))
