"""Text files of every layout: a header that states what its numbers mean, and then the numbers.

Plain text and CSV need no layout. Lines before the first number may state, marked with ``#``, ``%``, ``!`` or
``//`` or beginning with a letter::

    # time_step: 0.01        or  dt = 0.01 s,  dt: 10 ms,  sampling rate: 100 Hz
    # units: m/s2            or  time [s], acceleration [m/s2]  or  time_s,acceleration_g
    # samples: 4096          or  npts = 4096
    # scale factor: 0.5      # missing value: -999      # event: KOBE

Numbers stand in one column, in two with times or sample numbers first, in named columns, or one after the
other through the lines where the header states how many there are. They are separated by blanks, tabs, commas
or semicolons. Units that are stated nowhere are not guessed.
"""

import itertools
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np

from reliab.core.text_tables import parse_number
from reliab.core.units import CLOCK_UNIT, AccelerationUnit, ClockUnit, find_clock_unit, find_unit
from reliab.motions.faults import Report
from reliab.motions.readers import statements
from reliab.motions.readers.layouts import PLAIN, Layout
from reliab.motions.readers.source import (
    HEAD,
    RecordHeader,
    RecordLine,
    RecordText,
    Statement,
    clocks_in_seconds,
    count_rows,
    find_delimiter,
    may_round,
    separate_numbers,
    split_line,
)

_FLAGS = re.IGNORECASE
_LABEL = re.compile(r"^[A-Za-z ]*:\s*")
_WORDS = re.compile(r"[^\s;,\[(]+(?:\s*[\[(][^\])]*[\])])?")
_UNIT = re.compile(r"\s*[\[(]([^\])]*)[\])]\s*$")
_ROWS = 20  # lines in which times are looked for
_LARGEST_SPREAD = 0.5  # largest spread of steps between times, as a share of their mean
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
class NamedColumn:
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


def name_columns(lines: list[RecordLine], count: int) -> list[NamedColumn]:
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


def _column(cell: str, line: int) -> NamedColumn | None:
    unit = _UNIT.search(cell)
    name = _UNIT.sub("", cell).strip()
    bracket_text = unit[1].strip() if unit else ""
    if bracket_text == "-":  # nobody says what minus means
        return None
    for kind, pattern in _KIND_PATTERNS.items():
        if pattern.fullmatch(name):
            return NamedColumn(name=cell, kind=kind, unit=bracket_text.strip("+"), line=line)
    return None


def _tell_time_from_transverse(columns: list[NamedColumn]) -> list[NamedColumn]:
    """Take a column T for the transverse component if it is not the first and none is named acceleration."""
    if any(column.kind == "acceleration" for column in columns):
        return columns
    transverse = [column.name.lower() == "t" and place > 0 for place, column in enumerate(columns)]
    return [
        replace(column, kind="component") if is_transverse else column
        for column, is_transverse in zip(columns, transverse, strict=True)
    ]


def arrange(
    source: RecordText,
    header: RecordHeader,
    lines: list[RecordLine],
    offsets: Mapping[str, Statement[float]],
    layout: Layout,
    report: Report,
) -> Iterator[RecordHeader]:
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


def _follows_count(source: RecordText, header: RecordHeader, count: int) -> bool:
    """Tell whether as many samples as the header states follow one another through lines of several."""
    if header.count is None:
        return False
    data = separate_numbers(source, header)
    surplus = len(data.split()) - header.count.value
    return 0 <= surplus < count and count_rows(data) != header.count.value


def _columns(lines: list[RecordLine], count: int, *, has_times: bool) -> list[NamedColumn]:
    """Find the names of columns; times in the first are recognised although only the others have names."""
    if count == 1:
        return []
    columns = name_columns(lines, count)
    if not has_times or {column.kind for column in columns} & {"time", "sample number"}:
        return columns
    components = name_columns(lines, count - 1)
    return (
        [NamedColumn(name="time", kind="time", unit="", line=components[0].line), *components]
        if components
        else []
    )


@np.errstate(over="ignore", invalid="ignore")
def _begins_with_times(source: RecordText, header: RecordHeader) -> bool:
    rows = itertools.islice(source.lines(header.start, header.stop), _ROWS)
    times = [parse_number(tokens[0]) for line in rows if (tokens := split_line(line, header))]
    steps = np.diff([math.nan if time is None else time for time in times])
    return bool(len(steps) > 1 and (steps > 0).all() and np.ptp(steps) <= _LARGEST_SPREAD * steps.mean())


def _components(
    header: RecordHeader, columns: list[NamedColumn], offsets: Mapping[str, Statement[float]], report: Report
) -> Iterator[RecordHeader]:
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
        corrections = [*header.corrections, *(f"column {name} left out" for name in unread)]
        yield replace(
            header,
            column=place,
            time_column=clocks[-1] if clocks else None,
            time_unit=clock or header.time_unit,
            units=_units(header, column, report) if column else header.units,
            offset=offset,
            channel=column.name if column else f"column {place + 1}",
            corrections=tuple([*corrections, f"offset {offset:g} subtracted"] if offset else corrections),
        )


def _units(header: RecordHeader, column: NamedColumn, report: Report) -> Statement[AccelerationUnit] | None:
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


T = TypeVar("T")

_COMMENT = ("#", "%", "!", "//")
_WIDTH = re.compile(r"\(\s*\d*\s*[a-z]\s*(\d{1,2})[^\n)]*\)", re.IGNORECASE)
_CHANNEL = re.compile(
    r"\b(?:chan(?:nel)?\s*\S*?:|comp(?:onent)?\b[:\s])\s*([^(\n]*?)\s*(?:\bfrom)?\s*(?:\(|$)", re.IGNORECASE
)
_DATE = re.compile(r"\d+[/-]\d+[/-]\d+|\d+:\d+")
_WHOLE_NUMBER = re.compile(r"[0-9]{1,9}\.?")
_WORD = re.compile(r"[A-Za-z]{3}")
_ROUNDING_TOLERANCE = 0.1  # largest relative difference between two statements of which one is rounded
_LONGEST = 1e6  # s, eleven days; no accelerogram is as long


def recognises(source: RecordText) -> bool:
    """Tell whether a file has a line of numbers near its top."""
    return any(_is_data(line) for line in source.lines(0, min(HEAD, len(source.content))))


def headers(source: RecordText, report: Report, *, layout: Layout = PLAIN) -> list[RecordHeader]:
    """Read the headers of all records of a text file; empty if there is no line of numbers."""
    records = [
        header
        for begin, start, stop in _records(source, layout)
        for header in _read_record(source, layout, begin, start, stop, report)
    ]
    if not records and not report.faults:
        report.add(
            f"{layout.subject} must {layout.states}",
            line=1,
            value="no line of numbers" if layout is PLAIN else "no such line",
            remedy="Leave the file out, or save its samples as text below # dt: … and # units: …",
        )
    return records


def _records(source: RecordText, layout: Layout) -> Iterator[tuple[int, int, int]]:
    """Where the header of each record begins, and where its samples start and stop [bytes]."""
    if layout.last is not None:
        begin, content_size = 0, len(source.content)
        head_size = content_size if layout.is_announced else min(HEAD, content_size)
        for match in layout.last.finditer(source.content, 0, head_size):
            ending = layout.end.search(source.content, match.end()) if layout.end else None
            stop = ending.start() if ending else content_size
            yield begin, min(match.end() + 1, stop), stop
            begin = stop
            if not layout.is_announced:
                return
        return
    firsts = layout.first.finditer(source.content) if layout.first else ()
    begins = [match.start() for match in firsts] or [0]
    for begin, stop in zip(begins, [*begins[1:], len(source.content)], strict=True):
        start = _first_sample(source, layout, begin, stop)
        if start is not None:
            ending = layout.end.search(source.content, start, stop) if layout.end else None
            yield begin, start, ending.start() if ending else stop


def _first_sample(source: RecordText, layout: Layout, begin: int, stop: int) -> int | None:
    """Where the first line of samples stands, or a line that should be one [bytes]."""
    for line in source.lines(begin, stop):
        text = line.text.strip()
        if not text or text.startswith(_COMMENT):
            continue
        if _is_data(line) or (layout is PLAIN and _begins_with_number(text)):
            return line.start
    return None


def _is_data(line: RecordLine) -> bool:
    """Tell whether every token of a line is a number; NaN and infinity count as numbers."""
    tokens = re.split(r"[\s,;]+", clocks_in_seconds(line.text).strip(" \t\r\f,;"))
    return all(
        parse_number(token) is not None or re.fullmatch(r"[-+]?(nan|inf|infinity)", token, re.IGNORECASE)
        for token in tokens
    )


def _begins_with_number(text: str) -> bool:
    """Tell whether a line begins as a line of samples does, and not as a date or a sentence."""
    return text[0] in "0123456789+-." and not _DATE.match(text) and len(_WORD.findall(text)) < 2  # noqa: PLR2004 - words make a sentence


def _read_record(
    source: RecordText, layout: Layout, begin: int, start: int, stop: int, report: Report
) -> list[RecordHeader]:
    top = list(source.lines(begin, start))
    lines = statements.readable(top)
    statement_lines = lines[-1:] if layout.is_announced else statements.refuse_another_quantity(lines, report)
    header = replace(
        _state(statement_lines, lines, layout, report),
        start=start,
        stop=stop,
        width=_width(top) if layout.is_announced else None,
        missing=statements.missing_marks(lines),
        event=layout.find_event([*top, *lines]),
        channel=_channel(lines),
    )
    header = layout.complete(source, begin, header, report)
    if layout.wraps and (layout.last or header.count):  # other titles stand above plain columns, too
        return [header]
    if header.count is None:
        header = _read_leading_sizes(source, header, report)
    offsets = statements.offsets(statement_lines)
    return list(arrange(source, header, lines, offsets, layout, report))


def _state(
    statement_lines: list[RecordLine], lines: list[RecordLine], layout: Layout, report: Report
) -> RecordHeader:
    """Read what the lines of a header state."""
    scales = list(statements.scales(statement_lines, report))
    factors = [Statement(value=scale.factor, line=scale.line) for scale in scales]
    factor = _agreeing(factors, "scale factors", report)
    peaks = list(statements.peak_units(lines))
    units = [
        *(peaks if layout.is_announced else ()),
        *statements.find_units(statement_lines, report),
        *(Statement(value=scale.units, line=scale.line) for scale in scales if scale.units),
    ]
    corrections = (
        f"scale factor {factor.value:g} of line {factor.line}" if factor and not layout.remove_mean else ""
    )
    header = RecordHeader(
        count=next(statements.counts(statement_lines, report), None),
        time_step=_agreeing(list(statements.time_steps(statement_lines, report)), "time steps", report),
        units=_agreeing(units or peaks[:1], "units", report),
        default_units=layout.default_units,
        scale=factor.value if factor else 1.0,
        remove_mean=layout.remove_mean,
        time_unit=statements.time_unit(statement_lines),
        corrections=(corrections,) if corrections else (),
    )
    return _complete_by_duration(header, lines, report) if layout.has_duration else header


def _agreeing(claims: list[Statement[T]], description: str, report: Report) -> Statement[T] | None:
    """Return the most precise of several statements, and report the one that contradicts the first."""
    for later in claims[1:]:
        if not _agree(*sorted((later, claims[0]), key=_tolerance)):
            report.add(
                f"Two different {description} in one file",
                line=later.line,
                value=f"{later.value} here and {claims[0].value} in line {claims[0].line}",
                remedy="Correct whichever is wrong",
            )
    return min(claims, key=_tolerance, default=None)


def _tolerance(statement: Statement[T]) -> float:
    return statement.tolerance


def _agree(precise: Statement[Any], coarse: Statement[Any]) -> bool:
    if not isinstance(precise.value, float):
        return bool(precise.value == coarse.value)
    is_rounded = precise.tolerance < coarse.tolerance and may_round(precise.value, coarse)
    return math.isclose(precise.value, coarse.value, rel_tol=_ROUNDING_TOLERANCE if is_rounded else 1e-9)


def _complete_by_duration(header: RecordHeader, lines: list[RecordLine], report: Report) -> RecordHeader:
    """Derive the count or the step, whichever is missing, from the duration that a header states."""
    durations = sorted(statements.durations(lines), key=lambda claim: parse_number(claim.value) is None)
    if not durations or (header.count and header.time_step):
        return header
    claim = durations[0]
    duration = parse_number(claim.value) or 0.0
    count = round(duration / header.time_step.value) if header.time_step and duration < _LONGEST else 2
    if not 0 < duration < _LONGEST or count < 2:  # noqa: PLR2004 - two samples make a record
        report.add(
            "The header's duration is not a positive number of seconds",
            line=claim.line,
            value=claim.value or "nothing",
            remedy="Correct the header",
        )
    elif header.time_step:
        return replace(header, count=Statement(value=count, line=claim.line))
    elif header.count:
        steps = [duration / header.count.value, duration / (header.count.value - 1)]
        steps.sort(key=lambda step: abs(1 / step - round(1 / step)) * step)  # rates are whole numbers
        tolerance = abs(steps[1] - steps[0])
        return replace(header, time_step=Statement(value=steps[0], line=claim.line, tolerance=tolerance))
    return header


def _width(top: list[RecordLine]) -> int | None:
    """Columns that each number takes, from a printed format such as ``(8f10.6)``."""
    match = _WIDTH.search(top[-1].text) if top else None
    return int(match[1]) or None if match else None


def _channel(lines: list[RecordLine]) -> str:
    labels = [match[1] for line in lines if (match := _CHANNEL.search(line.text))]
    return labels[-1].strip() if labels else ""


def _read_leading_sizes(source: RecordText, header: RecordHeader, report: Report) -> RecordHeader:
    """Take lines of count and step before the samples from them: ``3000`` and ``0.01``, or ``3000 0.01``."""
    lines = list(itertools.islice(source.lines(header.start, header.stop), 3))
    tokens = [split_line(line, replace(header, delimiter=find_delimiter(line))) for line in lines]
    if len(lines) < 3:  # noqa: PLR2004 - two lines of sizes and one of samples
        return header
    for last, sizes in ((lines[1], tokens[0] + tokens[1]), (lines[0], tokens[0])):
        counts = [int(text.rstrip(".")) for text in sizes if _WHOLE_NUMBER.fullmatch(text)]
        steps = [
            value for text in sizes if not _WHOLE_NUMBER.fullmatch(text) and (value := parse_number(text))
        ]
        is_count = len(counts) == 1 and len(sizes) == 1 + len(steps) <= 2  # noqa: PLR2004 - count and step
        if is_count and counts[0] > 1 and _holds(source, last.stop, header, counts[0]):
            step = [Statement(value=step, line=last.number) for step in steps]
            known_steps = [header.time_step] if header.time_step else []
            return replace(
                header,
                start=last.stop,
                count=Statement(value=counts[0], line=lines[0].number),
                time_step=_agreeing([*known_steps, *step], "time steps", report),
            )
    if (
        len(tokens[0]) == 1
        and tokens[0][0].isdecimal()
        and all("." in text for text in tokens[1] + tokens[2])
    ):
        count = Statement(value=int(tokens[0][0]), line=lines[0].number)
        return replace(header, start=lines[0].stop, count=count)
    return header


def _holds(source: RecordText, start: int, header: RecordHeader, count: int) -> bool:
    """Tell whether as many numbers follow, or as many lines of them."""
    data = separate_numbers(source, replace(header, start=start))
    numbers, rows = len(data.split()), count_rows(data)
    return count in {numbers, rows} or 0 <= numbers - count < numbers / rows
