"""The synthetic suite: names, order, and motions that are simulated when they are needed."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from functools import lru_cache
from math import exp, pi, sqrt
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
from reliab.motions.synthetic.fema_p695_2009 import draw_earthquake, draw_scenario, is_strong
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


def draw_errors(
    regression: Regression, stream: RandomStream, attempt: Callable[[Array], _Result | None]
) -> _Result:
    """Draw errors of the transformed parameters until some of them give a motion."""
    while True:
        normals = stream.normals(regression.deviations.size)
        standard: Array = np.sum(regression.factor * normals, axis=1)
        if np.abs(standard).max() <= _CUT:
            result = attempt(standard * regression.deviations)
            if result is not None:
                return result


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
    SCENARIO = 3
    PULSE = 4
    ERROR = 5
    ORIENTATION = 6
    NOISE_FIRST = 7
    NOISE_SECOND = 8


@dataclass(frozen=True, kw_only=True, eq=False)
class StationRecord:
    """What one station recorded."""

    scenario: Scenario  # The earthquake as seen from the station
    parameters: RecordingParameters  # Parameters that the components were built from
    # Horizontal acceleration along the axes of the instrument [m/s²], every 0.01 s, shape (2, n)
    components: Array


@lru_cache(maxsize=32)
def simulate_event(seed: int, number: int) -> StationRecord:
    """Simulate the recording of one earthquake; the latest are kept, for the other component of each.

    >>> recording = simulate_event(2017, 1)
    >>> round(recording.scenario.magnitude, 2), recording.components.shape
    (6.83, (2, 6402))
    """

    def stream(purpose: _Purpose) -> RandomStream:
        is_of_event = purpose is _Purpose.EARTHQUAKE
        return RandomStream(seed, number, 0 if is_of_event else 1, purpose)

    scenario = draw_scenario(draw_earthquake(stream(_Purpose.EARTHQUAKE)), stream(_Purpose.SCENARIO))
    pulse_like = stream(_Purpose.PULSE).uniform() < pulse_probability(scenario)
    regression = regression_of(pulse_like=pulse_like)
    means = regression.means(scenario)
    angle = 2.0 * pi * stream(_Purpose.ORIENTATION).uniform()
    noises = stream(_Purpose.NOISE_FIRST), stream(_Purpose.NOISE_SECOND)

    def attempt(error: Array) -> StationRecord | None:
        parameters = physical_parameters(means + error, pulse_like=pulse_like)
        if parameters.pulse is not None and parameters.pulse.start < 0.0:
            return None
        components = _record(parameters, scenario.magnitude, noises, angle)
        if not is_strong(components, TIME_STEP):
            return None
        return StationRecord(scenario=scenario, parameters=parameters, components=components)

    return draw_errors(regression, stream(_Purpose.ERROR), attempt)


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
    component: int  # Number of the horizontal component, 1 or 2

    @property
    def name(self) -> str:
        """Unique name, for example ``SYN001/H1``."""
        return f"{self.event}/H{self.component}"

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
        return simulate_event(self.seed, self.number)

    def load(self) -> Motion:
        """Simulate the motion."""
        return Motion(
            name=self.name,
            acceleration=self.recording().components[self.component - 1],
            time_step=TIME_STEP,
            event=self.event,
            set_name=self.set_name,
        )


def synthetic_entries(*, count: int = 100, seed: int = 2017) -> list[SyntheticEntry]:
    """List the entries of the suite that `synthetic_suite` makes of the same arguments.

    >>> [entry.name for entry in synthetic_entries(count=3)]
    ['SYN001/H1', 'SYN001/H2', 'SYN002/H1']
    """
    for quantity, value, smallest in (("number of motions", count, 1), ("seed", seed, 0)):
        if value < smallest:
            raise InputError(f"The {quantity} must be at least {smallest}", value=value)
    places = (divmod(index, _COMPONENTS) for index in range(count))
    return [
        SyntheticEntry(seed=seed, number=event + 1, component=component + 1) for event, component in places
    ]


def synthetic_suite(*, count: int = 100, seed: int = 2017) -> MotionSuite:
    """Make the built-in suite of synthetic near-fault ground motions.

    For each event a scenario is drawn from a distribution like that of the FEMA P-695 records, and
    two horizontal components of the stochastic model of Dabaghi & Der Kiureghian (2018), along the axes of an
    instrument of random orientation. Recordings too weak for FEMA P-695 are drawn again.

    A motion is fixed by the seed, its event and its component: the number of motions does not change it.
    Accelerations are whole multiples of 1e-6 g. On one computer the bytes are always the same; elsewhere, a
    sample may differ by that one step in the rare case that its value before rounding lies within about
    1e-13 g of a tie.

    Returns motions named ``SYN001/H1``, ``SYN001/H2``, ``SYN002/H1`` and so on, of events ``SYN001``,
    ``SYN002``, …

    >>> suite = synthetic_suite(count=4)
    >>> suite.names
    ('SYN001/H1', 'SYN001/H2', 'SYN002/H1', 'SYN002/H2')
    >>> suite[0].time_step, round(suite[0].duration, 2)
    (0.01, 64.01)
    """
    return MotionSuite(synthetic_entries(count=count, seed=seed))
