"""A measured campaign: the operator's nominal model, and the tests."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from reliab.core.errors import InputError
from reliab.core.plain_values import Keys, ResultWithRows, plot_histories
from reliab.simulation.hybrid_test.model import Actuator, HybridTest
from reliab.structures.frame import Specimen
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_CLEAR_GROWTH = 1.02  # of the displacement before


class Channel(StrEnum):
    """Columns of a test apart from the time."""

    GROUND = "ground_acceleration_mps2"
    COMMAND = "command_m"
    MEASURED = "measured_m"
    FORCE = "force_n"


@dataclass(frozen=True, kw_only=True, eq=False)
class MeasuredTest:
    """One test: the channels that were recorded, at equal steps.

    Parameters
    ----------
    file : str
        Name of its file within the campaign's folder.
    motion : str
        What the test was driven by.
    held_out : bool
        Whether it is held out to verify the found effects.
    channels : dict of Channel to numpy.ndarray
        Samples in SI units, each of shape (n,).
    notes : tuple of str, optional
        What was assumed when its file was read, in sentences.
    """

    file: str
    motion: str
    held_out: bool
    channels: dict[Channel, NDArray[np.float64]]
    notes: tuple[str, ...] = ()

    @property
    def size(self) -> int:
        """Number of samples."""
        return next(iter(self.channels.values())).size

    @property
    def reaches_furthest_at_end(self) -> bool:
        """Whether the displacement is clearly larger in the last third than before, as in growing cycles."""
        channels = (self.channels.get(channel) for channel in (Channel.COMMAND, Channel.MEASURED))
        displacement = next((values for values in channels if values is not None), np.zeros(self.size))
        reach, end = np.abs(displacement - np.median(displacement)), 2 * self.size // 3
        return bool(reach[end:].max(initial=0.0) > _CLEAR_GROWTH * reach[:end].max(initial=0.0))


def describe_held_out(tests: Sequence[MeasuredTest], files: Iterable[str]) -> str:
    """Name files that are held out of a campaign's tests, or the part of its only test."""
    if len(tests) > 1:
        return ", ".join(files)
    return f"{'middle' if tests[0].reaches_furthest_at_end else 'last'} third of {tests[0].file}"


@dataclass(frozen=True, kw_only=True)
class Stretch:
    """Part of a test: its index, the first sample and the one after the last."""

    test: int
    begin: int
    end: int


@dataclass(frozen=True, kw_only=True, eq=False)
class Campaign(ResultWithRows):
    """A folder of measured tests with the nominal model of the rig.

    Parameters
    ----------
    name : str
        Free text.
    structure : Structure or None
        Nominal structure of one degree of freedom; None when there is no numerical substructure, or when it
        is a frame.
    mass : float
        Its mass [kg]; 1 when forces are per unit mass.
    actuator : Actuator or None
        Nominal actuator; None when there is no rig.
    specimen : Specimen or None
        Nominal specimen if it is not the structure's own spring.
    rate : float
        Sampling rate [Hz].
    tests : tuple of MeasuredTest
        The tests, of which at least one is not held out. Of a single test a third is held out.
    partition : Partition, optional
        Nominal frame with its specimen and interface, in the place of a structure of one degree of freedom.
    """

    rows_in = "tests"
    keys: ClassVar[Keys] = {"campaign": "name", "rate_hz": "rate", "tests": "rows"}

    name: str
    structure: Structure | None
    mass: float
    actuator: Actuator | None
    specimen: Specimen | None
    rate: float
    tests: tuple[MeasuredTest, ...]
    partition: Partition | None = None

    def __repr__(self) -> str:
        out = sum(test.held_out for test in self.tests)
        return f"<Campaign {self.name}: {len(self.tests)} tests at {self.rate:g} Hz, {out} held out>"

    def __post_init__(self) -> None:
        if all(test.held_out for test in self.tests):
            raise InputError(
                "At least one test must not be held out",
                value=f"{len(self.tests)} tests, all held out",
                remedy="Hold out one test to verify the effect, and leave the others to find it",
            )

    @property
    def step(self) -> float:
        """Step between samples [s]."""
        return 1.0 / self.rate

    @property
    def rows(self) -> list[dict[str, Any]]:
        """What is known of each test before it is examined."""
        return [
            {
                "file": test.file,
                "motion": test.motion,
                "held_out": test.held_out,
                "duration_s": (test.size - 1) * self.step,
                "channels": ", ".join(test.channels),
            }
            for test in self.tests
        ]

    def plot(self, axes: "Axes | None" = None) -> "Axes":
        """Draw the measured displacement of each test over time, and return the axes.

        `axes`: those to draw into; new ones by default.
        """
        histories = {
            test.file: test.channels.get(Channel.MEASURED, next(iter(test.channels.values())))
            for test in self.tests
        }
        return plot_histories(histories, self.step, title=self.name, label="measured [SI units]", axes=axes)

    @cached_property
    def nominal(self) -> HybridTest:
        """The operator's nominal model."""
        return HybridTest(
            structure=self.structure,
            mass=self.mass,
            actuator=self.actuator or Actuator(),
            specimen=self.specimen if self.partition is None else self.partition.specimen,
        )

    @property
    def channels(self) -> frozenset[Channel]:
        """Channels that every test has."""
        return frozenset.intersection(*(frozenset(test.channels) for test in self.tests))

    @property
    def training(self) -> tuple[Stretch, ...]:
        """Stretches of tests from which effects are found; of one test all but a third."""
        if len(self.tests) == 1:
            thirds = self._thirds
            if self.tests[0].reaches_furthest_at_end:
                return thirds[0], thirds[2]
            return (replace(thirds[0], end=thirds[1].end),)
        return self._stretches(held_out=False)

    @property
    def proof(self) -> tuple[Stretch, ...]:
        """Stretches of tests that are held out to verify the effects.

        Of one test it is the last third, or the middle one where only the last one moves that far: what a
        model was never shown proves nothing of it.
        """
        if len(self.tests) == 1:
            return (self._thirds[1 if self.tests[0].reaches_furthest_at_end else 2],)
        return self._stretches(held_out=True)

    @property
    def held_out(self) -> str:
        """What is held out, in words."""
        return describe_held_out(self.tests, [test.file for test in self.tests if test.held_out])

    @property
    def _thirds(self) -> tuple[Stretch, ...]:
        size = self.tests[0].size
        ends = (0, size // 3, 2 * size // 3, size)
        return tuple(Stretch(test=0, begin=begin, end=end) for begin, end in pairwise(ends))

    def _stretches(self, *, held_out: bool) -> tuple[Stretch, ...]:
        return tuple(
            Stretch(test=k, begin=0, end=test.size)
            for k, test in enumerate(self.tests)
            if test.held_out is held_out
        )
