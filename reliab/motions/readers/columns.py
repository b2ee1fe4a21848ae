"""Text in columns: samples alone, or times and samples; the times give the step."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from reliab.motions.faults import Report
from reliab.motions.readers.header import Header, Statement, last_place, may_round
from reliab.motions.readers.samples import line_of_sample, separated, split_line
from reliab.motions.readers.source import Source

TWO_COLUMNS = 2
"""Numbers in a line that holds a time and a sample."""

_JITTER = 0.01  # largest error of a time, as a share of the step
_DIGITS = 12  # significant digits to which a step is known from times in double precision


def check_columns(source: Source, header: Header, report: Report) -> bool:
    """Tell whether every line has the columns that the header expects; report the first that has not."""
    data = separated(source, header)
    if header.columns is None or len(data.split()) == header.columns * _filled_lines(data):
        return True
    for line in source.lines(header.start, header.stop):
        tokens = split_line(line, header)
        if tokens and len(tokens) != header.columns:
            report.add(
                "Every line must have as many columns as the first",
                line=line.number,
                value=f"{len(tokens)} instead of {header.columns}",
                remedy="Correct the line",
            )
            break
    return False


def _filled_lines(data: bytes) -> int:
    return sum(1 for line in data.split(b"\n") if line.strip())


def split_times(
    source: Source, header: Header, values: NDArray[np.float64], report: Report
) -> tuple[NDArray[np.float64] | None, Header]:
    """Separate times from samples and find the step.

    Times may differ from equal steps by their rounding or by 1 % of the step; any start time is allowed.

    `values` (2 n,); returns samples (n,).
    """
    times, samples = values[0::2], values[1::2]
    if times.size < 2:  # noqa: PLR2004 - a step needs two times
        return samples, header
    place = _rounding(source, header)
    step = float(f"{(times[-1] - times[0]) / (times.size - 1):.{_DIGITS}g}")
    faulty = _first_unequal(times, step, place)
    if faulty is not None:
        report.add(
            "The times of a record must increase by equal steps",
            line=line_of_sample(source, header, faulty),
            value=f"{times[faulty]:.12g} s after {times[faulty - 1]:.12g} s",
            remedy="Interpolate the record at equal steps; columns must be time and acceleration",
        )
        return None, header
    return samples, _with_step(source, header, step, place / (times.size - 1), report)


def _first_unequal(times: NDArray[np.float64], step: float, place: float) -> int | None:
    """Index of the first time that does not follow the previous one by one step."""
    backwards = np.flatnonzero(np.diff(times) <= 0)
    if backwards.size:
        return int(backwards[0]) + 1
    if not np.isfinite(step):
        return 1
    off = np.abs(times - times[0] - step * np.arange(times.size)) > max(place, _JITTER * step)
    if not off.any():
        return None
    steps = np.diff(times)
    return int(np.abs(steps - np.median(steps)).argmax()) + 1


def _rounding(source: Source, header: Header) -> float:
    """One unit in the last printed place of the times."""
    tokens = separated(source, header).split()[0::2]
    last = tokens[-1].decode("latin-1")
    if "E" in last.upper():
        return last_place(last)
    return min(10.0 ** -len(token.partition(b".")[2]) for token in tokens)


def _with_step(source: Source, header: Header, step: float, tolerance: float, report: Report) -> Header:
    line = source.line_number(header.start)
    stated = header.time_step
    if stated is None:
        return replace(header, time_step=Statement(value=step, line=line, tolerance=tolerance))
    if not may_round(step, stated):
        report.add(
            "The time step in the header must be the one between the times",
            line=stated.line,
            value=f"{stated.value:g} s in the header, {step:g} s between the times",
            remedy="Correct the header",
        )
    return header
