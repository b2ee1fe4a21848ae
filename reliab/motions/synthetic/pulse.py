"""The velocity pulse of a near-fault motion: its probability and its acceleration.

The probability is the logistic regression of Shahi, S. K. and Baker, J. W. (2014), An efficient algorithm to
identify strong-velocity pulses in multicomponent ground motions, Bull. Seismol. Soc. Am. 104(5), 2456-2466,
on the closest distance R, the larger of the directivity lengths s and d, and the matching angle θ or φ.
"""

from math import exp, pi, sin, sqrt
from typing import Final

import numpy as np

from reliab.arrays import Array
from reliab.motions.synthetic.parameters import PulseParameters
from reliab.motions.synthetic.scenario import Mechanism, Scenario

# The constant, then the factors of R [km], of the root of s or d [km], and of θ or φ in degrees.
_COEFFICIENTS: Final = {
    Mechanism.STRIKE_SLIP: (0.457, 0.126, -0.244, 0.013),
    Mechanism.REVERSE: (0.304, 0.072, -0.208, 0.021),
}


def pulse_probability(scenario: Scenario) -> float:
    """Probability of a pulse at the station of a scenario.

    >>> scenario = Scenario(
    ...     magnitude=7.0,
    ...     mechanism=Mechanism.STRIKE_SLIP,
    ...     depth_to_top=0.0,
    ...     rupture_distance=5.0,
    ...     shear_wave_velocity=360.0,
    ...     directivity_length=25.0,
    ...     directivity_angle=10.0,
    ... )
    >>> round(pulse_probability(scenario), 3)
    0.501
    """
    constant, distance, length, angle = _COEFFICIENTS[scenario.mechanism]
    logit = (
        constant
        + distance * scenario.rupture_distance
        + length * sqrt(scenario.directivity_length)
        + angle * scenario.directivity_angle
    )
    return 1.0 / (1.0 + exp(logit))


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
