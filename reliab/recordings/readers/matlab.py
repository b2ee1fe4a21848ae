"""MATLAB files of version 4 to 7.2: through SciPy, and where they hold objects of classes through mat-io."""

import struct
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np
import scipy

from reliab.core.errors import InputError
from reliab.recordings.readers.columns import (
    Columns,
    Series,
    date_of,
    is_frame,
    seconds,
    series_of_frame,
    start_of,
)
from reliab.recordings.readers.layouts import Tree, require_shallow, tests_of_tree
from reliab.recordings.recording import require_few_samples
from reliab.simulation.transfer_systems.matlab_structure import require_sound_structure, subsystem_of

if TYPE_CHECKING:
    import pandas as pd


_MOST_ITEMS: Final = 10_000  # of a cell array, a structure array or a vector of texts


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
    return _variables(content)


def _variables(content: Mapping[str, Any]) -> dict[str, Tree]:
    return {name: as_tree(item) for name, item in content.items() if not name.startswith("__")}


def as_tree(item: Any, depth: int = 0) -> Tree:  # noqa: ANN401 - what SciPy or mat-io makes of a variable
    """Take structures as mappings, cells as lists, characters as text, times in seconds."""
    require_shallow(depth)
    if is_frame(item):
        return _convert_table(item)
    if isinstance(item, np.ndarray):
        return _convert_array(item, depth)
    if isinstance(item, Mapping):
        return {str(name): as_tree(value, depth + 1) for name, value in item.items()}
    if isinstance(item, list | tuple):
        return [as_tree(value, depth + 1) for value in item[:_MOST_ITEMS]]
    if isinstance(properties := getattr(item, "properties", None), Mapping):
        content = as_tree(properties, depth)
        return _convert_timeseries(content) if getattr(item, "classname", "") == "timeseries" else content
    is_number = isinstance(item, np.generic) and item.dtype.kind in "iufcb"
    return np.asarray(item) if is_number else item if isinstance(item, str | int | float) else str(item)


def _convert_array(item: np.ndarray, depth: int) -> Tree:
    if "function_handle" in (item.dtype.names or ()):
        return ""  # its workspace may hold whatever stood beside it
    if (item.dtype.names or item.dtype == object) and item.size > _MOST_ITEMS:
        raise InputError(
            f"A cell array has more than {_MOST_ITEMS:,} cells",
            value=f"{item.size:,}",
            remedy="Save the channels as vectors of numbers",
        )
    if item.dtype.names:
        rows = [
            {name: as_tree(row[name], depth + 1) for name in item.dtype.names} for row in item.reshape(-1)
        ]
        return rows[0] if len(rows) == 1 else rows
    if item.dtype == object:
        return [as_tree(value, depth + 1) for value in item.reshape(-1, order="F")]
    if item.dtype.kind in "UST":
        texts = [str(text) for text in item.reshape(-1)[:_MOST_ITEMS]]
        return texts[0] if len(texts) == 1 else texts
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


_SIGNATURE: Final = b"MATLAB 5.0"


def recognises(head: bytes) -> bool:
    """Whether a file begins as one of MATLAB 5 to 7.2."""
    return head.startswith(_SIGNATURE)


def read_matlab(path: Path, _delimiter: str | None = None) -> list[Columns]:
    """Read the tests of a MATLAB file."""
    require_sound_structure(path)
    if subsystem_of(path):
        return tests_of_tree(path, tree_of_objects(path))
    for name, shape, _ in scipy.io.whosmat(path):
        require_few_samples(max(shape, default=0), f"{path.name}, {name}")
    return tests_of_tree(path, _variables(scipy.io.loadmat(path, simplify_cells=True)))


_HEADER: Final = 20  # bytes
_BYTES_OF: Final = (8, 4, 4, 2, 2, 1)  # of a number, by the code of its kind
_LONGEST_NAME: Final = 64
_KINDS: Final = 3  # of matrices: numbers, text, sparse


class _Matrix(NamedTuple):
    """What the header of a matrix states."""

    name_length: int  # with the zero behind it
    rows: int
    columns: int
    size: int  # bytes of its numbers


def recognises_matlab_4(head: bytes) -> bool:
    """Whether a file begins with the header of a matrix and a name."""
    matrix = _matrix(head)
    if matrix is None:
        return False
    name = head[_HEADER : _HEADER + matrix.name_length]
    return name.endswith(b"\x00") and name[:-1].replace(b"_", b"a").isalnum()


def read_matlab_4(path: Path, _delimiter: str | None = None) -> list[Columns]:
    """Read the vectors and matrices of a file, whose sizes are compared with its own before."""
    _require_whole(path)
    return tests_of_tree(path, _variables(scipy.io.loadmat(path, simplify_cells=True)))


def _require_whole(path: Path) -> None:
    """Refuse matrices that reach beyond the end of the file, before memory is taken for them."""
    length, place = path.stat().st_size, 0
    with path.open("rb") as file:
        while place < length:
            file.seek(place)
            matrix = _matrix(file.read(_HEADER))
            if matrix is None:
                raise ValueError(f"no matrix at byte {place}")
            require_few_samples(max(matrix.rows, matrix.columns), path.name)
            place += _HEADER + matrix.name_length + matrix.size
    if place != length:
        raise ValueError("a matrix that reaches beyond the end of the file")


def _matrix(head: bytes) -> _Matrix | None:
    """Read the header of a matrix in either order of bytes; None where it is none."""
    if len(head) < _HEADER:
        return None
    for order, machine in (("<", 0), (">", 1)):
        code, rows, columns, imaginary, name_length = struct.unpack(f"{order}5i", head[:_HEADER])
        thousands, kind = divmod(code, 1000)
        precision, sort = divmod(kind, 10)
        if (
            thousands == machine
            and 0 <= precision < len(_BYTES_OF)
            and sort < _KINDS
            and min(rows, columns) >= 0
            and imaginary in {0, 1}
            and 1 < name_length <= _LONGEST_NAME
        ):
            size = rows * columns * _BYTES_OF[precision] * (1 + imaginary)
            return _Matrix(name_length=name_length, rows=rows, columns=columns, size=size)
    return None
