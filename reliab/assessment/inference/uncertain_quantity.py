"""An uncertain quantity of a test: its words, its prior, and how it enters the test.

Priors are functions of a standard normal variable z, or of a half-normal one.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, Final

import scipy

from reliab.assessment.budget.sizes import Equipment, PriorSource, exact_equipment
from reliab.core.arrays import Spectrum
from reliab.core.stated_value import StatedValue, require_physical
from reliab.core.vocabulary import MILLI, PERCENT
from reliab.structures.partition import Partition

if TYPE_CHECKING:
    from reliab.assessment.inference.channel_spectra import ChannelSpectra

_FACTORS: Final = {"%": PERCENT, "ms": MILLI, "mm": MILLI, "kg": 1.0, "N": 1.0, "": 1.0}
_STEEPNESS = 4.0  # of the step between nothing and the whole


class Shape(StrEnum):
    """Distribution of a prior."""

    NORMAL = "normal"  # deviation·z
    LOGNORMAL = "lognormal"  # the factor exp(deviation·z), less one
    POSITIVE = "positive"  # exponential, the least informative of a positive value with a known mean
    EITHER = "either"  # nothing or the whole, one as likely as the other, with little between them


@dataclass(frozen=True, kw_only=True)
class Prior:
    """Prior of how far a quantity lies from the value that is stated for it.

    >>> Prior(deviation=0.1).value(2.0), round(Prior(deviation=0.1, shape=Shape.LOGNORMAL).value(2.0), 4)
    (0.2, 0.2214)
    """

    deviation: float  # Standard deviation, relative or in the SI unit of the quantity
    source: PriorSource = PriorSource.DEFAULT
    shape: Shape = Shape.NORMAL
    mean: float = 0.0  # Of the difference, or of its logarithm, before the test

    @property
    def spread(self) -> float:
        """Standard deviation of z before the test."""
        return math.sqrt(1.0 - 2.0 / math.pi) if self.shape is Shape.POSITIVE else 1.0

    def value(self, z: float) -> float:
        """Return the difference from the stated value at a standard normal variable."""
        match self.shape:
            case Shape.NORMAL:
                return self.mean + self.deviation * z
            case Shape.POSITIVE:  # of a half-normal z
                return -self.deviation * (float(scipy.special.log_ndtr(-z)) + math.log(2.0))
            case Shape.LOGNORMAL:
                return math.expm1(self.mean + self.deviation * z)
            case Shape.EITHER:
                return self.deviation * float(scipy.special.ndtr(_STEEPNESS * z))


@dataclass(frozen=True, kw_only=True, eq=False)
class PriorKnowledge:
    """What is known of a test before it is recorded; whatever is not named here is exact.

    >>> PriorKnowledge(tolerances={"time_shift": 0.001}).skew_deviation(1.0 / 256.0)
    0.001
    """

    stated: Mapping[str, StatedValue] = field(default_factory=dict)  # By the names of the options
    equipment: Equipment = field(default_factory=exact_equipment)
    # Standard deviations by names of quantities, relative [-] or in the SI unit, such as those of a frame's
    # file; of one of several actuators with its number, such as "sensor_offset_2", else of all of them
    tolerances: Mapping[str, float] = field(default_factory=dict)
    # What faults of the channels, or their repair, leave unknown, by names of quantities, in the SI unit
    left_by_faults: Mapping[str, float] = field(default_factory=dict)

    def skew_deviation(self, time_step: float) -> float:
        """Return the standard deviation of the skew of channels recorded at a time step, both in [s]."""
        if "time_shift" in self.tolerances:
            return self.tolerances["time_shift"]
        deviation = self.stated.get("skew", StatedValue(0.0)).deviation
        return deviation / MILLI if deviation else self.equipment.skew(time_step)


EXACTLY_KNOWN = PriorKnowledge()
"""Nothing of a test is uncertain but what its channels leave open."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Circumstances(PriorKnowledge):
    """What is known of a test before its channels are weighed."""

    partition: Partition  # The structure as stated
    channels: "ChannelSpectra"
    learned: Mapping[str, Prior] = field(default_factory=dict)  # In place of what is stated or assumed
    specimen_force: bool = False  # Whether the recorded force is compared with the specimen as stated
    feedback_lag: float = 0.0  # Time by which the force is stated to be fed back late [s]
    slip: Spectrum | None = None  # Displacement that a specimen's spring is taken to have lost [m], (p, K)
    actuator: int = 0  # Whose quantities are asked for

    def name_quantity(self, name: str) -> str:
        """Name a quantity of the actuator, with its number if there are several."""
        return f"{name}_{self.actuator + 1}" if self.partition.degrees > 1 else name


def _nothing(circumstances: Circumstances, equipment: Equipment) -> float:  # noqa: ARG001
    return 0.0


@dataclass(frozen=True, kw_only=True, eq=False)
class Description:
    """Something that is not known exactly, for readers."""

    words: str  # What it is
    unit: str  # In which its size is shown; empty where none is
    remedy: str  # What would reduce its uncertainty, a sentence

    def describe_for_actuator(self, number: int) -> "Description":
        """Describe the same of one of several actuators."""
        return Description(words=f"{self.words} of actuator {number}", unit=self.unit, remedy=self.remedy)

    @property
    def factor(self) -> float:
        """Factor from the unit in which it is drawn to `unit`."""
        return _FACTORS[self.unit]


@dataclass(frozen=True, kw_only=True, eq=False)
class Quantity(Description):
    """An uncertain quantity."""

    name: str  # Key in JSON
    changes: str  # Which value of a world it changes, or part of a frame
    by_factor: bool = False  # Whether by a relative difference from the stated value
    # Its standard deviation with ordinary equipment; zero if only faults leave it open
    ordinary: Callable[[Circumstances, Equipment], float] = _nothing
    actuator_specific: bool = False  # Whether every actuator has its own
    shape: Shape = Shape.NORMAL
    option: str = ""  # Name under which a user states it
    relative: bool = False  # Whether its deviation is relative to the stated value
    # Another prior than that of ordinary equipment where the statement is of a kind of its own
    special: Callable[["Quantity", Circumstances], Prior | None] | None = None

    def prior(self, circumstances: Circumstances) -> Prior | None:
        """Prior of the quantity; None if it is exact, or plays no part in the test."""
        return self.usual_prior(circumstances) if self.special is None else self.special(self, circumstances)

    def stated_deviation(self, stated: Mapping[str, StatedValue]) -> float:
        """Return the deviation stated beside a value, relative or in the SI unit; zero if none is."""
        value = stated.get(self.option, StatedValue(0.0))
        size = abs(value.value) if self.relative else MILLI if self.unit == "ms" else 1.0
        return value.deviation / size if size else 0.0

    def require_possible(self, deviation: float) -> None:
        """Refuse a stated standard deviation, relative or in the SI unit, that the quantity cannot have."""
        kind = "relative standard deviation" if self.unit == "%" else "number"
        signed = self.shape is Shape.EITHER
        label = f"{kind if self.unit == '%' else 'standard deviation'} of the {self.words}"
        require_physical(kind, deviation, zero=True, signed=signed, label=label)

    def stated_prior(self, deviation: float) -> Prior | None:
        """Prior of a stated standard deviation, relative or in the SI unit; None if it is zero."""
        self.require_possible(deviation)
        return Prior(deviation=deviation, source=PriorSource.STATED, shape=self.shape) if deviation else None

    def usual_prior(self, circumstances: Circumstances) -> Prior | None:
        """Prior by what is learned, stated or usual with the equipment, in this order; faults widen it."""
        if self.name in circumstances.learned:
            return circumstances.learned[self.name]
        name = circumstances.name_quantity(self.name) if self.actuator_specific else self.name
        tolerances, faults = circumstances.tolerances, circumstances.left_by_faults
        if (tolerance := tolerances.get(name, tolerances.get(self.name))) is not None:
            return self.stated_prior(tolerance)
        if circumstances.stated.get(self.option, StatedValue(0.0)).deviation:
            source, deviation = PriorSource.STATED, self.stated_deviation(circumstances.stated)
        else:
            source, deviation = PriorSource.DEFAULT, self.ordinary(circumstances, circumstances.equipment)
        deviation = math.hypot(deviation, faults.get(name, faults.get(self.name, 0.0)))
        return Prior(deviation=deviation, source=source, shape=self.shape) if deviation else None
