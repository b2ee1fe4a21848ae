"""Read a test from a file."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from reliab.core.arrays import Array
from reliab.core.errors import InputError, naming
from reliab.core.significant_digits import significant
from reliab.core.stated_value import StatedValue
from reliab.recordings.behaviour import compare, extent_of_test, moves, share_explained
from reliab.recordings.clocks import align_clocks, pair_times
from reliab.recordings.readers.columns import Columns, is_frame, read_frame
from reliab.recordings.readers.registry import read_tests
from reliab.recordings.recognition import recognise
from reliab.recordings.recording import (
    DISPLACEMENTS,
    PARTS_OF_ACTUATORS,
    QUANTITY_OF,
    Channel,
    ChannelDeclaration,
    Part,
    Recording,
    StatedChannels,
)
from reliab.recordings.words import ANGLES, split_unit, unit_of

if TYPE_CHECKING:
    import pandas as pd

_HEADER_NAMES: Final = {
    "f": ("f", "natural frequency", "natural_frequency", "f_n", "fn"),
    "xi": ("xi", "ξ", "damping ratio", "damping_ratio"),
    "alpha": ("alpha", "α", "experimental fraction", "experimental_fraction"),
    "mass": ("mass", "mass_kg"),
    "scale": ("scale", "sensor scale", "sensor_scale"),
    "skew": ("skew", "skew_ms"),
}
_NO_UNITS: Final = frozenset(
    {"", "1", "?", "none", "unknown", "n/a", "na", "unit", "a.u.", "arb", "dimensionless"}
)
_LEAST_EXPLAINED_SHARE: Final = (
    0.9  # share of a nameless column that the motion explains, from which it may be a force
)
_NUMBERED_NAME: Final = re.compile(
    r"^(command|measured|force)[ _]?([A-Za-z0-9]+?)(?:[ _]\(?(rad|mrad|deg|mm|cm|m|in|k?[Nn]|lbf|kgf)\)?)?$"
)
_LENGTH_WORDS: Final = ("", "displacement ", "length ")  # before "units" in a header
_NAMES_SHOWN: Final = 20  # of the tests of a file, in a message
_LARGEST_RATIO: Final = 3.0  # of measured to commanded displacement in one unit


@dataclass(frozen=True, kw_only=True, eq=False)
class ChannelHistories:
    """All recognised channels of one test, at one clock."""

    columns: Columns
    channels: Mapping[str, Channel]  # By name: "command", "measured", "command_2" …
    values: Mapping[str, Array]  # [m, N, m/s²], shape (n,)
    time_step: float  # s
    notes: tuple[str, ...]  # What was assumed or done, in sentences
    has_rows: bool = True  # Whether the samples are the rows of the file, neither interpolated nor cut

    def cut_moves(self) -> "ChannelHistories":
        """Leave out what the commands do before and after a test to reach its position, and say so."""
        commands = [
            self.values[key] for key, channel in self.channels.items() if channel.part is Part.COMMAND
        ]
        extents = [extent_of_test(command, self.time_step) for command in commands]
        begin, end = max(begin for begin, _ in extents), min(end for _, end in extents)
        size = commands[0].size
        if (begin, end) == (0, size):
            return self
        lasting = (begin * self.time_step, (size - end) * self.time_step)
        parts = [
            f"the {end_name} {significant(time)} s"
            for end_name, time in zip(("first", "last"), lasting, strict=True)
            if time
        ]
        left_out = f"{' and '.join(parts)} left out, in which the command only moved to or from its position"
        return replace(
            self,
            values={key: values[begin:end] for key, values in self.values.items()},
            channels={
                key: replace(channel, corrections=(*channel.corrections, left_out))
                for key, channel in self.channels.items()
            },
            notes=(*self.notes, f"{left_out[0].upper()}{left_out[1:]}."),
            has_rows=False,
        )


def read_recording(
    path: "str | Path | pd.DataFrame",
    *,
    command: str | None = None,
    measured: str | None = None,
    time: str | None = None,
    rate_hz: float | None = None,
    units: str | None = None,
    time_units: str | None = None,
    delimiter: str | None = None,
    test: str | None = None,
    channels: str | Path | None = None,
    several: bool = False,
) -> Recording:
    """Read a test from a file.

    Parameters
    ----------
    path : str, pathlib.Path or pandas.DataFrame
        CSV or other text, MATLAB, HDF5, TDMS, LabVIEW measurement or NetCDF; or a data frame with a history
        in each column.
    command, measured, time : str, optional
        Names of the columns, where they are not recognised.
    rate_hz : float, optional
        Sampling rate [Hz], where the file holds no time.
    units, time_units : str, optional
        Unit of both displacements and of the time, where the file states none.
    delimiter : str, optional
        What separates the columns of a text.
    test : str, optional
        Which test, where the file holds several.
    channels : str or pathlib.Path, optional
        File `channels.toml` in which a laboratory states its channels.
    several : bool, optional
        Whether the test has several actuators: columns command_1, measured_1, command_2, … or as recognised.
        Rotations are in radians where their column states no other unit: command_2_mrad.

    Returns
    -------
    Recording
        The test.

    Raises
    ------
    InputError
        With file, line, rule and remedy, if a column is missing or two are too close, times do not follow at
        equal steps, a value is missing or a history is constant.
    """
    names = {Part.COMMAND: command, Part.MEASURED: measured, Part.TIME: time}
    table = read_frame(path) if is_frame(path) else read_test(path, test, delimiter=delimiter)
    laboratory = declare_channels(channels, names, units, rate_hz)
    table = number_pairs(table) if several else table
    histories = histories_of(table, laboratory, time_units=time_units)
    recording = recording_of(histories.cut_moves(), several=several)
    return replace(recording, stated=laboratory.merge_statements(recording.stated))


def read_test(path: str | Path, test: str | None = None, *, delimiter: str | None = None) -> Columns:
    """Read a test of a file, in columns as they stand there; by its name where the file holds several."""
    return one_test(read_tests(path, delimiter=delimiter), test)


def one_test(tests: Sequence[Columns], name: str | None) -> Columns:
    """Choose a test of a file by its name."""
    names = [columns.test for columns in tests]
    if name is not None:
        if name not in names:
            raise InputError(
                f"No test {name!r} in the file",
                remedy=f"It holds {', '.join(filter(None, names)) or 'one test without a name'}",
                where=tests[0].path.name,
            )
        return tests[names.index(name)]
    if len(tests) > 1:
        ellipsis = " …" if len(names) > _NAMES_SHOWN else ""
        raise InputError(
            f"The file holds several tests: {', '.join(names[:_NAMES_SHOWN])}{ellipsis}",
            remedy="Choose one with `test_name`, or all of them with `test_name=all`",
            where=tests[0].path.name,
        )
    return tests[0]


def histories_of(
    columns: Columns,
    laboratory: StatedChannels,
    *,
    needed_parts: Iterable[Part] = DISPLACEMENTS,
    time_units: str | None = None,
) -> ChannelHistories:
    """Recognise the channels of a test, and bring them to SI units and one clock."""
    if Part.TIME not in laboratory.declarations:
        columns = pair_times(columns)
    recognised = recognise(columns, laboratory.declarations, needed_parts=needed_parts)
    channels, notes = _complete_units(columns, recognised)
    channel_of = {
        f"{channel.part}_{channel.actuator}" if channel.actuator else str(channel.part): channel
        for channel in sorted(channels, key=_order)
    }
    if not any(channel.part is not Part.TIME for channel in channel_of.values()):
        raise InputError(
            "No column for the command or the measured displacement",
            remedy=f"Name the columns command and measured, or choose them with `command` and `measured`. "
            f"Columns in the file: {columns.names_text}",
            where=columns.location,
        )
    require_clear_numbers(columns, channel_of.values(), laboratory.declarations)
    histories = align_clocks(columns, channel_of, rate_hz=laboratory.rate_hz, time_units=time_units)
    corrections = {
        key: (*columns.series[channel.column].corrections, *histories.corrections.get(key, ()))
        for key, channel in channel_of.items()
    }
    sentences = (
        f"{channel_of[key].column!r}: {'; '.join(clauses)}."
        for key, clauses in corrections.items()
        if clauses
    )
    channel_of = {
        key: replace(channel, corrections=(*corrections[key], *histories.notes))
        for key, channel in channel_of.items()
    }
    return ChannelHistories(
        columns=columns,
        channels=channel_of,
        values={key: channel_of[key].convert_to_si(values) for key, values in histories.values.items()},
        time_step=histories.step,
        has_rows=histories.has_rows,
        notes=(*columns.notes, *notes, *_possible_forces(columns, channels), *histories.notes, *sentences),
    )


def recording_of(histories: ChannelHistories, *, several: bool = False) -> Recording:
    """Take the displacements of a test, with ground acceleration, and with forces where all are recorded.

    `several`: whether there may be several actuators; they come in the order of their numbers.
    """
    channels = histories.channels.values()
    keys = {(channel.part, channel.actuator): key for key, channel in histories.channels.items()}
    numbers = numbers_of_pairs(keys)
    if numbers != ("",) and not several:
        commands = [channel.column for channel in channels if channel.part is Part.COMMAND]
        raise InputError(
            f"The file holds channels of actuators {', '.join(numbers)}: {' and '.join(map(repr, commands))}",
            remedy="Choose a pair with `command` and `measured`; `reliab record` keeps all of them",
            where=histories.columns.location,
        )
    values, columns = histories.values, histories.columns
    rows = {
        part: np.stack([values[keys[part, number]] for number in numbers])
        for part in PARTS_OF_ACTUATORS
        if all((part, number) in keys for number in numbers)
    }
    if len(numbers) == 1:
        rows = {part: row for part, (row,) in rows.items()}
    return Recording(
        command=rows[Part.COMMAND],
        measured=rows[Part.MEASURED],
        time_step=histories.time_step,
        name=f"{columns.path.name}, {columns.test}" if columns.test else columns.path.name,
        notes=tuple(dict.fromkeys(histories.notes)),
        ground=values.get("ground acceleration"),
        force=rows.get(Part.FORCE),
        stated=read_statements(columns),
        channels=tuple(channels),
        actuators=numbers,
    )


def number_pairs(columns: Columns) -> Columns:
    """Take columns command_1, measured_1, force_1, … as those of actuators where there are several."""
    matches = {name: match for name in columns.values if (match := _NUMBERED_NAME.match(name))}
    parts = {name: (match[1], match[2]) for name, match in matches.items()}
    displacements = [part for part, _ in parts.values() if part in DISPLACEMENTS]
    if len(set(parts.values())) == len(parts) and len(displacements) > len(DISPLACEMENTS):
        return replace(columns, parts={**columns.parts, **parts})
    return columns


def numbers_of_pairs(channels: Iterable[tuple[Part, str]]) -> tuple[str, ...]:
    """Numbers of actuators with both channels, in their order."""
    keys = set(channels)
    numbers = {number for part, number in keys if all((part, number) in keys for part in DISPLACEMENTS)}
    return tuple(sorted(numbers, key=lambda number: (len(number), number)))


def read_statements(columns: Columns) -> dict[str, StatedValue]:
    """Read what the header, or single numbers of a binary file, say of the structure and the sensor."""
    texts = {name.rpartition(".")[2].lower(): f"{value:.17g}" for name, value in columns.scalars.items()}
    texts |= {name: text.removesuffix("Hz") for name, text in columns.header.items()}
    with naming(columns.location):
        return {
            quantity: StatedValue.parse(texts[name], name)
            for quantity, names in _HEADER_NAMES.items()
            for name in names
            if name in texts
        }


def declare_channels(
    channels: str | Path | None, names: Mapping[Part, str | None], units: str | None, rate_hz: float | None
) -> StatedChannels:
    """Put what options state before what a file `channels.toml` states; `rate_hz` [Hz]."""
    laboratory = StatedChannels()
    if channels is not None:
        from reliab.recordings.channels_file import read_channels_file

        laboratory = read_channels_file(channels)
    result = dict(laboratory.declarations)
    for part, name in names.items():
        if name is not None:
            result[part] = replace(result.get(part, ChannelDeclaration()), columns=(name,))
    for part in DISPLACEMENTS if units else ():
        result[part] = replace(result.get(part, ChannelDeclaration()), unit=units or "")
    return replace(laboratory, declarations=result, rate_hz=rate_hz or laboratory.rate_hz)


def _order(channel: Channel) -> tuple[int, str]:
    order = (Part.COMMAND, Part.MEASURED, Part.FORCE, Part.GROUND, Part.TIME)
    return order.index(channel.part), channel.actuator


def _complete_units(columns: Columns, channels: Sequence[Channel]) -> tuple[list[Channel], list[str]]:
    """Complete the units; a channel beside the displacements without one is left out."""
    channels = [_apply_header_unit(columns, _apply_angle_unit(columns, channel)) for channel in channels]
    pairs = {(channel.part, channel.actuator): channel for channel in channels}
    result, notes = [], []
    if not columns.named:
        order = ", ".join(f"{channel.part} = {channel.column}" for channel in channels)
        notes.append(f"The columns have no names and were identified by their histories: {order}.")
    for channel in channels:
        partner = {Part.COMMAND: Part.MEASURED, Part.MEASURED: Part.COMMAND}.get(channel.part)
        twin = pairs.get((partner, channel.actuator)) if partner else None
        if channel.part in DISPLACEMENTS and not channel.unit and twin is not None:
            if twin.unit:
                _require_plain_unit(columns, twin)
                _require_same_unit(columns, channel, twin)
                unit = unit_of(twin.unit)
                notes.append(
                    f"The {channel.part} displacement states no unit and was taken to be in {twin.unit} too."
                )
                factor = channel.factor * (unit.factor if unit else 1.0)
                result.append(replace(channel, unit=twin.unit, factor=factor))
                continue
            if channel.part is Part.COMMAND:
                owner = f" of actuator {channel.actuator}" if channel.actuator else ""
                notes.append(
                    f"Neither displacement{owner} states a unit of length: they were taken to share one, and "
                    "to be in metres."
                )
        elif channel.part in {Part.FORCE, Part.GROUND} and not channel.unit:
            unit_name = "N" if channel.part is Part.FORCE else "m/s²"
            notes.append(f"The {channel.part} states no unit and was taken to be in {unit_name}.")
        elif twin is not None and channel.part is Part.COMMAND and twin.unit not in {"", channel.unit}:
            notes.append(f"The command is stated in {channel.unit}, the measured in {twin.unit}.")
        result.append(channel)
    return result, notes


def _apply_header_unit(columns: Columns, channel: Channel) -> Channel:
    """Take the unit that a comment states for all channels of a kind, "units: mm" or "time unit: ms"."""
    words = {Part.TIME: ("time ",), Part.FORCE: ("force ",), Part.GROUND: ("acceleration ",)}
    names = (f"{word}{noun}" for word in words.get(channel.part, _LENGTH_WORDS) for noun in ("unit", "units"))
    units = (unit_of(columns.header.get(name, "")) for name in names)
    unit = next((unit for unit in units if unit and unit.quantity is QUANTITY_OF[channel.part]), None)
    if channel.unit or unit is None:
        return channel
    return replace(channel, unit=unit.text, factor=channel.factor * unit.factor)


def _apply_angle_unit(columns: Columns, channel: Channel) -> Channel:
    """Take a displacement that states no unit of length, but one of rotation, as a rotation [rad]."""
    unit = unit_of(columns.units.get(channel.column, "")) or split_unit(channel.column)[1]
    if channel.part not in DISPLACEMENTS or channel.unit or unit is None or unit.text not in ANGLES:
        return channel
    return replace(channel, unit=unit.text, factor=channel.factor * unit.factor)


def require_clear_numbers(
    columns: Columns, channels: Iterable[Channel], declarations: Mapping[Part, ChannelDeclaration]
) -> None:
    """Refuse an unknown unit, and what may be a scale, of a channel that the laboratory does not state."""
    for channel in channels:
        series, laboratory = (
            columns.series[channel.column],
            declarations.get(channel.part, ChannelDeclaration()),
        )
        if series.unclear and not laboratory.is_scaled:
            raise InputError(
                f"The file states {series.unclear} beside {channel.column!r}, but not whether its numbers "
                "contain it",
                remedy=f"State scale and zero of the {channel.part} in a file `channels.toml`, 1 and 0 if "
                "the numbers are in their unit",
                where=columns.location,
            )
        text = series.unit.strip()
        if unit_of(text) is None and text.lower() not in _NO_UNITS and not laboratory.unit:
            raise InputError(
                f"Unknown unit {text!r} of {channel.column!r}",
                remedy=f"State the unit of the {channel.part} in a file `channels.toml`",
                where=columns.location,
            )


def _possible_forces(columns: Columns, channels: Sequence[Channel]) -> list[str]:
    """Name nameless columns that the motion explains: a force, a velocity or a second sensor may do so."""
    measured_column = next((channel.column for channel in channels if channel.part is Part.MEASURED), None)
    if columns.named or measured_column is None or any(channel.part is Part.FORCE for channel in channels):
        return []
    used_columns = {channel.column for channel in channels}
    motion = columns.values[measured_column]
    candidates = [
        repr(name)
        for name, values in columns.values.items()
        if name not in used_columns and values.size == motion.size and moves(values)
        if share_explained(values, motion) >= _LEAST_EXPLAINED_SHARE
    ]
    if not candidates:
        return []
    columns_text = " and ".join(candidates)
    return [
        f"{columns_text} may hold the force, and is not used: state the column and its unit with `channels`."
    ]


def _require_plain_unit(columns: Columns, channel: Channel) -> None:
    """Ask what `disp_in` means where no other channel states a unit: inches, or an input."""
    if channel.unit == "in" and channel.column.lower().endswith("_in"):
        raise InputError(
            f"{channel.column!r} may be in inches, or an input",
            remedy="State the unit with `units`",
            where=columns.location,
        )


def _require_same_unit(columns: Columns, channel: Channel, partner: Channel) -> None:
    """Refuse to take one unit for two displacements of very different size."""
    ratio = compare(columns.values[partner.column], columns.values[channel.column]).ratio
    if not 1.0 / _LARGEST_RATIO < ratio < _LARGEST_RATIO and np.isfinite(ratio):
        raise InputError(
            f"{channel.column!r} states no unit, and is {significant(ratio)} times the size of "
            f"{partner.column!r} in {partner.unit}",
            remedy="Name the column with its unit, or state it in a file `channels.toml`",
            where=columns.location,
        )
