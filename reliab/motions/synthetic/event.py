"""One synthetic earthquake: its stations, and two components at each.

Shahi, S. K. and Baker, J. W. (2014), An efficient algorithm to identify strong-velocity pulses in
multicomponent ground motions, Bull. Seismol. Soc. Am. 104(5), 2456-2466: a logistic regression on the closest
distance R, the larger of the directivity lengths s and d, and the matching angle θ or φ.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import IntEnum
from functools import partial
from itertools import count
from math import exp, pi, sqrt
from typing import Final, TypeVar

import numpy as np

from reliab.core.arrays import Array
from reliab.core.vocabulary import STANDARD_GRAVITY
from reliab.motions.synthetic.dabaghi_der_kiureghian_2018 import Regression
from reliab.motions.synthetic.fema_p695_2009 import Earthquake, draw_earthquake, draw_scenario, is_strong
from reliab.motions.synthetic.parameters import RecordingParameters, physical_parameters, regression_of
from reliab.motions.synthetic.random_stream import RandomStream
from reliab.motions.synthetic.recording import TIME_STEP, simulate_recording, trim_quiet_ends, turned
from reliab.motions.synthetic.scenario import Mechanism, Scenario

_Result = TypeVar("_Result")

_CUT: Final = 2.0
"""Errors beyond this many standard deviations are drawn again, as in Dabaghi & Der Kiureghian (2018)."""

EVENT_SHARE: Final = 0.35
"""Share of the error's variance that the stations of one earthquake have in common.

The published regression gives the whole error only. Its parent, Rezaeian & Der Kiureghian (2010), separates
the inter-event error η from the intra-event error ε: τ²/(τ² + σ²) is 0.18, 0.39, 0.60, 0.48, 0.02 and 0.45
for its six parameters (τ = 0.274, 0.457, 0.511, 0.692, 0.129, 0.682; σ = 0.594, 0.569, 0.414, 0.723, 0.953,
0.760), 0.35 on average. One share for all parameters keeps the published correlations within both parts.
"""


class EventErrors:
    """Draws the errors of the stations of one earthquake, one after the other.

    The error of a station is η + ε, of which η is the same for all stations of the earthquake. The first
    station has exactly the published distribution, given that its motion is accepted; η then follows from its
    error, so that what comes first does not depend on how many stations come after it.
    """

    def __init__(self, regression: Regression, stream: RandomStream) -> None:
        self._regression = regression
        self._stream = stream
        self._shared: Array | None = None

    def draw(self, stream: RandomStream, attempt: Callable[[Array], _Result | None]) -> _Result:
        """Draw errors for the next station until one of them gives a motion."""
        shared, scale = (0.0, 1.0) if self._shared is None else (self._shared, sqrt(1.0 - EVENT_SHARE))
        while True:
            standard = shared + scale * self._draw_correlated(stream)
            if np.abs(standard).max() > _CUT:
                continue
            result = attempt(standard * self._regression.deviations)
            if result is not None:
                self._share(standard)
                return result

    def _share(self, standard: Array) -> None:
        """Draw η from its distribution given the whole error of the first station."""
        if self._shared is None:
            remainder = sqrt(EVENT_SHARE * (1.0 - EVENT_SHARE)) * self._draw_correlated(self._stream)
            self._shared = EVENT_SHARE * standard + remainder

    def _draw_correlated(self, stream: RandomStream) -> Array:
        normals = stream.normals(self._regression.deviations.size)
        correlated: Array = np.sum(self._regression.factor * normals, axis=1)
        return correlated


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


QUANTUM: Final = 1e-6 * STANDARD_GRAVITY
"""Accelerations are whole multiples of this [m/s²], so that rounding on other processors hardly matters."""


class _Purpose(IntEnum):
    """What a stream of random numbers is for; the values are part of the suite's definition."""

    EARTHQUAKE = 0
    SHARED_ERROR = 1
    SHARED_ERROR_OF_PULSES = 2
    SCENARIO = 3
    PULSE = 4
    ERROR = 5
    ORIENTATION = 6
    NOISE_FIRST = 7
    NOISE_SECOND = 8


_Streams = Callable[[_Purpose], RandomStream]


@dataclass(frozen=True, kw_only=True, eq=False)
class Recording:
    """What one station recorded."""

    scenario: Scenario  # The earthquake as seen from the station
    parameters: RecordingParameters  # Parameters that the components were built from
    # Horizontal acceleration along the axes of the instrument [m/s²], every 0.01 s, shape (2, n)
    components: Array


def simulate_event(seed: int, number: int) -> Iterator[Recording]:
    """Simulate the recordings of one earthquake, one station after the other, without limit.

    >>> recording = next(simulate_event(2017, 1))
    >>> round(recording.scenario.magnitude, 2), recording.components.shape
    (6.83, (2, 6402))
    """
    streams = partial(_stream, seed, number, 0)
    earthquake = draw_earthquake(streams(_Purpose.EARTHQUAKE))
    errors = {
        False: EventErrors(regression_of(pulse_like=False), streams(_Purpose.SHARED_ERROR)),
        True: EventErrors(regression_of(pulse_like=True), streams(_Purpose.SHARED_ERROR_OF_PULSES)),
    }
    for station in count(1):
        yield _simulate_station(earthquake, errors, partial(_stream, seed, number, station))


def _stream(seed: int, number: int, station: int, purpose: _Purpose) -> RandomStream:
    return RandomStream(seed, number, station, purpose)


def _simulate_station(
    earthquake: Earthquake, errors: dict[bool, EventErrors], streams: _Streams
) -> Recording:
    scenario = draw_scenario(earthquake, streams(_Purpose.SCENARIO))
    pulse_like = streams(_Purpose.PULSE).uniform() < pulse_probability(scenario)
    means = regression_of(pulse_like=pulse_like).means(scenario)
    angle = 2.0 * pi * streams(_Purpose.ORIENTATION).uniform()
    noises = streams(_Purpose.NOISE_FIRST), streams(_Purpose.NOISE_SECOND)

    def attempt(error: Array) -> Recording | None:
        parameters = physical_parameters(means + error, pulse_like=pulse_like)
        if parameters.pulse is not None and parameters.pulse.start < 0.0:
            return None
        components = _record(parameters, scenario.magnitude, noises, angle)
        if not is_strong(components, TIME_STEP):
            return None
        return Recording(scenario=scenario, parameters=parameters, components=components)

    return errors[pulse_like].draw(streams(_Purpose.ERROR), attempt)


def _record(
    parameters: RecordingParameters, magnitude: float, noises: tuple[RandomStream, RandomStream], angle: float
) -> Array:
    motion = simulate_recording(parameters, magnitude, noises)
    rounded = np.round(trim_quiet_ends(turned(motion, angle)) / QUANTUM) * QUANTUM
    rounded.flags.writeable = False
    return rounded
