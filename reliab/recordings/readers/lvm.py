"""LabVIEW measurement files (.lvm): a header of names and values, then one table for each segment."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from reliab.encodings import as_utf8, decoded
from reliab.errors import InputError
from reliab.files import require_small
from reliab.recordings.readers.columns import Columns
from reliab.recordings.readers.text import TOO_LARGE, number_of, tables_of

if TYPE_CHECKING:
    from reliab.arrays import Array

_END: Final = "***End_of_Header***"
_MOST_BYTES: Final = 400_000_000
_SEPARATORS: Final = {"tab": "\t", "comma": ",", "semicolon": ";"}
_MOST_CHANNELS: Final = 1000


def recognises(head: bytes) -> bool:
    """Whether a file begins as one of LabVIEW."""
    return as_utf8(head).lstrip().startswith(b"LabVIEW Measurement")


def read_lvm(path: Path, delimiter: str | None = None) -> list[Columns]:
    """Read all segments of a file, each as a test."""
    require_small(path, _MOST_BYTES, remedy=f"{TOO_LARGE}, or export it as TDMS")
    lines = decoded(path.read_bytes()).splitlines()
    ends = [place for place, line in enumerate(lines) if line.strip().startswith(_END)]
    head = _values(lines[: ends[0]] if ends else [], "\t")
    separator = delimiter or _SEPARATORS.get(head.get("Separator", ("tab",))[0].lower(), "\t")
    bodies = list(_segments(lines, ends, separator))
    tests = [
        _segment(table, lines[begin:end], head, separator)
        for table, begin, end in _tables(bodies, lines, path, separator)
    ]
    if not tests:
        raise InputError(
            "A LabVIEW file must hold a segment of numbers",
            value="none",
            remedy="Export it again",
            where=path.name,
        )
    return tests if len(tests) == 1 else [replace(test, test=str(k)) for k, test in enumerate(tests, start=1)]


def _values(lines: Sequence[str], separator: str) -> dict[str, tuple[str, ...]]:
    """Names of a header with their values."""
    cells = [line.rstrip("\r\n").split(separator) for line in lines]
    return {row[0].strip(): tuple(cell.strip() for cell in row[1:]) for row in cells if len(row) > 1}


def _segments(lines: Sequence[str], ends: Sequence[int], separator: str) -> Iterator[tuple[int, int, int]]:
    """First line of the header of each segment, first and last line of its table."""
    for place, end in enumerate(ends[1:], start=1):
        following = ends[place + 1] if place + 1 < len(ends) else None
        last = len(lines)
        if following is not None:  # the header of the next segment begins with its channels
            last = next(
                (k for k in range(following, end, -1) if lines[k].split(separator)[0].strip() == "Channels"),
                following,
            )
        yield ends[place - 1] + 1, end + 1, last


def _tables(
    bodies: Sequence[tuple[int, int, int]], lines: Sequence[str], path: Path, separator: str
) -> Iterator[tuple[Columns, int, int]]:
    for begin, first, last in bodies:
        body = [_without_comment(line, separator) for line in lines[first:last]]
        if any(number_of(line.split(separator)[0].strip()) is not None for line in body if line.strip()):
            (table, *_) = tables_of(body, path, separator)
            moved = None if table.lines is None else table.lines + first
            yield replace(table, lines=moved), begin, first


def _without_comment(line: str, separator: str) -> str:
    """Leave out the last column of names and the delimiter before an empty one."""
    cells = line.rstrip("\r\n").split(separator)
    while len(cells) > 1 and cells[-1].strip() in {"", "Comment"}:
        cells.pop()
    if cells[0].strip() == "X_Value":
        cells = [f"X_Value {k}" if cell.strip() == "X_Value" else cell for k, cell in enumerate(cells)]
    return separator.join(cells)


def _segment(
    table: Columns, header: Sequence[str], head: Mapping[str, tuple[str, ...]], separator: str
) -> Columns:
    """Give a table units and times of its header; each channel may have times, all may, or none."""
    stated = _values(header, separator)
    names = list(table.values)
    xs = [name for name in names if name.startswith("X_Value")]
    ys = [name for name in names if name not in xs]
    layout = head.get("X_Columns", stated.get("X_Columns", ("One",)))[0].lower()
    units = dict(zip(ys, stated.get("Y_Unit_Label", ()), strict=False))
    steps = [number_of(cell) for cell in stated.get("Delta_X", ())][:_MOST_CHANNELS]
    begins = [number_of(cell) for cell in stated.get("X0", ())][:_MOST_CHANNELS]
    values = dict(table.values)
    clocks: dict[str, Array] = {}
    for place, name in enumerate(ys):
        step, begin = (_at(numbers, place) for numbers in (steps, begins))
        if layout == "no" and step:
            clocks[name] = (begin or 0.0) + step * np.arange(values[name].size, dtype=np.float64)
        elif layout == "multi" and place < len(xs):
            clocks[name] = values[xs[place]]
    if layout in {"no", "multi"}:
        values = {name: values[name] for name in ys}
    else:
        units |= dict.fromkeys(xs, "s")
        values = {("Time" if name in xs[:1] else name): history for name, history in values.items()}
        units |= {"Time": "s"}
    return replace(table, values=values, units={k: v for k, v in units.items() if k in values}, clocks=clocks)


def _at(numbers: Sequence[float | None], place: int) -> float | None:
    value = numbers[place] if place < len(numbers) else None
    return value if value is not None and np.isfinite(value) else None
