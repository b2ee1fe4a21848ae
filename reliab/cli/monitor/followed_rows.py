"""Rows of a text that is still being written: a growing file, or standard input.

A line is read only when it is complete. A file that was rotated (replaced by another one of the same name,
or shortened) is read to its end, and then from the beginning of the new one, whose header is skipped.
"""

import os
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import numpy as np
import typer
from numpy.typing import NDArray

from reliab.cli.printable import printable
from reliab.encodings import pieces_as_utf8
from reliab.errors import InputError
from reliab.files import ordinary
from reliab.recordings import DISPLACEMENTS, LENGTHS, TIMES, Part, recognise
from reliab.recordings.readers import Columns

_POLL = 0.05  # s between two looks at a file that does not grow
_BYTES = 1 << 16
_LONGEST_LINE = 1 << 16
_COMMENTS = ("#", "%", "//", "!")
_DELIMITERS = (";", "\t", ",", None)


@dataclass(frozen=True, kw_only=True, eq=False)
class Rows:
    """Rows that were added."""

    time: NDArray[np.float64] | None  # Times [s], shape (k,); None without a column of time
    command: NDArray[np.float64]  # command, measured: x_c and x_m [m], shape (k,)
    measured: NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class _Layout:
    """Where the columns stand, and their scales to SI units."""

    header: str
    delimiter: str | None
    width: int
    places: dict[Part, int]
    scales: dict[Part, float]


def chunks_of_text(source: str, wait: float, start_within: float) -> Iterator[bytes]:
    """Bytes of a growing file, or of standard input, as they come."""
    if source == "-":
        while piece := os.read(sys.stdin.fileno(), _BYTES):
            yield piece
        return
    path = Path(source)
    stream = _awaited(path, start_within)
    idle, lines = 0.0, 0
    try:
        while idle <= (wait if lines > 1 else start_within):
            if piece := stream.read(_BYTES):
                idle, lines = 0.0, lines + piece.count(b"\n")
                yield piece
            elif _rotated(path, stream):
                stream.close()
                stream = _opened(path)
                yield b""
            else:
                time.sleep(_POLL)
                idle += _POLL
    finally:
        stream.close()


def _awaited(path: Path, limit: float) -> BinaryIO:
    """Open a file that a logger may still have to create in its folder."""
    if not path.exists() and path.absolute().parent.is_dir():
        typer.echo(
            f"Waiting up to {limit:g} s for {printable(path.name)}, which is not there yet; Ctrl-C ends it.",
            file=sys.stderr,
        )
        until = time.monotonic() + limit
        while not path.exists() and time.monotonic() < until:
            time.sleep(_POLL)
    return _opened(path)


def _opened(path: Path) -> BinaryIO:
    try:
        return ordinary(path).open("rb")
    except OSError as error:
        raise InputError(
            "The file must be readable",
            value=error.strerror,
            remedy="Name the file that the test is or will be written to, or - for standard input; "
            "--start-within gives its logger more time",
            where=str(path),
        ) from error


def _rotated(path: Path, stream: BinaryIO) -> bool:
    """Return whether the file was replaced by another one, or shortened."""
    try:
        now = path.stat()
    except OSError:
        return False  # between two names; it will come
    here = os.fstat(stream.fileno())
    return now.st_ino != here.st_ino or now.st_size < stream.tell()


def rows_of(
    pieces: Iterator[bytes], *, name: str, declared: dict[Part, str], units: str | None
) -> Iterator[Rows]:
    """Rows of a text that comes in pieces."""
    remainder, number = b"", 0
    layout: _Layout | None = None
    for piece in pieces_as_utf8(pieces):
        if not piece:
            remainder = b""
            continue
        *whole, remainder = (remainder + piece).split(b"\n")
        if len(remainder) > _LONGEST_LINE:
            raise InputError(
                f"A line of a test must be shorter than {_LONGEST_LINE} characters",
                value=f"more after line {number + len(whole)}",
                remedy="Write one sample in a line",
                where=name,
            )
        lines = []
        for raw in whole:
            number += 1
            line = raw.decode("utf-8-sig", errors="replace").strip()
            if not line or line.startswith(_COMMENTS):
                continue
            if layout is None:
                layout = _layout(line, name, declared, units)
            elif line != layout.header:
                lines.append((number, line))
        if layout is not None and lines:
            yield _parsed(lines, layout, name)


def _layout(line: str, name: str, declared: dict[Part, str], units: str | None) -> _Layout:
    delimiter = next(sign for sign in _DELIMITERS if sign is None or sign in line)
    cells = [cell.strip().strip('"') for cell in line.split(delimiter)]
    if _number(cells[0]) is not None:
        raise InputError(
            "A test that is followed must begin with a line that names its columns",
            value=repr(line[:40]),
            remedy="Write time_s,command_m,measured_m as the first line",
            where=name,
        )
    if units is not None and units not in LENGTHS:
        raise InputError(
            "The unit must be one of length", value=units, remedy=f"Choose among {', '.join(LENGTHS)}"
        )
    empty = {cell: np.zeros(0) for cell in cells}
    recognised = recognise(Columns(path=Path(name), values=empty), declared, wanted=DISPLACEMENTS)
    scales = {
        part: TIMES.get(column.unit, 1.0) if part is Part.TIME else LENGTHS.get(units or column.unit, 1.0)
        for part, column in recognised.items()
    }
    places = {part: cells.index(column.name) for part, column in recognised.items()}
    return _Layout(header=line, delimiter=delimiter, width=len(cells), places=places, scales=scales)


def _parsed(lines: list[tuple[int, str]], layout: _Layout, name: str) -> Rows:
    columns: dict[Part, list[float]] = {part: [] for part in layout.places}
    for number, line in lines:
        cells = line.split(layout.delimiter)
        if len(cells) != layout.width:
            raise InputError(
                f"Every line must have {layout.width} columns, as the first has",
                value=len(cells),
                remedy="Mend the line",
                where=f"{name}, line {number}",
            )
        for part, place in layout.places.items():
            value = _number(cells[place])
            if value is None or not np.isfinite(value):
                raise InputError(
                    "Every value must be a finite number",
                    value=repr(cells[place].strip()),
                    remedy="Mend the line",
                    where=f"{name}, line {number}, column {part}",
                )
            columns[part].append(value)
    histories = {part: np.array(values) * layout.scales[part] for part, values in columns.items()}
    return Rows(
        time=histories.get(Part.TIME),
        command=histories[Part.COMMAND],
        measured=histories[Part.MEASURED],
    )


def _number(cell: str) -> float | None:
    try:
        return float(cell)
    except ValueError:
        return None
