"""Rows of a text that is still being written, as its lines become complete, at equal steps, without skew.

The text has any dialect of :mod:`reliab.recordings.readers.text`. Of a file that was rotated (replaced by
another one of the same name, or shortened) an empty piece comes first; its header is read anew, or is that of
the file before where it has none.
"""

import os
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import BinaryIO, Final

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.encodings import pieces_as_utf8
from reliab.core.errors import InputError
from reliab.core.files import ordinary
from reliab.core.stated_value import StatedValue
from reliab.core.text_tables import Line, TimesOfDay, cells_of, is_comment, number_of, time_of_day
from reliab.recordings.readers.columns import Columns, Series
from reliab.recordings.readers.text import begins_table, delimiter_of, header_of
from reliab.recordings.reading import (
    number_pairs,
    numbers_of_pairs,
    read_statements,
    require_clear_numbers,
)
from reliab.recordings.recognition import recognise
from reliab.recordings.recording import DISPLACEMENTS, LARGEST_READING, Channel, ChannelDeclaration, Part

_POLL = 0.05  # s between two looks at a file that does not grow
_BYTES = 1 << 16

_LONGEST_LINE: Final = 1 << 16
_LONGEST_PREAMBLE: Final = 10_000  # lines


def chunks_of_text(
    source: str, wait: float, start_within: float, say: Callable[[str], None] = lambda _sentence: None
) -> Iterator[bytes]:
    """Bytes of a growing file, or of standard input, as they come; `say` tells that a file is awaited."""
    if source == "-":
        while piece := os.read(sys.stdin.fileno(), _BYTES):
            yield piece
        return
    path = Path(source)
    stream = _wait_for(path, start_within, say)
    idle, lines = 0.0, 0
    try:
        while idle <= (wait if lines > 1 else start_within):
            if piece := stream.read(_BYTES):
                idle, lines = 0.0, lines + piece.count(b"\n")
                yield piece
            elif _is_replaced(path, stream):
                stream.close()
                stream = _open(path)
                yield b""
            else:
                time.sleep(_POLL)
                idle += _POLL
    finally:
        stream.close()


def _wait_for(path: Path, limit: float, say: Callable[[str], None]) -> BinaryIO:
    """Open a file that a logger may still have to create in its folder."""
    if not path.exists() and path.absolute().parent.is_dir():
        say(f"Waiting up to {limit:g} s for {path.name}, which does not exist yet; Ctrl-C ends the waiting.")
        deadline = time.monotonic() + limit
        while not path.exists() and time.monotonic() < deadline:
            time.sleep(_POLL)
    return _open(path)


def _open(path: Path) -> BinaryIO:
    try:
        return ordinary(path).open("rb")
    except OSError as error:
        raise InputError(
            f"Cannot read the file: {error.strerror}",
            remedy="Name the file that the test is or will be written to, or - for standard input; "
            "`start_within` gives its logger more time",
            where=str(path),
        ) from error


def _is_replaced(path: Path, stream: BinaryIO) -> bool:
    """Return whether the file was replaced by another one, or shortened."""
    try:
        now = path.stat()
    except OSError:
        return False  # between two names; it will come
    here = os.fstat(stream.fileno())
    return now.st_ino != here.st_ino or now.st_size < stream.tell()


@dataclass(frozen=True, kw_only=True, eq=False)
class Rows:
    """Rows that were added."""

    time: Array | None  # Times [s], shape (k,); None without a column of time
    # command, measured: x_c and x_m [m], shape (k,), or of several actuators (p, k)
    command: Array
    measured: Array
    force: Array | None = None  # Force of the specimen [N], shape (k,); None where it is not asked for
    ground: Array | None = None  # Ground acceleration [m/s²], shape (k,); None where it is not recorded
    stated: Mapping[str, StatedValue] = field(default_factory=dict)  # What the header states of the test
    actuators: tuple[str, ...] = ("",)  # Numbers of the channels, by rows; one without a number
    lines: NDArray[np.int64] | None = None  # Line of each row in its file, shape (k,)
    name: str = "the test"  # Of its file

    def place(self, row: int) -> str:
        """Say where a row stands, for an error."""
        return self.name if self.lines is None else f"{self.name}, line {self.lines[row]}"

    def part(self, rows: slice) -> "Rows":
        """Return some of the rows."""
        return replace(
            self,
            time=None if self.time is None else self.time[rows],
            command=self.command[..., rows],
            measured=self.measured[..., rows],
            force=None if self.force is None else self.force[rows],
            ground=None if self.ground is None else self.ground[rows],
            lines=None if self.lines is None else self.lines[rows],
        )


@dataclass(frozen=True, kw_only=True)
class _Request:
    """What is looked for in a text: its name, what is stated of channels, and which there must be."""

    name: str
    stated: Mapping[Part, ChannelDeclaration]
    also: tuple[Part, ...]
    several: bool


@dataclass(frozen=True, kw_only=True)
class _Layout:
    """Where the columns stand, and what was recognised."""

    delimiter: str
    width: int
    channels: Mapping[tuple[Part, str], tuple[int, Channel]]  # Place of each, and how it is read
    actuators: tuple[str, ...]
    stated: Mapping[str, StatedValue]
    times_of_day: TimesOfDay | None  # Where the times are such


def rows_as_written(
    pieces: Iterator[bytes],
    *,
    name: str,
    declarations: Mapping[Part, ChannelDeclaration],
    also: Sequence[Part] = (),
    has_several: bool = False,
) -> Iterator[Rows]:
    """Rows of a text that comes in pieces.

    `name` is that of its file, `also` which columns it must have beside both displacements, `has_several`
    whether these are of several actuators, as command_1, measured_1, command_2, …
    """
    request = _Request(name=name, stated=declarations, also=tuple(also), several=has_several)
    remainder, number = b"", 0
    layout: _Layout | None = None
    waiting: list[tuple[int, str]] = []
    layout_above: _Layout | None = None
    for piece in pieces_as_utf8(pieces):
        if not piece:
            remainder, waiting, layout_above, layout = b"", [], layout or layout_above, None
            continue
        *complete_lines, remainder = (remainder + piece).split(b"\n")
        if len(remainder) > _LONGEST_LINE:
            raise InputError(
                f"Line {number + len(complete_lines) + 1} has more than {_LONGEST_LINE} characters",
                remedy="Write one sample in each line",
                where=name,
            )
        lines = [
            (number + k, raw.decode("utf-8-sig", errors="replace").rstrip("\r"))
            for k, raw in enumerate(complete_lines, 1)
        ]
        number += len(complete_lines)
        if layout is None:
            waiting += lines
            layout, lines = _detect_layout(waiting, request, layout_above)
        if layout is not None and (rows := [line for line in lines if not is_comment(line[1])]):
            yield _parse(rows, layout, name)
    if layout is None and layout_above is None:
        _explain(waiting, request)


def _explain(waiting: list[tuple[int, str]], request: _Request) -> None:
    """Say what is wrong with a text in which no two rows of numbers stand below names."""
    lines = [(number, line) for number, line in waiting if not is_comment(line)]
    if len(lines) > 1:
        delimiter = delimiter_of([line for _, line in lines])
        first = next((k for k, (_, line) in enumerate(lines) if _has_number(line, delimiter)), len(lines))
        if 0 < first < len(lines):
            header_lines = [line for _, line in lines[:first]]
            _parse(lines[first:], _layout(header_lines, header_lines[-1], delimiter, request), request.name)


def _has_number(line: str, delimiter: str) -> bool:
    return any(number_of(cell) is not None and cell for cell in cells_of(line, delimiter))


def _detect_layout(
    waiting: list[tuple[int, str]], request: _Request, layout: _Layout | None
) -> tuple[_Layout | None, list[tuple[int, str]]]:
    """Layout of a text, as soon as a row stands below names, or two rows do, and the lines from there."""
    lines = [line for _, line in waiting]
    delimiter = delimiter_of(lines) if layout is None else layout.delimiter
    for place, line in enumerate(lines):
        if is_comment(line):
            continue
        if begins_table(lines, delimiter, place) or _stands_below_names(lines[: place + 1], delimiter):
            header = lines[:place]
            has_names = any(text.strip() for text in header)
            name_lines = (
                layout if layout is not None and not has_names else _layout(header, line, delimiter, request)
            )
            return name_lines, waiting[place:]
    if len(lines) > _LONGEST_PREAMBLE:
        raise InputError(
            f"No rows of numbers in the first {_LONGEST_PREAMBLE:,} lines",
            remedy="Write command and measured displacement as columns",
            where=request.name,
        )
    return None, []


def _stands_below_names(lines: list[str], delimiter: str) -> bool:
    """Whether the last line is a row of numbers, perhaps with texts, below as many names."""
    cells = cells_of(lines[-1], delimiter)
    if len(lines) < 2 or Line(cells=cells).numbers < 2:  # noqa: PLR2004 - command and measured
        return False
    return (
        len(cells_of(lines[-2], delimiter)) == len(cells)
        and header_of(lines[-2:-1], len(cells), delimiter).named
    )


def _layout(header_lines: list[str], line: str, delimiter: str, request: _Request) -> _Layout:
    cells = cells_of(line, delimiter)
    width = len(cells)
    header = header_of(header_lines, width, delimiter, location=request.name)
    if not header.named:
        raise InputError(
            f"The first line names no columns: {line[:40]!r}",
            remedy="Write time_s,command_m,measured_m as the first line",
            where=request.name,
        )
    columns = Columns(
        path=Path(request.name),
        series={
            column: Series(values=np.zeros(0), unit=unit, unclear=unclear)
            for column, unit, unclear in zip(header.names, header.units, header.unclear, strict=True)
        },
        header=header.statements,
    )
    columns = number_pairs(columns) if request.several else columns
    recognised_channels = recognise(columns, request.stated, histories=False)
    if not request.several:
        _require_one(recognised_channels, request.name)
    parts = {Part.TIME, Part.GROUND, *DISPLACEMENTS, *request.also}
    channels = {
        (channel.part, channel.actuator): (header.names.index(channel.column), channel)
        for channel in recognised_channels
        if channel.part in parts
    }
    require_clear_numbers(columns, (channel for _, channel in channels.values()), request.stated)
    time = channels.get((Part.TIME, ""))
    _require_columns(request, {part for part, _ in channels}, header.names)
    return _Layout(
        delimiter=delimiter,
        width=width,
        channels=channels,
        actuators=numbers_of_pairs(channels),
        stated=read_statements(columns),
        times_of_day=TimesOfDay() if time is not None and number_of(cells[time[0]]) is None else None,
    )


def _require_columns(request: _Request, parts: set[Part], names: Sequence[str]) -> None:
    """Refuse a text without the columns that are needed beside both displacements."""
    for part in request.also:
        if part not in parts:
            raise InputError(
                f"No column for the {part}",
                remedy="Record it, or name it and its unit in a file `channels.toml` for `channels`. "
                f"Columns in the file: {', '.join(names)}",
                where=request.name,
            )


def _require_one(channels: Sequence[Channel], name: str) -> None:
    """Refuse channels of several actuators."""
    if any(channel.actuator for channel in channels):
        raise InputError(
            "The file holds the channels of several actuators: "
            + " and ".join(repr(channel.column) for channel in channels if channel.actuator),
            remedy="Choose a pair with `command` and `measured`, or state the `structure` that all drive",
            where=name,
        )


def _parse(lines: list[tuple[int, str]], layout: _Layout, name: str) -> Rows:
    read: dict[tuple[Part, str], list[float]] = {key: [] for key in layout.channels}
    for number, line in lines:
        cells = cells_of(line, layout.delimiter)
        if len(cells) != layout.width:
            raise InputError(
                f"{len(cells)} columns, but {layout.width} in the first line",
                remedy="Correct the line",
                where=f"{name}, line {number}",
            )
        for key, (place, channel) in layout.channels.items():
            is_time_of_day = key[0] is Part.TIME and layout.times_of_day is not None
            value = time_of_day(cells[place]) if is_time_of_day else number_of(cells[place])
            if value is None or not abs(value) < LARGEST_READING:
                raise InputError(
                    f"Not a finite number below {LARGEST_READING:g}",
                    value=repr(cells[place]),
                    remedy="Correct the line",
                    where=f"{name}, line {number}, column {channel.column}",
                )
            read[key].append(value)
    readings = {key: np.array(values) for key, values in read.items()}
    if layout.times_of_day is not None:
        readings[Part.TIME, ""] = layout.times_of_day.count_seconds(readings[Part.TIME, ""])
    histories = {key: layout.channels[key][1].convert_to_si(values) for key, values in readings.items()}
    command, measured_rows = (
        np.stack([histories[part, number] for number in layout.actuators]) for part in DISPLACEMENTS
    )
    is_single = layout.actuators == ("",)
    return Rows(
        time=histories.get((Part.TIME, "")),
        command=command[0] if is_single else command,
        measured=measured_rows[0] if is_single else measured_rows,
        force=histories.get((Part.FORCE, "")),
        ground=histories.get((Part.GROUND, "")),
        stated=layout.stated,
        actuators=layout.actuators,
        lines=np.array([number for number, _ in lines]),
        name=name,
    )
