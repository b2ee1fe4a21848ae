"""Which numbers of a text are samples of which component, and which are times or sample numbers.

A line above the numbers names the columns: ``time [s], acceleration [m/s2]``, ``N-S  E-W  U-D`` or
``#DataSequence: Time U(+); N(+); E(+)``. Two columns without names are times and samples. Several numbers in
a line follow one another if there are as many as the header states.
"""

import itertools
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from reliab.core.text_tables import printed_number
from reliab.motions.faults import Report
from reliab.motions.readers import statements
from reliab.motions.readers.header import Header, Statement
from reliab.motions.readers.layouts import Layout
from reliab.motions.readers.samples import count_rows, find_delimiter, separated, split_line
from reliab.motions.readers.source import Line, Source
from reliab.motions.units import CLOCK_UNIT, AccelerationUnit, ClockUnit, find_clock_unit, find_unit

_FLAGS = re.IGNORECASE
_LABEL = re.compile(r"^[A-Za-z ]*:\s*")
_WORDS = re.compile(r"[^\s;,\[(]+(?:\s*[\[(][^\])]*[\])])?")
_UNIT = re.compile(r"\s*[\[(]([^\])]*)[\])]\s*$")
_ROWS = 20  # lines in which times are looked for
_ROUNDED = 0.5  # largest spread of steps between times, as a share of their mean
_KINDS = {
    "time": rf"(?:rel\w*[ _]?)?(?:time|tiempo|zeit)(?:[ _]*(?:in )?{CLOCK_UNIT})?|t(?:_{CLOCK_UNIT})?",
    "sample number": r"no\.?|nr\.?|#|index|samples?|points?|count|row",
    "acceleration": r"a(?:cc[\w /^*.-]*|\w|[ _]\w{1,5})?",
    "another": r"(?:vel|dis|pressure|temp|force|strain|load)[\w .-]*",
    "component": r"[nsewudzxyrlthv]{1,2}|n-?s|e-?w|u-?d|up|down|vert\w*|north\w*|east\w*|long\w*|tran\w*"
    r"|rad\w*|hor\w*[ _]?\d?|h\d|[hbe][ng][nez\d]|(?:ch|chan|channel|canal|comp|component)[ _.-]?\w{1,2}"
    r"|[ns]\d{1,3}[ew]|\d{1,3}(?: ?deg\w*)?",
}
_KIND_PATTERNS = {kind: re.compile(pattern, _FLAGS) for kind, pattern in _KINDS.items()}


@dataclass(frozen=True, kw_only=True)
class Column:
    """A column that a header names."""

    name: str  # Its name, as the header prints it
    kind: str  # time, sample number, acceleration, component or another
    unit: str  # Its unit, as the header prints it; may be empty
    line: int  # The line that names it

    @property
    def clock(self) -> ClockUnit | None:
        """Unit of a column of times, where the header states it."""
        text = self.unit or self.name.lower().removeprefix("time").removeprefix("t").lstrip("_ ")
        return find_clock_unit(text)


def name_columns(lines: list[Line], count: int) -> list[Column]:
    """Find the names of a number of columns, in the lowest line that has as many; empty where none has."""
    for line in reversed(lines):
        for cells in _split(line.text):
            columns = [column for cell in cells if (column := _column(cell, line.number))]
            if len(columns) == len(cells) == count:
                return _tell_time_from_transverse(columns)
    return []


def _split(text: str) -> Iterator[list[str]]:
    text = _LABEL.sub("", text.strip(' \t#%!/"'))
    yield [cell.strip(' "') for cell in re.split(r"[,;\t]|\s{2,}", text)]
    yield _WORDS.findall(text)


def _column(cell: str, line: int) -> Column | None:
    unit = _UNIT.search(cell)
    name = _UNIT.sub("", cell).strip()
    in_brackets = unit[1].strip() if unit else ""
    if in_brackets == "-":  # nobody says what minus means
        return None
    for kind, pattern in _KIND_PATTERNS.items():
        if pattern.fullmatch(name):
            return Column(name=cell, kind=kind, unit=in_brackets.strip("+"), line=line)
    return None


def _tell_time_from_transverse(columns: list[Column]) -> list[Column]:
    """Take a column T for the transverse component if it is not the first and none is named acceleration."""
    if any(column.kind == "acceleration" for column in columns):
        return columns
    transverse = [column.name.lower() == "t" and place > 0 for place, column in enumerate(columns)]
    return [
        replace(column, kind="component") if is_transverse else column
        for column, is_transverse in zip(columns, transverse, strict=True)
    ]


def arrange(
    source: Source,
    header: Header,
    lines: list[Line],
    offsets: Mapping[str, Statement[float]],
    layout: Layout,
    report: Report,
) -> Iterator[Header]:
    """Find the columns of the samples, and yield a header for each component.

    `offsets`: what stands for no acceleration in a column, by its name.
    """
    first = next((line for line in source.lines(header.start, header.stop) if line.text.strip()), None)
    if first is None:  # the samples end before they begin, as their count will tell
        yield header
        return
    header = replace(header, delimiter=find_delimiter(first))
    count = len(split_line(first, header))
    has_times = _begins_with_times(source, header)
    columns = _columns(lines, count, has_times=has_times)
    for name in offsets.keys() - {column.name for column in columns}:
        report.add(
            "It is unclear to which column this offset belongs",
            line=offsets[name].line,
            value=f"{offsets[name].value:g}",
            remedy="Correct the samples by it, and remove the line",
        )
    if columns or layout.holds_components:
        yield from _components(replace(header, columns=count), columns, offsets, report)
    elif count == 1 or (not has_times and _follows_count(source, header, count)):
        yield replace(header, columns=1 if count == 1 else None)
    elif count == 2:  # noqa: PLR2004 - times and samples
        yield replace(header, columns=2, column=1, time_column=0)
    else:
        report.add(
            "It is unclear what the columns hold",
            line=first.number,
            value=f"{count} columns without names",
            remedy="Name them in a line above, such as # time [s], N-S [gal], E-W [gal]; "
            "or state # samples: N if one series continues from line to line",
        )


def _follows_count(source: Source, header: Header, count: int) -> bool:
    """Tell whether as many samples as the header states follow one another through lines of several."""
    if header.count is None:
        return False
    data = separated(source, header)
    surplus = len(data.split()) - header.count.value
    return 0 <= surplus < count and count_rows(data) != header.count.value


def _columns(lines: list[Line], count: int, *, has_times: bool) -> list[Column]:
    """Find the names of columns; times in the first are recognised although only the others have names."""
    if count == 1:
        return []
    columns = name_columns(lines, count)
    if not has_times or {column.kind for column in columns} & {"time", "sample number"}:
        return columns
    components = name_columns(lines, count - 1)
    return (
        [Column(name="time", kind="time", unit="", line=components[0].line), *components]
        if components
        else []
    )


@np.errstate(over="ignore", invalid="ignore")
def _begins_with_times(source: Source, header: Header) -> bool:
    rows = itertools.islice(source.lines(header.start, header.stop), _ROWS)
    times = [printed_number(tokens[0]) for line in rows if (tokens := split_line(line, header))]
    steps = np.diff([math.nan if time is None else time for time in times])
    return bool(len(steps) > 1 and (steps > 0).all() and np.ptp(steps) <= _ROUNDED * steps.mean())


def _components(
    header: Header, columns: list[Column], offsets: Mapping[str, Statement[float]], report: Report
) -> Iterator[Header]:
    kinds = [column.kind for column in columns] or ["component"] * (header.columns or 0)
    clocks = [place for place, kind in enumerate(kinds) if kind in {"time", "sample number"}]
    samples = [place for place, kind in enumerate(kinds) if kind == "acceleration"] or [
        place for place, kind in enumerate(kinds) if kind == "component"
    ]
    unread = [column.name for place, column in enumerate(columns) if place not in {*clocks, *samples}]
    if not samples:
        report.add(
            "Not a record of acceleration",
            line=columns[0].line,
            value=f"columns {', '.join(column.name for column in columns)}",
            remedy="Use the file of the acceleration, or name its column acceleration",
        )
    for place in samples:
        column = columns[place] if columns else None
        offset = offsets[column.name].value if column and column.name in offsets else 0.0
        clock = columns[clocks[-1]].clock if clocks and columns else None
        applied = [*header.applied, *(f"column {name} left out" for name in unread)]
        yield replace(
            header,
            column=place,
            time_column=clocks[-1] if clocks else None,
            time_unit=clock or header.time_unit,
            units=_units(header, column, report) if column else header.units,
            offset=offset,
            channel=column.name if column else f"column {place + 1}",
            applied=tuple([*applied, f"offset {offset:g} subtracted"] if offset else applied),
        )


def _units(header: Header, column: Column, report: Report) -> Statement[AccelerationUnit] | None:
    """Units of a column, which must not contradict those of the file."""
    unit = find_unit(column.unit)
    if unit is None:
        is_unit = statements.is_another_unit(column.unit)
        return statements.state_units(column.unit, column.line, report) if is_unit else header.units
    if header.units and header.units.value is not unit:
        report.add(
            "Two different units in one file",
            line=column.line,
            value=f"{unit} here and {header.units.value} in line {header.units.line}",
            remedy="Correct whichever is wrong",
        )
    return Statement(value=unit, line=column.line)
