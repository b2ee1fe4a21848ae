"""LabVIEW measurement files (.lvm): a header of names and values, then one table for each segment.

Each channel has its own date, time of day, first time `X0` and step `Delta_X`; in the header they stand where
its column stands in the table. Segments in which all channels go on are one test.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np

from reliab.core.arrays import Array
from reliab.core.encodings import as_utf8
from reliab.core.errors import InputError
from reliab.core.text_tables import cells_of, number_of
from reliab.recordings.readers.columns import Columns, Series, date_of
from reliab.recordings.readers.text import join_tables, lines_of_file, tables_of

_END: Final = "***End_of_Header***"
_SEPARATOR: Final = re.compile(r"Separator(\W)")
_ABSOLUTE: Final = 1e8  # s, from which times count from LabVIEW's own date
_FIRST_DATE: Final = np.datetime64("1904-01-01", "ns")


def recognises(head: bytes) -> bool:
    """Whether a file begins as one of LabVIEW."""
    return as_utf8(head).lstrip().startswith(b"LabVIEW Measurement")


def read_lvm(path: Path, delimiter: str | None = None) -> list[Columns]:
    """Read the tests of a file, each of one segment or of several that go on one another."""
    lines = lines_of_file(path)
    ends = [place for place, line in enumerate(lines) if line.strip().startswith(_END)]
    header_end = lines[: ends[0] if ends else 0]
    separator = delimiter or next(
        (match[1] for line in header_end if (match := _SEPARATOR.match(line))), "\t"
    )
    head = _values(header_end, separator)
    tables = []
    for begin, first, last in _segments(lines, ends, separator):
        segment = _Segment(
            names=cells_of(lines[first], separator), stated=_values(lines[begin:first], separator), head=head
        )
        if (table := _table(lines, first, last, separator, path)) is not None:
            tables.append(replace(table, series=segment.series(table)))
    if not tables:
        raise InputError(
            "No segment of numbers in the LabVIEW file", remedy="Export it again", where=path.name
        )
    return join_tables(tables)


def _values(lines: Sequence[str], separator: str) -> dict[str, tuple[str, ...]]:
    """Names of a header with their values."""
    rows = [cells_of(line, separator) for line in lines]
    return {row[0]: row[1:] for row in rows if len(row) > 1}


def _segments(lines: Sequence[str], ends: Sequence[int], separator: str) -> Iterator[tuple[int, int, int]]:
    """First line of the header of each segment, the line of its names, and the end of its table."""
    for place, end in enumerate(ends[1:], start=1):
        following = ends[place + 1] if place + 1 < len(ends) else None
        last = len(lines)
        if following is not None:  # the header of the next segment begins with its channels
            last = next(
                (k for k in range(following, end, -1) if lines[k].split(separator)[0].strip() == "Channels"),
                following,
            )
        if end + 1 < last:
            yield ends[place - 1] + 1, end + 1, last


def _table(lines: Sequence[str], first: int, last: int, separator: str, path: Path) -> Columns | None:
    """Rows of a segment without their comments; None where there are none."""
    names = cells_of(lines[first], separator)
    width = names.index("Comment") if "Comment" in names else len(names)
    names = tuple(f"X_Value {k}" if name == "X_Value" else name for k, name in enumerate(names[:width]))
    rows = [
        separator.join(cells) if any(cells := cells_of(line, separator)[:width]) else ""
        for line in lines[first + 1 : last]
    ]
    if not any(number_of(row.split(separator)[0].strip()) is not None for row in rows if row):
        return None
    table, *other_tables = tables_of([separator.join(names), *rows], path, separator, lines_above=first)
    if other_tables:
        raise InputError(
            "A line without numbers between the rows of a segment",
            remedy="Remove it",
            where=f"{path.name}, {other_tables[0].place(0).rpartition(', ')[2]}",
        )
    return table


@dataclass(frozen=True, kw_only=True)
class _Segment:
    """The names of the columns of a segment, and what its header states of each at the same place."""

    names: tuple[str, ...]
    stated: Mapping[str, tuple[str, ...]]  # In its header
    head: Mapping[str, tuple[str, ...]]  # In that of the file

    def series(self, table: Columns) -> dict[str, Series]:
        """Give each channel its unit, times and date."""
        xs = [place for place, name in enumerate(self.names) if name == "X_Value"]
        channels = [
            place for place, name in enumerate(self.names) if name in table.series and place not in xs
        ]
        layout = {**self.stated, **self.head}.get("X_Columns", ("One",))[0].lower()
        series = {}
        for place in channels:
            x = max((x for x in xs if x < place), default=None) if layout != "no" else None
            owner = channels[0] if layout == "one" else place
            times = None if x is None else table.values[f"X_Value {x}"]
            series[self.names[place]] = self._channel(place, table.values[self.names[place]], times, owner)
        return series

    def _channel(self, place: int, values: Array, x: Array | None, owner: int) -> Series:
        """One channel; `x` are times [s] of the channel `owner`."""
        samples = self._number(place, "Samples", values.size)
        values = values[: int(samples)]
        step, begin = self._number(place, "Delta_X", 0.0), self._number(place, "X0", 0.0)
        times = begin + step * np.arange(values.size, dtype=np.float64) if step else None
        if x is not None and self._number(owner, "Delta_X", 0.0) == step:
            times = x[: values.size] + begin - self._number(owner, "X0", 0.0)
        start = date_of(f"{self._text(place, 'Date')} {self._text(place, 'Time')}")
        if times is not None and times.size and abs(times[0]) > _ABSOLUTE:
            whole_seconds = np.floor(times[0])
            times, start = times - whole_seconds, _FIRST_DATE + np.timedelta64(int(whole_seconds), "s")
        dimension = self._text(place, "X_Dimension")
        return Series(
            values=values,
            unit=self._text(place, "Y_Unit_Label"),
            times=times,
            times_unit="s" if dimension in {"", "Time"} else dimension,
            start=None if times is None else start,
        )

    def _text(self, place: int, name: str) -> str:
        cells = self.stated.get(name, ())
        single = [cell for cell in cells if cell]
        if len(single) == 1:
            return single[0]
        return cells[place - 1] if 0 < place <= len(cells) else ""

    def _number(self, place: int, name: str, default: float) -> float:
        number = number_of(self._text(place, name))
        return number if number is not None and np.isfinite(number) else default
