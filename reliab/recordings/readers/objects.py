"""Objects of MATLAB's classes (`timetable`, `timeseries`, `table`), of any version, through mat-io."""

import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from reliab.core.errors import InputError
from reliab.recordings.readers.columns import Series, date_of, is_frame, seconds, series_of_frame, start_of
from reliab.recordings.readers.layouts import Tree
from reliab.recordings.recording import require_few_samples

if TYPE_CHECKING:
    import pandas as pd

_DEEPEST: Final = 16
_MOST_ITEMS: Final = 10_000


def tree_of_objects(path: Path) -> dict[str, Tree]:
    """Read a file with all its objects; its structure has been checked before."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of time zones and formats of dates, which no channel has
        try:
            import matio
        except ModuleNotFoundError:
            raise InputError(
                "A timetable, timeseries or table needs the library mat-io, which is not installed",
                remedy='Install it with pip install "mat-io>=1.0" (Python 3.14 needs a compiler for it), or '
                "save the channels as vectors",
                where=path.name,
            ) from None
        content = matio.load_from_mat(str(path), raw_data=False, add_table_attrs=True)
    return {name: _as_tree(item) for name, item in content.items() if not name.startswith("__")}


def _as_tree(item: Any, depth: int = 0) -> Tree:  # noqa: ANN401 - what mat-io makes of a variable
    if depth > _DEEPEST:
        raise InputError(
            f"Structures are nested more than {_DEEPEST} deep",
            remedy="Save the channels as vectors",
        )
    if is_frame(item):
        return _convert_table(item)
    if isinstance(item, np.ndarray):
        return _convert_array(item, depth)
    if isinstance(properties := getattr(item, "properties", None), Mapping):
        content = {str(name): _as_tree(value, depth + 1) for name, value in properties.items()}
        return _convert_timeseries(content) if getattr(item, "classname", "") == "timeseries" else content
    return item if isinstance(item, str | int | float) else str(item)


def _convert_array(item: np.ndarray, depth: int) -> Tree:
    """Take structures as mappings, cells as lists, characters as text, times in seconds."""
    if "function_handle" in (item.dtype.names or ()):
        return ""  # its workspace may hold whatever stood beside it
    if item.dtype.names:
        rows = [
            {name: _as_tree(row[name], depth + 1) for name in item.dtype.names}
            for row in item.reshape(-1)[:_MOST_ITEMS]
        ]
        return rows[0] if len(rows) == 1 else rows
    if item.dtype == object:
        return [_as_tree(value, depth + 1) for value in item.reshape(-1, order="F")[:_MOST_ITEMS]]
    if item.dtype.kind in "UST":
        return (
            str(item.reshape(-1)[0])
            if item.size == 1
            else [str(text) for text in item.reshape(-1)[:_MOST_ITEMS]]
        )
    if item.dtype.kind not in "mM" or _is_calendar(item):
        return item
    instants = item.reshape(-1)
    values = seconds(instants)
    return Series(values=values, unit="s", start=start_of(instants)) if values.size > 1 else values


def _convert_timeseries(properties: Mapping[str, Tree]) -> dict[str, Tree]:
    """Time, data, name and unit of a `timeseries`, under the names with which MATLAB saves them.

    It keeps the data as `Data_`, and equal steps as `Start_`, `Increment_` and `Length` of the object
    `TimeInfo` with no vector of times at all.
    """
    about = _property_value(properties, "TimeInfo") or {}
    data = _property_value(properties, "Data")
    times = _property_value(properties, "Time")
    if times is None:
        times = _property_value(about, "Time")
    if times is None:
        times = _equal_steps(about)
    times = times.values if isinstance(times, Series) else times
    unit = str(_property_value(about, "Units") or "s")
    return {
        "Time": None
        if times is None
        else Series(values=np.ravel(times).astype(np.float64), unit=unit, start=_start_date(about)),
        "Data": data,
        "Name": _property_value(properties, "Name") or "",
        "DataInfo": {"Units": _property_value(_property_value(properties, "DataInfo") or {}, "Units") or ""},
    }


def _start_date(about: Mapping[str, Tree]) -> np.datetime64 | None:
    """Read the date from which a `timeseries` counts its times; None where it states none."""
    text = _property_value(about, "StartDate")
    if not isinstance(text, str) or not text:
        return None
    if (start := date_of(text)) is None:
        raise InputError(
            "The start of the timeseries is no date",
            value=repr(text),
            remedy="Set TimeInfo.StartDate to one, such as 2026-05-05 10:00:00, or to ''",
        )
    return start


def _property_value(properties: Mapping[str, Tree], name: str) -> Tree:
    """Value of a property under its own name or the one it is saved with; None where neither holds any."""
    values = (properties.get(key) for key in (name, f"{name}_")) if isinstance(properties, Mapping) else ()
    return next((value for value in values if value is not None and np.size(value) > 0), None)


def _equal_steps(about: Mapping[str, Tree]) -> np.ndarray | None:
    start, step, count = (_property_value(about, name) for name in ("Start", "Increment", "Length"))
    if step is None or count is None or not 0.0 < float(np.ravel(step)[0]) < np.inf:
        return None
    size = int(np.ravel(count)[0])
    require_few_samples(size, "timeseries")
    first = 0.0 if start is None else float(np.ravel(start)[0])
    return first + float(np.ravel(step)[0]) * np.arange(size)


def _convert_table(frame: "pd.DataFrame") -> dict[str, Series]:
    """Columns of a table; those of a timetable have its row times."""
    units = frame.attrs.get("varUnits") or frame.attrs.get("VariableUnits") or []
    return series_of_frame(frame, dict(zip(map(str, frame.columns), map(str, units), strict=False)))


def _is_calendar(times: np.ndarray) -> bool:
    """Whether durations are counted in months or years, which have no length in seconds."""
    return times.dtype.kind == "m" and np.datetime_data(times.dtype)[0] in {"Y", "M"}
