"""Probability that a near-fault motion holds a velocity pulse.

Shahi, S. K. and Baker, J. W. (2014), An efficient algorithm to identify strong-velocity pulses in
multicomponent ground motions, Bull. Seismol. Soc. Am. 104(5), 2456-2466: a logistic regression on the closest
distance R, the larger of the directivity lengths s and d, and the matching angle θ or φ.
"""

from math import exp, sqrt
from typing import Final

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
