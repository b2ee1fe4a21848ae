"""The acceleration of the velocity pulse of a near-fault motion."""

from math import pi, sin

import numpy as np

from reliab.arrays import Array
from reliab.motions.synthetic.parameters import PulseParameters


def pulse_acceleration(pulse: PulseParameters, times: Array) -> Array:
    """Acceleration of the pulse at each time.

    The velocity is an oscillation under a raised cosine, as Mavroeidis & Papageorgiou (2003) have it, less
    the part that Dabaghi & Der Kiureghian (2017) take out to leave no residual displacement. With u = t −
    t_max and within |u| ≤ γT/2,

        v = (V/2 cos(2πu/T + φ) − D/(γT)) (1 + cos(2πu/(γT))),
        D = VT (sin(φ + γπ) − sin(φ − γπ)) / (4π (1 − γ²)).

    `times` (n,) [s]; returns (n,) [m/s²].

    Mavroeidis, G. P. and Papageorgiou, A. S. (2003), Bull. Seismol. Soc. Am. 93(3), 1099-1131.
    """
    gamma, omega = pulse.oscillations, 2.0 * pi / pulse.period
    swing = sin(pulse.phase + gamma * pi) - sin(pulse.phase - gamma * pi)
    offset = pulse.velocity * swing / (4.0 * pi * (1.0 - gamma**2) * gamma)
    half_length = 0.5 * gamma * pulse.period
    time = np.clip(times - pulse.peak_time, -half_length, half_length)
    carrier = 0.5 * pulse.velocity * np.cos(omega * time + pulse.phase) - offset
    carrier_rate = -0.5 * pulse.velocity * omega * np.sin(omega * time + pulse.phase)
    envelope = 1.0 + np.cos(omega / gamma * time)
    envelope_rate = -omega / gamma * np.sin(omega / gamma * time)
    return carrier_rate * envelope + carrier * envelope_rate
