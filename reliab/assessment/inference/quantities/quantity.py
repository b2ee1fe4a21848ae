"""What every uncertain quantity of a test declares: its words, its prior, and how it enters the test.

A quantity is one file of this folder with a `QUANTITY`; nothing else names it.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

from reliab.assessment.budget.sizes import Equipment
from reliab.assessment.inference.quantities.prior import Prior, Shape, Source
from reliab.core.arrays import Spectrum
from reliab.core.stated_value import StatedValue
from reliab.structures.partition import Partition

if TYPE_CHECKING:
    from reliab.assessment.inference.channel_spectra import ChannelSpectra
    from reliab.assessment.inference.experiment import Experiment


@dataclass(frozen=True, kw_only=True, eq=False)
class Circumstances:
    """What is known of a test before its channels are weighed."""

    partition: Partition  # The structure as stated
    channels: "ChannelSpectra"
    stated: Mapping[str, StatedValue] = field(default_factory=dict)  # By the names of the options
    equipment: Equipment | None = None  # None if everything that is not stated as uncertain is exact
    learned: Mapping[str, Prior] = field(default_factory=dict)  # From earlier tests of the rig
    # Relative standard deviations of a frame's frequencies, damping and parts that its file states [-]
    tolerances: Mapping[str, float] = field(default_factory=dict)
    specimen_force: bool = False  # Whether the recorded force is compared with the specimen as stated
    feedback_lag: float = 0.0  # Time by which the force is stated to be fed back late [s]
    slip: Spectrum | None = None  # Displacement that a specimen's spring is taken to have lost [m], (p, K)
    # What faults of the channels, or their repair, leave unknown, by names of quantities, in the SI unit
    left_by_faults: Mapping[str, float] = field(default_factory=dict)
    actuator: int = 0  # Whose quantities are asked for

    def named(self, name: str) -> str:
        """Name a quantity of the actuator, with its number if there are several."""
        return f"{name}_{self.actuator + 1}" if self.partition.degrees > 1 else name


def clock_deviation(circumstances: Circumstances, equipment: Equipment) -> float:
    """Return the standard deviation of the time by which skew and filter make a further channel late [s]."""
    skew = equipment.skew(circumstances.channels.band.record_step)
    return math.hypot(skew, equipment.filter_delay_ms / 1000.0)


class Quantity(ABC):
    """An uncertain quantity."""

    name: ClassVar[str]  # Key in JSON
    words: ClassVar[str]  # The quantity in words
    unit: ClassVar[str]  # In which its size is shown
    factor: ClassVar[float]  # From the unit in which it is drawn to `unit`
    remedy: ClassVar[str]  # What would reduce its uncertainty, a sentence
    per_actuator: ClassVar[bool] = False  # Whether every actuator has its own
    shape: ClassVar[Shape] = Shape.NORMAL
    option: ClassVar[str] = ""  # Name under which a user states it
    relative: ClassVar[bool] = False  # Whether its deviation is relative to the stated value
    option_unit: ClassVar[float] = 1.0  # What an option is divided by to give the SI unit

    def prior(self, circumstances: Circumstances) -> Prior | None:
        """Prior of the quantity; None if it is exact, or plays no part in the test."""
        if self.name in circumstances.learned:
            return circumstances.learned[self.name]
        if (tolerance := circumstances.tolerances.get(self.name)) is not None:
            return Prior(deviation=tolerance, source=Source.STATED, shape=self.shape) if tolerance else None
        stated = circumstances.stated.get(self.option)
        if stated is not None and stated.deviation:
            size = abs(stated.value) if self.relative else self.option_unit
            return (
                Prior(deviation=stated.deviation / size, source=Source.STATED, shape=self.shape)
                if size
                else None
            )
        if circumstances.equipment is None:
            return None
        name = circumstances.named(self.name) if self.per_actuator else self.name
        added = circumstances.left_by_faults.get(name, 0.0)
        deviation = math.hypot(self.ordinary(circumstances, circumstances.equipment), added)
        return Prior(deviation=deviation, shape=self.shape) if deviation > 0.0 else None

    def ordinary(self, circumstances: Circumstances, equipment: Equipment) -> float:  # noqa: ARG002
        """Return its standard deviation with ordinary equipment; zero if only faults leave it open."""
        return 0.0

    @abstractmethod
    def apply(self, experiment: "Experiment", value: float, actuator: int) -> None:
        """Change an experiment by the difference of the quantity from its stated value."""
