"""The earthquakes and stations of the synthetic suite: a distribution like that of the FEMA P-695 records.

FEMA P-695 (2009), Quantification of building seismic performance factors, Tables A-4 and A-6, lists the 50
stations of the far-field and near-field sets: 19 earthquakes of magnitude 6.5 to 7.9 (mean 6.98), half of the
stations on reverse faults, distances of 0.6 to 26 km (mean 10.0, standard deviation 6.5), V_S30 of 192 to
1000 m/s (median 385, standard deviation of its logarithm 0.43). The distributions below, once cut,
come close to these moments; nothing in them looks at a motion.

Wells, D. L. and Coppersmith, K. J. (1994), New empirical relationships among magnitude, rupture length,
rupture width, rupture area, and surface displacement, Bull. Seismol. Soc. Am. 84(4), 974-1002, Table 2A,
subsurface rupture length: log10(RLD) = a + b M, with the standard deviation s of log10(RLD).
"""

from dataclasses import dataclass
from math import atan2, cos, degrees, exp, log, pi, sin, sqrt
from typing import Final

import numpy as np
import scipy

from reliab.core.arrays import Array
from reliab.core.vocabulary import STANDARD_GRAVITY
from reliab.motions.synthetic.dabaghi_der_kiureghian_2018 import Mechanism, Scenario
from reliab.motions.synthetic.recording import RandomStream

# slip type: a, b, s
_TABLE_2A: Final = {
    Mechanism.STRIKE_SLIP: (-2.57, 0.62, 0.15),
    Mechanism.REVERSE: (-2.42, 0.58, 0.16),
}


def rupture_length(magnitude: float, mechanism: Mechanism, *, deviation: float = 0.0) -> float:
    """Length of the rupture below the ground [km].

    >>> round(rupture_length(7.0, Mechanism.STRIKE_SLIP), 1)
    58.9
    """
    a, b, s = _TABLE_2A[mechanism]
    return float(10.0 ** (a + b * magnitude + s * deviation))


# Magnitude: exponential above 6.5, cut at 7.9.
_SMALLEST_MAGNITUDE: Final = 6.5
_LARGEST_MAGNITUDE: Final = 7.9
_MAGNITUDE_RATE: Final = 1.4

# Reverse faults: half of all; a quarter of them broke the surface, the others lie 1 to 5 km below it.
_REVERSE_SHARE: Final = 0.5
_SURFACE_SHARE: Final = 0.25
_SHALLOWEST: Final = 1.0
_DEEPEST: Final = 5.0

# Distance [km]: Weibull, cut.
_DISTANCE_SCALE: Final = 11.1
_DISTANCE_SHAPE: Final = 1.5
_SHORTEST_DISTANCE: Final = 0.5
_LONGEST_DISTANCE: Final = 31.0

# Directivity length [km]: what the model was fitted to.
_DIRECTIVITY_LENGTHS: Final = (1.2, 135.0)

# V_S30 [m/s]: lognormal, cut.
_MEDIAN_VELOCITY: Final = 370.0
_VELOCITY_DEVIATION: Final = 0.52
_LOWEST_VELOCITY: Final = 180.0
_HIGHEST_VELOCITY: Final = 1000.0

# What a recording must exceed: peak acceleration [g] and peak velocity [m/s].
_STRONG_ACCELERATION: Final = 0.2
_STRONG_VELOCITY: Final = 0.15


@dataclass(frozen=True, kw_only=True)
class Earthquake:
    """What all stations of an earthquake share."""

    magnitude: float  # Moment magnitude
    mechanism: Mechanism  # Style of faulting
    depth_to_top: float  # Depth of the top of the rupture [km]
    length: float  # Length of the rupture along strike [km]
    hypocentre: float  # Distance of the hypocentre from one end of the rupture along strike [km]


def draw_earthquake(stream: RandomStream) -> Earthquake:
    """Draw an earthquake: exponential magnitude, either mechanism, hypocentre anywhere along the rupture."""
    range_ = _LARGEST_MAGNITUDE - _SMALLEST_MAGNITUDE
    cut = 1.0 - exp(-_MAGNITUDE_RATE * range_)
    magnitude = _SMALLEST_MAGNITUDE - log(1.0 - cut * stream.uniform()) / _MAGNITUDE_RATE
    mechanism = Mechanism.REVERSE if stream.uniform() < _REVERSE_SHARE else Mechanism.STRIKE_SLIP
    is_buried = stream.uniform() > _SURFACE_SHARE and mechanism is Mechanism.REVERSE
    depth = _SHALLOWEST + (_DEEPEST - _SHALLOWEST) * stream.uniform()
    length = rupture_length(magnitude, mechanism, deviation=float(scipy.special.ndtri(stream.uniform())))
    return Earthquake(
        magnitude=magnitude,
        mechanism=mechanism,
        depth_to_top=depth if is_buried else 0.0,
        length=length,
        hypocentre=length * stream.uniform(),
    )


def draw_scenario(earthquake: Earthquake, stream: RandomStream) -> Scenario:
    """Draw a station of an earthquake: its distance, its ground and its place along the rupture.

    The rupture is a straight line, and the station lies anywhere at its distance from it, with equal chance
    along that curve. The directivity length is the part of the rupture between the hypocentre and the point
    nearest to the station (s), for reverse faults too, where the length up dip (d) is the shorter one as a
    rule.
    """
    distance = _draw_distance(max(_SHORTEST_DISTANCE, earthquake.depth_to_top), stream)
    parallel, normal = _draw_site(earthquake.length, sqrt(distance**2 - earthquake.depth_to_top**2), stream)
    nearest = min(max(parallel, 0.0), earthquake.length)
    return Scenario(
        magnitude=earthquake.magnitude,
        mechanism=earthquake.mechanism,
        depth_to_top=earthquake.depth_to_top,
        rupture_distance=distance,
        shear_wave_velocity=_draw_velocity(stream),
        directivity_length=float(np.clip(abs(nearest - earthquake.hypocentre), *_DIRECTIVITY_LENGTHS)),
        directivity_angle=degrees(atan2(normal, abs(parallel - earthquake.hypocentre))),
    )


def _draw_distance(shortest: float, stream: RandomStream) -> float:
    nearest, farthest = (
        exp(-((limit / _DISTANCE_SCALE) ** _DISTANCE_SHAPE)) for limit in (shortest, _LONGEST_DISTANCE)
    )
    far_distance = farthest + (nearest - farthest) * stream.uniform()
    distance = float(_DISTANCE_SCALE * (-log(far_distance)) ** (1.0 / _DISTANCE_SHAPE))
    return min(max(distance, shortest), _LONGEST_DISTANCE)


def _draw_velocity(stream: RandomStream) -> float:
    lowest, highest = (
        float(scipy.special.ndtr(log(limit / _MEDIAN_VELOCITY) / _VELOCITY_DEVIATION))
        for limit in (_LOWEST_VELOCITY, _HIGHEST_VELOCITY)
    )
    normal = float(scipy.special.ndtri(lowest + (highest - lowest) * stream.uniform()))
    return float(_MEDIAN_VELOCITY * exp(_VELOCITY_DEVIATION * normal))


def _draw_site(length: float, distance: float, stream: RandomStream) -> tuple[float, float]:
    """Place of the station along and across strike [km], on the curve at a distance from the rupture."""
    quarter = 0.5 * pi * distance
    place = (length + 2.0 * quarter) * stream.uniform()
    if place < quarter:
        angle = place / distance
        return -distance * cos(angle), distance * sin(angle)
    if place < quarter + length:
        return place - quarter, distance
    angle = (place - quarter - length) / distance
    return length + distance * sin(angle), distance * cos(angle)


def is_strong(components: Array, time_step: float) -> bool:
    """Tell whether a recording would have been taken into the FEMA P-695 sets.

    The rule (section A.7) asks for a peak ground acceleration above 0.2 g and a peak ground velocity above 15
    cm/s, of the larger component.

    `components` (2, n) [m/s²]; `time_step` [s].

    >>> is_strong(np.array([[0.0, 3.0, 0.0], [0.0, 0.0, 0.0]]), time_step=0.1)
    True
    """
    velocity = np.cumsum(0.5 * (components[:, 1:] + components[:, :-1]), axis=1) * time_step
    acceleration = np.abs(components).max() / STANDARD_GRAVITY
    return bool(acceleration > _STRONG_ACCELERATION and np.abs(velocity).max() > _STRONG_VELOCITY)
