"""A channel of a test: which part of it a column is, in what unit, and why."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Final

from reliab.arrays import Array
from reliab.recordings.words import Quantity


class Part(StrEnum):
    """What a column of a test can be."""

    TIME = "time"
    COMMAND = "command"
    MEASURED = "measured"
    GROUND = "ground acceleration"
    FORCE = "force"


QUANTITY_OF: Final[Mapping[Part, Quantity]] = {
    Part.TIME: Quantity.TIME,
    Part.COMMAND: Quantity.DISPLACEMENT,
    Part.MEASURED: Quantity.DISPLACEMENT,
    Part.GROUND: Quantity.ACCELERATION,
    Part.FORCE: Quantity.FORCE,
}
"""What each part measures."""

DISPLACEMENTS: Final = (Part.COMMAND, Part.MEASURED)
"""Parts without which no test is judged."""


@dataclass(frozen=True, kw_only=True)
class Stated:
    """What a laboratory states of a channel, by options or in `channels.toml`."""

    columns: tuple[str, ...] = ()  # Names in the file, of which the first that is there counts
    unit: str = ""
    sign: float = 1.0
    scale: float = 1.0  # by which readings are multiplied
    zero: float = 0.0  # reading at rest, in the unit of the file, which is taken away


@dataclass(frozen=True, kw_only=True)
class Channel:
    """A column that was recognised."""

    part: Part
    column: str  # Its name in the file
    unit: str  # Its unit; empty where nothing states one
    factor: float  # from its readings to SI units, with sign and scale
    reason: str  # Why it was taken, in words
    zero: float = 0.0  # reading that is taken away before
    actuator: str = ""  # Number of its actuator, in a file of several

    def in_si(self, readings: Array) -> Array:
        """Return readings in SI units, with the zero taken away."""
        return (readings - self.zero) * self.factor

    def summary(self) -> dict[str, str | float]:
        """Plain values for JSON."""
        return {
            "channel": str(self.part) + (f"_{self.actuator}" if self.actuator else ""),
            "column": self.column,
            "unit": self.unit,
            "factor": self.factor,
            "reason": self.reason,
        }
