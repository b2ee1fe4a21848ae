"""Tables of a file that go on one another, as those of a logger that repeats its header, are one test."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from reliab.recordings.naming import describe
from reliab.recordings.readers.columns import Columns, Series, seconds_between
from reliab.recordings.words import Quantity

_HALF: Final = 0.5


def join_tables(tables: Sequence[Columns]) -> list[Columns]:
    """Join tables in which all channels go on one step after the last time of each; number what remains."""
    joined = [tables[0]]
    for table in tables[1:]:
        if _goes_on(joined[-1], table):
            joined[-1] = _append(joined[-1], table)
        else:
            joined.append(table)
    return joined if len(joined) == 1 else [replace(table, test=str(k)) for k, table in enumerate(joined, 1)]


def _goes_on(before: Columns, after: Columns) -> bool:
    if list(before.series) != list(after.series) or before.units != after.units:
        return False
    described = describe(list(before.series), before.units)
    time = next((name for name, what in described.items() if what.quantity is Quantity.TIME), None)
    for name, held in before.series.items():
        times, further = (
            each.values[time] if time and series.times is None else series.times
            for each, series in ((before, held), (after, after.series[name]))
        )
        if times is None or further is None or times.size < 2:  # noqa: PLR2004 - a step
            return False
        step = float(np.median(np.diff(times)))
        gap = float(further[0] - times[-1]) + _lateness(held, after.series[name]) - step
        if not abs(gap) < _HALF * abs(step):
            return False
    return True


def _append(before: Columns, after: Columns) -> Columns:
    series = {}
    for name, held in before.series.items():
        further = after.series[name]
        series[name] = replace(held, values=np.concatenate([held.values, further.values]))
        if held.times is not None and further.times is not None:
            later = further.times + _lateness(held, further)
            series[name] = replace(series[name], times=np.concatenate([held.times, later]))
    lines = [part.lines for part in (before, after) if part.lines is not None]
    return replace(before, series=series, lines=np.concatenate(lines))


def _lateness(held: Series, further: Series) -> float:
    """Time by which the clock of a series begins after that of another [s]."""
    if held.start is None or further.start is None:
        return 0.0 if held.start is further.start else np.inf
    return seconds_between(held.start, further.start)
