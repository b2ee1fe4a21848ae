"""A test with several actuators: commands and measured displacements at equal steps, checked."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.stated_value import StatedValue, require_physical
from reliab.recordings.readers.columns import Columns, is_frame, read_frame
from reliab.recordings.reading import ChannelHistories, histories_of, read_statements, read_test
from reliab.recordings.recording import (
    DISPLACEMENTS,
    FEWEST_SAMPLES,
    Channel,
    Part,
    Recording,
    StatedChannels,
    require_few_samples,
    require_finite,
)

if TYPE_CHECKING:
    from pathlib import Path

    import pandas as pd

_NAMED_SO: Final = re.compile(
    r"^(command|measured)[ _]?([A-Za-z0-9]+?)(?:[ _]\(?(rad|mrad|deg|mm|cm|m|in)\)?)?$"
)


@dataclass(frozen=True, kw_only=True, eq=False)
class CoupledRecording:
    """Commands and measured displacements of the actuators of a test, or of its interface.

    Raises InputError if histories differ in length, are too short, hold a value that is no number, or none of
    the commands moves.

    >>> time = np.arange(0.0, 20.0, 0.01)
    >>> command = np.stack([np.sin(6.0 * time), np.cos(6.0 * time)])
    >>> CoupledRecording(command=command, measured=0.99 * command, time_step=0.01).actuators
    ('1', '2')
    """

    command: Array  # command, measured: Displacements [m, or rad of a rotation], shape (p, n)
    measured: Array
    time_step: float  # s
    actuators: tuple[str, ...] = ()  # Numbers of the channels in the file; "1" to "p" by default
    name: str = "test"
    notes: tuple[str, ...] = ()  # What was assumed when the test was read, in sentences
    channels: tuple[Channel, ...] = ()  # Which columns of the file were taken as what
    ground: Array | None = None  # Ground acceleration [m/s²], shape (n,); None where it is not recorded
    stated: Mapping[str, StatedValue] = field(
        default_factory=dict
    )  # As of `Recording`, of all channels alike

    def __post_init__(self) -> None:
        shape = np.shape(self.command)
        if len(shape) != 2 or shape != np.shape(self.measured) or shape[1] < FEWEST_SAMPLES:  # noqa: PLR2004
            raise InputError(
                f"Commands and measured displacements must have the same length, at least {FEWEST_SAMPLES}",
                value=f"shapes {shape} and {np.shape(self.measured)}",
                remedy="Give the whole test",
                where=self.name,
            )
        require_few_samples(shape[1], self.name)
        require_physical("time step", self.time_step, where=self.name)
        actuators = tuple(self.actuators) or tuple(str(place + 1) for place in range(shape[0]))
        object.__setattr__(self, "actuators", actuators)
        for description, rows in (("command", self.command), ("measured displacement", self.measured)):
            for number, values in zip(actuators, rows, strict=True):
                require_finite(values, f"{description} {number}", self.name)
        if self.ground is not None:
            require_finite(self.ground, "ground acceleration", self.name)
        if not (np.ptp(self.command, axis=1) > 0.0).any():
            raise InputError("No command moves", remedy="Check the columns", where=self.name)

    @property
    def duration(self) -> float:
        """Time between the first and the last sample [s]."""
        return float((self.command.shape[1] - 1) * self.time_step)

    @property
    def rate(self) -> float:
        """Sampling rate [Hz]."""
        return 1.0 / self.time_step

    def select_actuator(self, place: int) -> Recording:
        """Return the recording of one actuator, which must move."""
        return Recording(
            command=self.command[place],
            measured=self.measured[place],
            time_step=self.time_step,
            name=f"{self.name}, actuator {self.actuators[place]}",
        )


_RECORD_REASON: Final = "the record says so"


def read_coupled_recording(
    path: "str | Path | pd.DataFrame", laboratory: StatedChannels, **reading: str | None
) -> CoupledRecording:
    """Read a test with several actuators: columns command_1, measured_1, command_2, … or as recognised.

    Keyword arguments are `delimiter` and `test` of :func:`read_test`, and `time_units`. Rotations are in
    radians where their column states no other unit: command_2_mrad.
    """
    time_units = reading.pop("time_units", None)
    columns = read_frame(path) if is_frame(path) else read_test(path, **reading)
    columns = number_pairs(columns)
    histories = histories_of(columns, laboratory, time_units=time_units)
    recording = build_coupled_recording(histories.cut_moves())
    return replace(recording, stated=laboratory.merge_statements(read_statements(columns)))


def build_coupled_recording(histories: ChannelHistories) -> CoupledRecording:
    """Take commands and measured displacements of all actuators of a test, in the order of their numbers."""
    commands = {
        channel.actuator: key for key, channel in histories.channels.items() if channel.part is Part.COMMAND
    }
    measured_rows = {
        channel.actuator: key for key, channel in histories.channels.items() if channel.part is Part.MEASURED
    }
    numbers = numbers_of_pairs((channel.part, channel.actuator) for channel in histories.channels.values())
    columns, channels = histories.columns, histories.channels.values()
    grounds = (key for key, channel in histories.channels.items() if channel.part is Part.GROUND)
    renamings = (
        replace(channel, reason=channel.reason.replace(_RECORD_REASON, "its name")) for channel in channels
    )
    return CoupledRecording(
        command=np.stack([histories.values[commands[number]] for number in numbers]),
        measured=np.stack([histories.values[measured_rows[number]] for number in numbers]),
        time_step=histories.time_step,
        actuators=tuple(number or "1" for number in numbers),
        name=f"{columns.path.name}, {columns.test}" if columns.test else columns.path.name,
        notes=tuple(dict.fromkeys(histories.notes)),
        channels=tuple(renamings),
        ground=next((histories.values[key] for key in grounds), None),
    )


def number_pairs(columns: Columns) -> Columns:
    """Take columns command_1, measured_1, command_2, … as those of actuators where there are several."""
    matches = {name: match for name in columns.values if (match := _NAMED_SO.match(name))}
    parts = {name: (match[1], match[2]) for name, match in matches.items()}
    if len(set(parts.values())) == len(parts) > len(DISPLACEMENTS):
        return replace(columns, parts={**columns.parts, **parts})
    return columns


def numbers_of_pairs(channels: Iterable[tuple[Part, str]]) -> tuple[str, ...]:
    """Numbers of actuators with both channels, in their order."""
    keys = set(channels)
    numbers = {number for part, number in keys if all((part, number) in keys for part in DISPLACEMENTS)}
    return tuple(sorted(numbers, key=lambda number: (len(number), number)))
