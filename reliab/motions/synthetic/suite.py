"""The synthetic suite: names, order, and motions that are simulated when they are needed."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import IntEnum
from functools import lru_cache, partial
from itertools import count
from math import exp, pi, sqrt
from threading import Lock
from typing import Final, TypeVar

import numpy as np

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.vocabulary import STANDARD_GRAVITY
from reliab.motions.motion import Motion
from reliab.motions.suite import MotionSuite
from reliab.motions.synthetic.dabaghi_der_kiureghian_2018 import (
    Mechanism,
    RecordingParameters,
    Regression,
    Scenario,
    physical_parameters,
    regression_of,
)
from reliab.motions.synthetic.fema_p695_2009 import Earthquake, draw_earthquake, draw_scenario, is_strong
from reliab.motions.synthetic.recording import (
    TIME_STEP,
    RandomStream,
    rotate,
    simulate_recording,
    trim_quiet_ends,
)

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
        errors: Array = np.sum(self._regression.factor * normals, axis=1)
        return errors


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
class StationRecord:
    """What one station recorded."""

    scenario: Scenario  # The earthquake as seen from the station
    parameters: RecordingParameters  # Parameters that the components were built from
    # Horizontal acceleration along the axes of the instrument [m/s²], every 0.01 s, shape (2, n)
    components: Array


def simulate_event(seed: int, number: int) -> Iterator[StationRecord]:
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
) -> StationRecord:
    scenario = draw_scenario(earthquake, streams(_Purpose.SCENARIO))
    pulse_like = streams(_Purpose.PULSE).uniform() < pulse_probability(scenario)
    means = regression_of(pulse_like=pulse_like).means(scenario)
    angle = 2.0 * pi * streams(_Purpose.ORIENTATION).uniform()
    noises = streams(_Purpose.NOISE_FIRST), streams(_Purpose.NOISE_SECOND)

    def attempt(error: Array) -> StationRecord | None:
        parameters = physical_parameters(means + error, pulse_like=pulse_like)
        if parameters.pulse is not None and parameters.pulse.start < 0.0:
            return None
        components = _record(parameters, scenario.magnitude, noises, angle)
        if not is_strong(components, TIME_STEP):
            return None
        return StationRecord(scenario=scenario, parameters=parameters, components=components)

    return errors[pulse_like].draw(streams(_Purpose.ERROR), attempt)


def _record(
    parameters: RecordingParameters, magnitude: float, noises: tuple[RandomStream, RandomStream], angle: float
) -> Array:
    motion = simulate_recording(parameters, magnitude, noises)
    samples = np.round(trim_quiet_ends(rotate(motion, angle)) / QUANTUM) * QUANTUM
    samples.flags.writeable = False
    return samples


SET_NAME: Final = "synthetic"
"""Set that every synthetic motion belongs to."""

_COMPONENTS: Final = 2


@dataclass(frozen=True, kw_only=True)
class SyntheticEntry:
    """A motion of the synthetic suite before it is simulated."""

    seed: int  # Seed of the suite
    number: int  # Number of the earthquake, from 1
    station: int  # Number of the station within the earthquake, from 1
    component: int  # Number of the horizontal component, 1 or 2

    @property
    def name(self) -> str:
        """Unique name, for example ``SYN001/H1``, or ``SYN001/S2H1`` at the second station."""
        station = f"S{self.station}" if self.station > 1 else ""
        return f"{self.event}/{station}H{self.component}"

    @property
    def event(self) -> str:
        """The earthquake, for example ``SYN001``."""
        return f"SYN{self.number:03d}"

    @property
    def set_name(self) -> str:
        """Set of every synthetic motion."""
        return SET_NAME

    def recording(self) -> StationRecord:
        """Simulate the recording that the motion is a component of, with its scenario and parameters."""
        return _event(self.seed, self.number).record(self.station)

    def load(self) -> Motion:
        """Simulate the motion."""
        return Motion(
            name=self.name,
            acceleration=self.recording().components[self.component - 1],
            time_step=TIME_STEP,
            event=self.event,
            set_name=self.set_name,
        )


class _RecordingsOfEvent:
    """The recordings of an earthquake, simulated up to the station that was asked for."""

    def __init__(self, seed: int, number: int) -> None:
        self._source = simulate_event(seed, number)
        self._simulated: list[StationRecord] = []
        self._lock = Lock()

    def record(self, station: int) -> StationRecord:
        with self._lock:
            while len(self._simulated) < station:
                self._simulated.append(next(self._source))
        return self._simulated[station - 1]


@lru_cache(maxsize=32)
def _event(seed: int, number: int) -> _RecordingsOfEvent:
    """Keep the latest earthquakes, because their motions are asked for one after the other."""
    return _RecordingsOfEvent(seed, number)


def synthetic_entries(
    *, count: int = 100, seed: int = 2017, stations_per_event: int = 1
) -> list[SyntheticEntry]:
    """List the entries of the suite that `synthetic_suite` makes of the same arguments.

    >>> [entry.name for entry in synthetic_entries(count=3, stations_per_event=2)]
    ['SYN001/H1', 'SYN001/H2', 'SYN001/S2H1']
    """
    _require("number of motions", count, smallest=1)
    _require("seed", seed, smallest=0)
    _require("number of stations per event", stations_per_event, smallest=1)
    entries = []
    for index in range(count):
        recording, component = divmod(index, _COMPONENTS)
        event, station = divmod(recording, stations_per_event)
        entries.append(
            SyntheticEntry(seed=seed, number=event + 1, station=station + 1, component=component + 1)
        )
    return entries


def synthetic_suite(*, count: int = 100, seed: int = 2017, stations_per_event: int = 1) -> MotionSuite:
    """Make the built-in suite of synthetic near-fault ground motions.

    For each event a scenario is drawn from a distribution like that of the FEMA P-695 records, and
    two horizontal components of the stochastic model of Dabaghi & Der Kiureghian (2018), along the axes of an
    instrument of random orientation. Recordings too weak for FEMA P-695 are drawn again.

    A motion is fixed by the seed, its event, its station and its component: neither the number of motions nor
    the number of stations changes it. Accelerations are whole multiples of 1e-6 g. On one computer the bytes
    are always the same; elsewhere, a sample may differ by that one step in the rare case that its value
    before rounding lies within about 1e-13 g of a tie.

    Returns motions named ``SYN001/H1``, ``SYN001/H2``, ``SYN002/H1`` and so on, of events ``SYN001``,
    ``SYN002``, …

    >>> suite = synthetic_suite(count=4)
    >>> suite.names
    ('SYN001/H1', 'SYN001/H2', 'SYN002/H1', 'SYN002/H2')
    >>> suite[0].time_step, round(suite[0].duration, 2)
    (0.01, 64.01)
    """
    return MotionSuite(synthetic_entries(count=count, seed=seed, stations_per_event=stations_per_event))


def _require(quantity: str, value: int, *, smallest: int) -> None:
    if value < smallest:
        raise InputError(f"The {quantity} must be at least {smallest}", value=value)
