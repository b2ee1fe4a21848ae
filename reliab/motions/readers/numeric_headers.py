"""Lines of integers and of reals that some layouts print between the text of a header and the samples."""

import itertools
import math
import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from reliab.core.text_tables import printed_number
from reliab.motions.faults import Report
from reliab.motions.readers.header import Header, Statement
from reliab.motions.readers.samples import split_line
from reliab.motions.readers.source import Line, Source
from reliab.motions.readers.statements import state_time_step
from reliab.motions.units import ClockUnit

_LINES_OF_REALS = {4: 6, 5: 7, 7: 7}  # after as many lines of integers: GeoNet, USC, CSMIP and those like it
_LONGEST = 15  # lines of both, and one of samples
_PAIRS, _FEWEST_PAIRS = 50, 5  # pairs whose times must increase
_INTEGERS = re.compile(r"[\s\d+-]*\d[\s\d+-]*")


def leave_as_it_is(source: Source, begin: int, header: Header, report: Report) -> Header:  # noqa: ARG001 - as the others
    """Read nothing: the layout has no such lines."""
    return header


def read_volume(source: Source, begin: int, header: Header, report: Report) -> Header:  # noqa: ARG001
    """Leave out the numeric header; find times before the samples, and velocity after them."""
    header = _skip(source, header)
    if header.count is None:
        return header
    stops = [line.stop for line in source.lines(header.start, header.stop)]
    tokens = [split_line(line, header) for line in source.lines(header.start, header.stop)]
    values = [printed_number(token) for line in tokens[:_PAIRS] for token in line]
    times = [math.nan if time is None else time for time in values[: 2 * _PAIRS : 2]]
    is_paired = len(times) >= _FEWEST_PAIRS and bool((np.diff(times) > 0).all())
    numbers = np.cumsum([len(line) for line in tokens])
    expected = header.count.value * (2 if is_paired else 1)
    if numbers.size and numbers[-1] >= 2 * expected:  # velocity and displacement follow
        header = replace(header, stop=stops[int(np.searchsorted(numbers, expected))])
    if not is_paired:
        return header
    return replace(header, columns=2, column=1, time_column=0, has_rows=False)


def _skip(source: Source, header: Header) -> Header:
    """Leave out lines of integers and of reals; a file that ends within them has no samples."""
    lines = list(itertools.islice(source.lines(header.start, header.stop), _LONGEST))
    integers = len(list(itertools.takewhile(lambda line: _INTEGERS.fullmatch(line.text), lines)))
    if integers not in _LINES_OF_REALS:
        return replace(header, start=header.stop) if integers == len(lines) < _LONGEST else header
    size = integers + _LINES_OF_REALS[integers]
    return replace(header, start=lines[size - 1].stop if size < len(lines) else header.stop)


_COSMOS_REALS = re.compile(
    rb"^[ \t]*(\d{1,6})[ \t]+Real-header[^\n]*?\(\s*\d*\s*[A-Z]\s*(\d{1,2})[^\n]*$",
    re.IGNORECASE | re.MULTILINE,
)
_STEP_POSITION = 62  # counted from 1, as in the specification; value 34 is the step before processing
_UNKNOWN = -999.0  # marks an unknown value where the text header names no other mark
_MILLISECOND = ClockUnit(size=1e-3)


def read_cosmos(source: Source, begin: int, header: Header, report: Report) -> Header:
    """Read the step, value 62 of the real header; it stays open where the header marks it as unknown."""
    missing = header.missing or (_UNKNOWN,)
    matches = list(_COSMOS_REALS.finditer(source.content, begin, header.start))
    if not matches or int(matches[-1][1]) < _STEP_POSITION or int(matches[-1][2]) == 0:
        report.add(
            "The time step, value 62 of the COSMOS real header, is missing",
            line=source.line_number(begin),
            remedy="Export or download the file again",
        )
        return replace(header, missing=missing)
    fields: list[str] = []
    for line in source.lines(matches[-1].end() + 1, header.start):
        fields.extend(_fields(line, int(matches[-1][2])))
        if len(fields) >= _STEP_POSITION:
            text = fields[_STEP_POSITION - 1]
            is_open = printed_number(text) in missing
            step = None if is_open else state_time_step(text, line.number, report, unit=_MILLISECOND)
            return replace(header, missing=missing, time_step=step)
    state_time_step("", source.line_number(header.start), report, unit=_MILLISECOND)
    return replace(header, missing=missing)


_SMC_INTEGERS, _SMC_REALS = 6, 10  # lines
_SMC_COMMENTS, _SMC_COUNT, _SMC_RATE = 16, 17, 2  # positions, counted from 1 as in the specification
_FASTEST = 1e5  # Hz; a file of times and samples marks its rate as unknown by 1.7e38


def read_smc(source: Source, begin: int, header: Header, report: Report) -> Header:
    """Read count and rate, and leave out the comments before the samples."""
    lines = list(source.lines(header.start, header.stop))
    integers = [field for line in lines[:_SMC_INTEGERS] for field in _fields(line, 10)]
    reals = [field for line in lines[_SMC_INTEGERS:][:_SMC_REALS] for field in _fields(line, 15)]
    values = [
        printed_number(field) for field in (*integers[_SMC_COMMENTS - 1 : _SMC_COUNT], *reals[:_SMC_RATE])
    ]
    if len(values) < 2 + _SMC_RATE or None in values or not 0 <= (values[0] or 0) < len(lines):
        report.add(
            "The SMC header is incomplete: it has six lines of integers and ten of reals",
            line=source.line_number(begin),
            remedy="Download the file again, or save its samples as text below # dt: … and # units: …",
        )
        return header
    comments, count, _, rate = (value or 0.0 for value in values)
    start = lines[min(_SMC_INTEGERS + _SMC_REALS + int(comments), len(lines)) - 1].stop
    header = replace(header, start=start, width=10)
    if not 0 < rate < _FASTEST:
        return replace(header, columns=2, column=1, time_column=0, has_rows=False)
    line = lines[_SMC_INTEGERS].number
    return replace(
        header,
        count=Statement(value=int(count), line=lines[2].number) if count > 1 else None,
        time_step=Statement(value=1.0 / rate, line=line),
    )


Complete = Callable[[Source, int, Header, Report], Header]


def _fields(line: Line, width: int) -> list[str]:
    text = line.text.rstrip()
    return [text[start : start + width].strip() for start in range(0, len(text), width)]
