"""A real test: its channels, and commands and measured displacements at equal steps, checked."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.plain_values import Keys, PlainResult, plot_histories, same_names
from reliab.core.stated_value import StatedValue, require_physical
from reliab.recordings.words import Measurand

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FEWEST_SAMPLES = 64
"""Samples below which no index is evaluated."""

MOST_SAMPLES = 10_000_000
"""Largest number of samples; the statistics of so many take about 4 GB."""

LARGEST_READING = 1e30
"""What no sensor reads in any unit, and whose square is still a number."""

_SMALLEST = 1e-30  # what no sensor reads in any unit, and whose square is still a number


class Part(StrEnum):
    """What a column of a test can be."""

    TIME = "time"
    COMMAND = "command"
    MEASURED = "measured"
    GROUND = "ground acceleration"
    FORCE = "force"


QUANTITY_OF: Final[Mapping[Part, Measurand]] = {
    Part.TIME: Measurand.TIME,
    Part.COMMAND: Measurand.DISPLACEMENT,
    Part.MEASURED: Measurand.DISPLACEMENT,
    Part.GROUND: Measurand.ACCELERATION,
    Part.FORCE: Measurand.FORCE,
}
"""What each part measures."""


DISPLACEMENTS: Final = (Part.COMMAND, Part.MEASURED)
"""Parts without which no test is judged."""

PARTS_OF_ACTUATORS: Final = (*DISPLACEMENTS, Part.FORCE)
"""Parts of which every actuator has its own."""


@dataclass(frozen=True, kw_only=True)
class ChannelDeclaration:
    """What a laboratory states of a channel, by options or in `channels.toml`."""

    columns: tuple[str, ...] = ()  # Names in the file, of which the first that is there counts
    unit: str = ""
    sign: float = 1.0
    scale: float = 1.0  # by which readings are multiplied
    zero: float = 0.0  # reading at rest, in the unit of the file, which is taken away
    is_scaled: bool = False  # Whether scale or zero are stated, be it as 1 and 0


@dataclass(frozen=True, kw_only=True)
class StatedChannels:
    """What is stated of the channels of tests: by a file `channels.toml`, or by options."""

    declarations: Mapping[Part, ChannelDeclaration] = field(default_factory=dict)
    rate_hz: float | None = None  # Sampling rate [Hz], where a file holds no time
    # Skew [ms], scale, hysteresis [-] and resolution [mm] of the measured channel, as calibrated
    calibration: Mapping[str, StatedValue] = field(default_factory=dict)
    filters: Mapping[str, str] = field(default_factory=dict)  # Low-pass filters, "200/4", by channel

    @property
    def test_values(self) -> dict[str, StatedValue]:
        """What the calibration says of every test.

        The skew that one motion on both channels showed has the delay of their filters in it, of which
        nothing more is open ("filter_delay" [ms]).
        """
        skew = self.calibration.get("skew")
        filters = {} if skew is None else {"filter_delay": StatedValue(0.0, skew.deviation)}
        return {**self.calibration, **filters}

    def merge_statements(self, test_values: Mapping[str, StatedValue]) -> dict[str, StatedValue]:
        """Put what the file of a test states before what is stated of every test."""
        return {**self.test_values, **test_values}


@dataclass(frozen=True, kw_only=True)
class Channel(PlainResult):
    """A column that was recognised."""

    keys: ClassVar[Keys] = {
        "channel": "name",
        **same_names("column", "unit", "factor", "reason"),
        "applied": "corrections",
    }

    part: Part
    column: str  # Its name in the file
    unit: str  # Its unit; empty where nothing states one
    factor: float  # from its readings to SI units, with sign and scale
    reason: str  # Why it was taken, in words
    zero: float = 0.0  # reading that is taken away before
    actuator: str = ""  # Number of its actuator, in a file of several
    # What of its file, and of its clock, was applied to the readings, in words
    corrections: tuple[str, ...] = ()

    def convert_to_si(self, readings: Array) -> Array:
        """Return readings in SI units, with the zero taken away."""
        return (readings - self.zero) * self.factor

    @property
    def name(self) -> str:
        """What it is, with its actuator in a file of several."""
        return f"{self.part}_{self.actuator}" if self.actuator else str(self.part)


def require_few_samples(samples: int, location: str) -> None:
    """Refuse a test whose statistics would not fit in memory."""
    if samples > MOST_SAMPLES:
        raise InputError(
            f"Too many samples: {samples:,}, above {MOST_SAMPLES:,}",
            remedy="Resample it at a lower rate, or cut it where everything stands still",
            where=location,
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class Recording(PlainResult):
    """Commands and measured displacements of a test, of one actuator or of several.

    InputError
        If the histories differ in length, are too short or too long, do not move, or hold a value that is no
        number.

    >>> time = np.arange(0.0, 20.0, 0.01)
    >>> test = Recording(command=np.sin(6.0 * time), measured=np.sin(6.0 * time - 0.01), time_step=0.01)
    >>> round(test.duration, 2)
    19.99
    >>> both = np.stack([test.command, test.measured])
    >>> Recording(command=both, measured=0.99 * both, time_step=0.01).actuators
    ('1', '2')
    """

    keys: ClassVar[Keys] = {
        "test": "name",
        "duration_s": "duration",
        "rate_hz": "rate",
        "samples": "samples",
        "**": "largest",
        "notes": "notes",
    }

    # command, measured: Displacements [m, or rad of a rotation], shape (n,), 64 ≤ n ≤ 10 million, or (p, n)
    # of several actuators; where no unit is known they only share one
    command: NDArray[np.float64]
    measured: NDArray[np.float64]
    time_step: float  # Step between samples [s]
    name: str = "test"  # What the test is called
    notes: tuple[str, ...] = field(default=())  # What was assumed when the test was read, in sentences
    # Ground acceleration [m/s²] that was recorded with the test, shape (n,)
    ground: NDArray[np.float64] | None = None
    # Restoring force of the specimen at each actuator [N], or [N m] of a rotation, shape as of the commands
    force: NDArray[np.float64] | None = None
    # Frequency "f" [Hz], damping ratio "xi", experimental fraction "alpha" and "scale" of the sensor of the
    # measured displacement [-] as far as the file's header states them; and what `channels.toml` holds as
    # calibrated
    stated: Mapping[str, StatedValue] = field(default_factory=dict)
    # Which columns of the file were taken as what, in which unit and why
    channels: tuple["Channel", ...] = ()
    # Numbers of several actuators in the file, "1" to "p" by default; that of an only one is empty
    actuators: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        shape = np.shape(self.command)
        size = shape[-1] if shape else 0
        if shape != np.shape(self.measured) or len(shape) > 2 or size < FEWEST_SAMPLES:  # noqa: PLR2004
            raise InputError(
                f"Command and measured displacement must have the same length, at least {FEWEST_SAMPLES}",
                value=" and ".join(str(np.size(values)) for values in (self.command, self.measured)),
                remedy="Give the whole test",
                where=self.name,
            )
        require_few_samples(size, self.name)
        require_physical("time step", self.time_step, where=self.name)
        self._number_actuators()
        for description, values in (("command", self.command), ("measured displacement", self.measured)):
            rows = np.atleast_2d(values)
            for number, row in zip(self.actuators, rows, strict=True):
                require_finite(row, f"{description} {number}".rstrip(), self.name)
            if not any(_moves(row) for row in rows):
                raise InputError(
                    f"The {description} does not move: {rows[0, 0]:g} throughout",
                    remedy="Check that the column is the right one and the channel was connected",
                    where=self.name,
                )
        if self.ground is not None:
            require_finite(self.ground, "ground acceleration", self.name)
        self._require_forces()

    def _require_forces(self) -> None:
        """Refuse forces that are not numbers, or not those of all actuators."""
        if self.force is None:
            return
        if self.force.shape != self.command.shape:
            raise InputError(
                "Each actuator needs a force of the length of its command, if any is recorded",
                value=f"forces of shape {self.force.shape} for commands of shape {self.command.shape}",
                remedy="Give the forces of all actuators, or leave them out",
                where=self.name,
            )
        for number, row in zip(self.actuators, np.atleast_2d(self.force), strict=True):
            require_finite(row, f"force {number}".rstrip(), self.name)

    def _number_actuators(self) -> None:
        """Give several actuators numbers from 1 on where they have none."""
        count = len(self.command) if self.has_several else 1
        if not self.actuators:
            numbers = tuple(str(place + 1) for place in range(count)) if self.has_several else ("",)
            object.__setattr__(self, "actuators", numbers)
        if len(self.actuators) != count:
            raise InputError(
                "Each actuator needs a number of its own",
                value=f"{', '.join(self.actuators)} for commands of shape {self.command.shape}",
                remedy="Leave `actuators` out to count them",
                where=self.name,
            )

    @property
    def duration(self) -> float:
        """Time between the first and the last sample [s]."""
        return (self.samples - 1) * self.time_step

    @property
    def samples(self) -> int:
        """Number of samples of each channel."""
        return int(self.command.shape[-1])

    @property
    def has_several(self) -> bool:
        """Whether there are several actuators."""
        return self.command.ndim > 1

    @property
    def rate(self) -> float:
        """Sampling rate [Hz]."""
        return 1.0 / self.time_step

    @property
    def largest(self) -> dict[str, float]:
        """Largest value of each channel in SI units."""
        names = ("command", "measured", "ground", "force")
        known = {name: getattr(self, name) for name in names}
        return {
            f"largest_{name}": float(np.abs(values).max())
            for name, values in known.items()
            if values is not None
        }

    def select_actuator(self, place: int) -> "Recording":
        """Return the displacements of one of several actuators, which must move; an only one as it is."""
        if not self.has_several:
            return self
        return Recording(
            command=self.command[place],
            measured=self.measured[place],
            time_step=self.time_step,
            name=f"{self.name}, actuator {self.actuators[place]}",
        )

    def plot(self, axes: "Axes | None" = None) -> "Axes":
        """Draw commands and measured displacements over time, and return the axes.

        `axes`: those to draw into; new ones by default.
        """
        histories = {
            f"{name} {number}".rstrip(): row
            for name, rows in (("command", self.command), ("measured", self.measured))
            for number, row in zip(self.actuators, np.atleast_2d(rows), strict=True)
        }
        return plot_histories(histories, self.time_step, title=self.name, label="displacement [m]", axes=axes)


def _moves(values: Array) -> bool:
    return bool(np.ptp(values) > max(1e-9 * np.abs(values).max(), _SMALLEST))


def require_finite(values: NDArray[np.float64], description: str, location: str) -> None:
    """Refuse a history with a gap, or a value too large for a displacement, a force or an acceleration."""
    wrong = ~(np.abs(values) < LARGEST_READING)
    if wrong.any():
        row = int(np.flatnonzero(wrong)[0])
        raise InputError(
            f"Not a finite number below {LARGEST_READING:g}",
            value=f"{values[row]} in the {description}, sample {row + 1}",
            remedy="Fill the gap, or cut the test there",
            where=location,
        )
