"""One synthetic earthquake: its stations, and two components at each."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import IntEnum
from functools import partial
from itertools import count
from math import pi
from typing import Final

import numpy as np

from reliab.arrays import Array
from reliab.motions.synthetic.event_errors import EventErrors
from reliab.motions.synthetic.fema_p695_2009 import Earthquake, draw_earthquake, draw_scenario, is_strong
from reliab.motions.synthetic.parameters import RecordingParameters, physical_parameters, regression_of
from reliab.motions.synthetic.random_stream import RandomStream
from reliab.motions.synthetic.recording import TIME_STEP, simulate_recording, trim_quiet_ends, turned
from reliab.motions.synthetic.scenario import Scenario
from reliab.motions.synthetic.shahi_baker_2014 import pulse_probability
from reliab.vocabulary import STANDARD_GRAVITY

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
