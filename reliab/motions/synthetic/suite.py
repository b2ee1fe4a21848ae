"""The synthetic suite: names, order, and motions that are simulated when they are needed."""

from dataclasses import dataclass
from functools import lru_cache
from threading import Lock
from typing import Final

from reliab.core.errors import InputError
from reliab.motions.motion import Motion
from reliab.motions.suite import MotionSuite
from reliab.motions.synthetic.event import Recording, simulate_event
from reliab.motions.synthetic.recording import TIME_STEP

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

    def recording(self) -> Recording:
        """Simulate the recording that the motion is a component of, with its scenario and parameters."""
        return _event(self.seed, self.number).at(self.station)

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
        self._simulated: list[Recording] = []
        self._lock = Lock()

    def at(self, station: int) -> Recording:
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
