"""Rows of a text that is still being written, as its lines become complete.

The text has any dialect of :mod:`reliab.recordings.readers.text`. Of a file that was rotated (replaced by
another one of the same name, or shortened) an empty piece comes first; its header is read anew, or is that of
the file before where it has none.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

import numpy as np

from reliab.arrays import Array
from reliab.encodings import pieces_as_utf8
from reliab.errors import InputError
from reliab.recordings.actuator_pairs import numbers_of_pairs, with_numbered_pairs
from reliab.recordings.channel import DISPLACEMENTS, Channel, Part, Stated
from reliab.recordings.readers import Columns
from reliab.recordings.readers.text import (
    begins_table,
    cells_of,
    delimiter_of,
    header_of,
    is_comment,
    number_of,
    statements_of,
)
from reliab.recordings.reading import stated_in
from reliab.recordings.recognition import recognise
from reliab.stated_value import StatedValue

_LONGEST_LINE: Final = 1 << 16
_LONGEST_PREAMBLE: Final = 10_000  # lines


@dataclass(frozen=True, kw_only=True, eq=False)
class Rows:
    """Rows that were added."""

    time: Array | None  # Times [s], shape (k,); None without a column of time
    # command, measured: x_c and x_m [m], shape (k,), or of several actuators (p, k)
    command: Array
    measured: Array
    force: Array | None = None  # Force of the specimen [N], shape (k,); None where it is not asked for
    stated: Mapping[str, StatedValue] = field(default_factory=dict)  # What the header states of the test
    actuators: tuple[str, ...] = ("",)  # Numbers of the channels, by rows; one without a number


@dataclass(frozen=True, kw_only=True)
class _Wanted:
    """What is looked for in a text: its name, what is stated of channels, and which there must be."""

    name: str
    stated: Mapping[Part, Stated]
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


def rows_as_written(
    pieces: Iterator[bytes],
    *,
    name: str,
    stated: Mapping[Part, Stated],
    also: Sequence[Part] = (),
    several: bool = False,
) -> Iterator[Rows]:
    """Rows of a text that comes in pieces.

    `name` is that of its file, `also` which columns it must have beside both displacements, `several` whether
    these are of several actuators, as command_1, measured_1, command_2, …
    """
    wanted = _Wanted(name=name, stated=stated, also=tuple(also), several=several)
    remainder, number = b"", 0
    layout: _Layout | None = None
    waiting: list[tuple[int, str]] = []
    before: _Layout | None = None
    for piece in pieces_as_utf8(pieces):
        if not piece:
            remainder, waiting, before, layout = b"", [], layout or before, None
            continue
        *whole, remainder = (remainder + piece).split(b"\n")
        if len(remainder) > _LONGEST_LINE:
            raise InputError(
                f"A line of a test must be shorter than {_LONGEST_LINE} characters",
                value=f"more after line {number + len(whole)}",
                remedy="Write one sample in a line",
                where=name,
            )
        lines = [
            (number + k, raw.decode("utf-8-sig", errors="replace").rstrip("\r"))
            for k, raw in enumerate(whole, 1)
        ]
        number += len(whole)
        if layout is None:
            waiting += lines
            layout, lines = _begun(waiting, wanted, before)
        if layout is not None and (rows := [line for line in lines if not is_comment(line[1])]):
            yield _parsed(rows, layout, name)
    if layout is None and before is None:
        _explain(waiting, wanted)


def _explain(waiting: list[tuple[int, str]], wanted: _Wanted) -> None:
    """Say what is wrong with a text in which no two rows of numbers stand below names."""
    lines = [(number, line) for number, line in waiting if not is_comment(line)]
    if len(lines) > 1:
        delimiter = delimiter_of([line for _, line in lines])
        first = next((k for k, (_, line) in enumerate(lines) if _has_number(line, delimiter)), len(lines))
        if 0 < first < len(lines):
            above = [line for _, line in lines[:first]]
            _parsed(lines[first:], _layout(above, above[-1], delimiter, wanted), wanted.name)


def _has_number(line: str, delimiter: str) -> bool:
    return any(number_of(cell) is not None and cell for cell in cells_of(line, delimiter))


def _begun(
    waiting: list[tuple[int, str]], wanted: _Wanted, before: _Layout | None
) -> tuple[_Layout | None, list[tuple[int, str]]]:
    """Layout of a text, as soon as a row stands below names, or two rows do, and the lines from there."""
    lines = [line for _, line in waiting]
    delimiter = delimiter_of(lines) if before is None else before.delimiter
    for place, line in enumerate(lines):
        if is_comment(line):
            continue
        if begins_table(lines, delimiter, place) or _stands_below_names(lines[: place + 1], delimiter):
            above = [text for text in lines[:place] if text.strip()]
            named = before if before is not None and not above else _layout(above, line, delimiter, wanted)
            return named, waiting[place:]
    if len(lines) > _LONGEST_PREAMBLE:
        raise InputError(
            f"Rows of numbers must begin within {_LONGEST_PREAMBLE:,} lines",
            value="none",
            where=wanted.name,
            remedy="Write command and measured displacement as columns",
        )
    return None, []


def _stands_below_names(lines: list[str], delimiter: str) -> bool:
    """Whether the last line is a row of numbers, and the one above it has as many names."""
    cells = cells_of(lines[-1], delimiter)
    if len(lines) < 2 or len(cells) < 2 or any(number_of(cell) is None for cell in cells):  # noqa: PLR2004
        return False
    return (
        len(cells_of(lines[-2], delimiter)) == len(cells)
        and header_of(lines[-2:-1], len(cells), delimiter).named
    )


def _layout(above: list[str], line: str, delimiter: str, wanted: _Wanted) -> _Layout:
    width = len(cells_of(line, delimiter))
    header = header_of(above, width, delimiter)
    if not header.named:
        raise InputError(
            "A test that is followed must begin with a line that names its columns",
            value=repr(line[:40]),
            remedy="Write time_s,command_m,measured_m as the first line",
            where=wanted.name,
        )
    columns = Columns(
        path=Path(wanted.name),
        values={column: np.zeros(0) for column in header.names},
        units=dict(zip(header.names, header.units, strict=False)),
        header=dict(statements_of(above)),
    )
    columns = with_numbered_pairs(columns) if wanted.several else columns
    recognised = recognise(columns, wanted.stated, histories=False)
    if not wanted.several:
        _require_one(recognised, wanted.name)
    parts = {Part.TIME, *DISPLACEMENTS, *wanted.also}
    channels = {
        (channel.part, channel.actuator): (header.names.index(channel.column), channel)
        for channel in recognised
        if channel.part in parts
    }
    for part in wanted.also:
        if part not in {of for of, _ in channels}:
            raise InputError(
                f"A test that is followed like this needs a column of its {part}",
                value=", ".join(header.names),
                remedy="Record it, or name it and its unit in a file `channels.toml` for `channels`",
                where=wanted.name,
            )
    return _Layout(
        delimiter=delimiter,
        width=width,
        channels=channels,
        actuators=numbers_of_pairs(channels),
        stated=stated_in(columns),
    )


def _require_one(recognised: Sequence[Channel], name: str) -> None:
    """Refuse channels of several actuators."""
    if any(channel.actuator for channel in recognised):
        raise InputError(
            "A test that is followed must be of one actuator",
            value=" and ".join(repr(channel.column) for channel in recognised if channel.actuator),
            remedy="Choose a pair with `command` and `measured`, or state the `structure` that all drive",
            where=name,
        )


def _parsed(lines: list[tuple[int, str]], layout: _Layout, name: str) -> Rows:
    read: dict[tuple[Part, str], list[float]] = {key: [] for key in layout.channels}
    for number, line in lines:
        cells = cells_of(line, layout.delimiter)
        if len(cells) != layout.width:
            raise InputError(
                f"Every line must have {layout.width} columns, as the first has",
                value=len(cells),
                remedy="Mend the line",
                where=f"{name}, line {number}",
            )
        for key, (place, _) in layout.channels.items():
            value = number_of(cells[place])
            if value is None or not np.isfinite(value):
                raise InputError(
                    "Every value must be a finite number",
                    value=repr(cells[place]),
                    remedy="Mend the line",
                    where=f"{name}, line {number}, column {key[0]}",
                )
            read[key].append(value)
    histories = {key: layout.channels[key][1].in_si(np.array(values)) for key, values in read.items()}
    command, measured = (
        np.stack([histories[part, number] for number in layout.actuators]) for part in DISPLACEMENTS
    )
    one = layout.actuators == ("",)
    return Rows(
        time=histories.get((Part.TIME, "")),
        command=command[0] if one else command,
        measured=measured[0] if one else measured,
        force=histories.get((Part.FORCE, "")),
        stated=layout.stated,
        actuators=layout.actuators,
    )
