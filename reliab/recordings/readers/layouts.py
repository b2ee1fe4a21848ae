"""Layouts in which programs lay a test into a tree of structures and arrays: one for MATLAB and HDF5 alike.

A tree is a mapping (structure, group), a list (structure array, cell array), an array, a text or a
:class:`Series`. Known layouts: dSPACE ControlDesk (`X`, `Y(k).Name`, `Y(k).Data`, `Capture`), Simulink
"structure with time" and "structure" (`time`, `signals(k).values`, `label`), Simulink Real-Time and xPC
(`data(k).values`), `timeseries`, one matrix with the names of its columns beside it, and plain vectors.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from reliab.core.errors import InputError
from reliab.recordings.naming import describe
from reliab.recordings.readers.columns import Columns, Series, add_clock, apply_attributes, series_of
from reliab.recordings.recording import require_few_samples
from reliab.recordings.words import Measurand

MOST_COLUMNS: Final = 1000
_WIDEST: Final = 64  # columns of a matrix
_FEWEST_SAMPLES: Final = 16  # of a vector that is a history rather than a list of settings
_MATRIX: Final = 2
_DEEPEST_NAME: Final = 4
_DEEPEST: Final = 16
_GENERIC: Final = re.compile(
    r"^(?:out|in|value|values|data|signal|output|input|port)?\s*[\[(]?\d*[\])]?$", re.IGNORECASE
)

Tree = Any
"""A mapping, a list, an array, a text or a `Series`."""


@dataclass(kw_only=True)
class _Histories:
    """Histories of one test, by name."""

    series: dict[str, Series] = field(default_factory=dict)
    scalars: dict[str, float] = field(default_factory=dict)
    named: bool = True

    def add(self, name: str, series: Series) -> None:
        if len(self.series) >= MOST_COLUMNS:
            raise InputError(
                f"The file holds more than {MOST_COLUMNS} channels",
                remedy="Export only those of the test",
            )
        free, count = name, 1
        while free in self.series:
            count += 1
            free = f"{name} ({count})"
        self.series[free] = series


def require_shallow(depth: int, location: str = "") -> None:
    """Refuse structures within structures to no end."""
    if depth > _DEEPEST:
        raise InputError(
            f"Structures are nested more than {_DEEPEST} deep",
            remedy="Save the channels as vectors",
            where=location,
        )


def tests_of_tree(path: Path, tree: Mapping[str, Tree]) -> list[Columns]:
    """Find the tests in what a file holds."""
    captures = _join_captures(list(_captures(tree, ""))) or [("", _plain(tree))]
    scalars = {name: value for name, value in _scalars(tree, "") if "." not in name}
    for _, histories in captures:
        histories.scalars = {**scalars, **histories.scalars}
    tests = [
        _columns(path, name if len(captures) > 1 else "", histories)
        for name, histories in captures
        if histories.series
    ]
    if not tests:
        raise InputError(
            "No vectors of numbers in the file",
            value=", ".join(map(str, tree)) or "nothing",
            remedy="Save command and measured displacement as vectors",
            where=path.name,
        )
    return tests


def _join_captures(captures: list[tuple[str, _Histories]]) -> list[tuple[str, _Histories]]:
    """Take captures of a single history each as the channels of one test, named after their structures."""
    if len(captures) < 2 or any(len(histories.series) > 1 for _, histories in captures):  # noqa: PLR2004
        return captures
    joint_histories = _Histories()
    for name, histories in captures:
        ((label, series),) = histories.series.items()
        joint_histories.add(label if histories.named and label else name, series)
        joint_histories.scalars.update(histories.scalars)
    return [("", joint_histories)]


def _captures(tree: Tree, name: str) -> Iterator[tuple[str, _Histories]]:
    """Find tests of a layout that is known, each with the name of its structure."""
    if isinstance(tree, list):
        for place, item in enumerate(tree, start=1):
            yield from _captures(item, f"{name}({place})")
        return
    if not isinstance(tree, Mapping):
        return
    for layout in (_dspace, _simulink, _timeseries, _values, _matrix_with_names):
        if (histories := layout(tree)) is not None and histories.series:
            yield name, histories
            return
    inner = [(key, list(_captures(item, f"{name}.{key}".lstrip(".")))) for key, item in tree.items()]
    yield from (capture for _, captures in inner for capture in captures)
    if not any(captures for _, captures in inner):
        yield from _sibling_groups(tree, name)


def _sibling_groups(tree: Mapping[str, Tree], name: str) -> Iterator[tuple[str, _Histories]]:
    """Take groups that hold histories of the same names: each is a test."""
    groups = {key: item for key, item in tree.items() if isinstance(item, Mapping)}
    names_of_group = {
        key: frozenset(name for name, value in item.items() if _vector(value) is not None)
        for key, item in groups.items()
    }
    repeated_groups = [
        key
        for key, names in names_of_group.items()
        if len(names) > 1 and list(names_of_group.values()).count(names) > 1
    ]
    if len(repeated_groups) > 1:
        for key in repeated_groups:
            histories = _plain(groups[key])
            histories.scalars.update({k: v for k, v in _plain(tree).scalars.items() if "." not in k})
            yield f"{name}.{key}".lstrip("."), histories


def _dspace(tree: Mapping[str, Tree]) -> _Histories | None:
    """ControlDesk: abscissae `X`, channels `Y` with `Name` and `Data`, and the capture's sampling period."""
    channels = [item for item in _as_list(tree.get("Y")) if isinstance(item, Mapping) and "Data" in item]
    if not channels:
        return None
    histories = _Histories()
    axes = [item for item in _as_list(tree.get("X")) if isinstance(item, Mapping)]
    clocks = [_history(item.get("Data"), item) for item in axes]
    capture = tree.get("Capture")
    names = short_names([_text(channel.get("Name")) or _text(channel.get("Path")) for channel in channels])
    for name, channel in zip(names, channels, strict=True):
        series = _history(channel["Data"], channel)
        if series is None:
            continue
        index = _number(channel.get("XIndex"))
        channel_clock = clocks[int(index) - 1] if index is not None and 1 <= index <= len(clocks) else None
        histories.add(name, _add_first_clock(series, channel_clock, *clocks))
    step = _number(capture.get("SamplingPeriod")) if isinstance(capture, Mapping) else None
    if step is not None:
        downsampling = _number(capture.get("Downsampling")) if isinstance(capture, Mapping) else None
        histories.scalars["dt"] = step * (downsampling if downsampling and downsampling >= 1.0 else 1.0)
    return histories


def _simulink(tree: Mapping[str, Tree]) -> _Histories | None:
    """Take what Simulink logged as a structure, with or without time."""
    signals = [
        item for item in _as_list(tree.get("signals")) if isinstance(item, Mapping) and "values" in item
    ]
    return _signal_histories(signals, tree.get("time")) if signals else None


def _values(tree: Mapping[str, Tree]) -> _Histories | None:
    """Simulink Real-Time and xPC: structures with `values`, of which none needs a name."""
    if "values" in tree and "signals" not in tree:
        return _signal_histories([tree], tree.get("time", tree.get("t")))
    lists = {name: _as_list(item) for name, item in tree.items() if _are_values(_as_list(item))}
    time = tree.get("time", tree.get("t", tree.get("tout")))
    if len(lists) == 1:
        ((name, signals),) = lists.items()
        return _signal_histories(signals, time, name)
    if time is None or any(
        len(items) != 1 or _vector(items[0]["values"]) is None for items in lists.values()
    ):
        return None
    return _signal_histories(
        [{**items[0], "label": _text(items[0].get("label")) or name} for name, items in lists.items()], time
    )


def _are_values(items: Sequence[Tree]) -> bool:
    return bool(items) and all(isinstance(item, Mapping) and "values" in item for item in items)


def _signal_histories(signals: Sequence[Mapping[str, Tree]], time: Tree, outer: str = "values") -> _Histories:
    histories = _Histories(named=False)
    shared = _history(time)
    for place, signal in enumerate(signals, start=1):
        label = (
            _text(signal.get("label"))
            or _text(signal.get("title"))
            or _text(signal.get("blockName"))
            or _text(signal.get("name"))
        )
        signal_clock = _history(signal.get("time"))
        columns = _columns_of(signal["values"])
        labels = [part.strip() for part in re.split(r"[,;\n]", label)]
        histories.named = histories.named or bool(label)
        for k, values in enumerate(columns):
            name = (
                labels[k]
                if len(labels) == len(columns) and labels[k]
                else short_names([label])[0] or f"{outer}({place})"
            )
            has_components = len(columns) > 1 and len(labels) != len(columns)
            series = _add_first_clock(_apply_attributes(values, signal), signal_clock, shared)
            histories.add(f"{name}[{k + 1}]" if has_components else name, series)
    return histories


def _timeseries(tree: Mapping[str, Tree]) -> _Histories | None:
    """Take one or several `timeseries`, or structures of `Time` and `Data` in their place."""
    members = {
        name: item for name, item in tree.items() if isinstance(item, Mapping) and _is_timeseries(item)
    }
    if _is_timeseries(tree):
        members = {_text(tree.get("Name")) or "data": tree}
    if not members:
        return None
    histories = _Histories()
    for name, item in members.items():
        columns, clock = _columns_of(_value_of(item, "data")), _history(_value_of(item, "time"))
        unit = _unit_of_series(item)
        label = _text(item.get("Name"))
        for k, values in enumerate(columns):
            series = _add_first_clock(Series(values=values, unit=unit), clock)
            outer = (
                _text(_value_of(tree, "name")) if name.lower() == "values" else ""
            )  # a signal's, in a data set
            plain = outer or (label if label and label != "unnamed" else name)
            histories.add(f"{plain}[{k + 1}]" if len(columns) > 1 else plain, series)
    return histories


def _is_timeseries(item: Mapping[str, Tree]) -> bool:
    times, data = _vector(_value_of(item, "time")), _value_of(item, "data")
    return (
        times is not None
        and times.size >= _FEWEST_SAMPLES
        and any(column.size == times.size for column in _columns_of(data))
        and not any(
            _vector(value) is not None for key, value in item.items() if key.lower() not in {"time", "data"}
        )
    )


def _value_of(item: Mapping[str, Tree], wanted_name: str) -> Tree:
    return next((value for key, value in item.items() if key.lower() == wanted_name), None)


def _unit_of_series(item: Mapping[str, Tree]) -> str:
    about = item.get("DataInfo", item.get("DataUnits"))
    if isinstance(about, Mapping):
        about = about.get("Units", about.get("Unit_", ""))
    return _text(about)


def _matrix_with_names(tree: Mapping[str, Tree]) -> _Histories | None:
    """One matrix, with a list of as many names as it has columns, and perhaps another one of units."""
    matrices = {
        key: item
        for key, item in tree.items()
        if isinstance(item, np.ndarray | Series) and len(_columns_of(item)) > 1
    }
    texts = {key: names for key, item in tree.items() if (names := _names(item))}
    for matrix in matrices.values():
        columns = _columns_of(matrix)
        lists = {key: names for key, names in texts.items() if len(names) == len(columns)}
        if not lists:
            continue
        units = next(
            (names for key, names in lists.items() if "unit" in key.lower() or "einheit" in key.lower()), None
        )
        name_lists = [names for names in lists.values() if names is not units]
        if not name_lists:
            continue
        histories = _Histories(scalars=dict(_scalars(tree, "")))
        series = matrix if isinstance(matrix, Series) else Series(values=matrix)
        for place, (name, values) in enumerate(zip(name_lists[0], columns, strict=True)):
            unit = units[place] if units else ""
            histories.add(name or f"column {place + 1}", replace(series, values=values, unit=unit))
        for key, item in tree.items():
            clock = _vector(item)  # such as Simulink's `tout`
            if clock is not None and clock.size == columns[0].size:
                histories.add(key, Series(values=clock))
        return histories
    return None


def _plain(tree: Mapping[str, Tree]) -> _Histories:
    """Vectors, columns of matrices and single numbers wherever they stand."""
    vectors = list(_vectors(tree, ""))
    groups = [name.rpartition(".")[0] for name, *_ in vectors]
    histories = _Histories(
        scalars={
            name: value
            for name, value in _scalars(tree, "")
            if not name.lower().endswith(".scale") or groups.count(name.rpartition(".")[0]) != 1
        }
    )
    clocks = _clocks_of(vectors)
    matrices_only = True
    for name, series, is_column in vectors:
        matrices_only = matrices_only and is_column
        group_clock = clocks.get((name.rpartition(".")[0], series.values.size))
        clock = clocks.get((series.axis, 0), group_clock)
        histories.add(
            name, _add_first_clock(series, clock) if series.times is None and series.axis != name else series
        )
    histories.named = len(vectors) > 1 and not matrices_only
    return histories


def _clocks_of(vectors: Sequence[tuple[str, Series, bool]]) -> dict[tuple[str, int], Series]:
    """Return times by their own names, with a zero, and by group and length, where channels have several."""
    times: dict[str, Series] = {}
    for name, series, _ in vectors:
        if _is_time(name, series):
            unit = describe([name], {name: series.unit})[name].unit
            times[name] = replace(series, unit=unit.text if unit else "")
    group_clocks: dict[tuple[str, int], Series] = {}
    for name, series in times.items():
        group_clocks.setdefault((name.rpartition(".")[0], series.values.size), series)
    axes = {series.axis for name, series, _ in vectors if series.axis in times and name not in times}
    if max(len(group_clocks), len(axes)) < 2:  # noqa: PLR2004 - one clock is that of all
        return {}
    return {**group_clocks, **{(name, 0): series for name, series in times.items()}}


def _is_time(name: str, series: Series) -> bool:
    return describe([name], {name: series.unit})[name].quantity is Measurand.TIME


def _vectors(tree: Tree, name: str) -> Iterator[tuple[str, Series, bool]]:
    """Find vectors and columns of matrices, with their names and whether they are of a matrix.

    Numbers beside the only vector of a structure are attributes of it; a step and a date are of all in it.
    """
    if isinstance(tree, Mapping):
        inner = [(key, list(_vectors(item, f"{name}.{key}".lstrip(".")))) for key, item in tree.items()]
        vectors = [vector for _, inner_vectors in inner for vector in inner_vectors]
        attributes = _attributes_of(tree)
        has_times = any(_is_time(label, series) for label, series, _ in vectors)
        for label, series, is_column in vectors:
            if not name or label.rpartition(".")[0] != name:
                yield label, series, is_column
            elif len(vectors) == 1:
                yield label, apply_attributes(series, attributes), is_column
            else:
                yield label, add_clock(series, attributes, has_times=has_times), is_column
    elif isinstance(tree, list):
        for place, item in enumerate(tree, start=1):
            yield from _vectors(item, f"{name}({place})")
    else:
        columns = _columns_of(tree)
        for k, values in enumerate(columns):
            label, is_column = f"{name}[{k + 1}]" if len(columns) > 1 else name, len(columns) > 1
            yield (
                label,
                replace(tree, values=values) if isinstance(tree, Series) else Series(values=values),
                is_column,
            )


def _history(tree: Tree, about: Mapping[str, Tree] | None = None) -> Series | None:
    """Take one history with what stands beside it; None where there is none, or several."""
    columns = _columns_of(tree)
    if len(columns) != 1:
        return None
    return tree if isinstance(tree, Series) else _apply_attributes(columns[0], about or {})


def _apply_attributes(values: NDArray[np.float64], about: Mapping[str, Tree]) -> Series:
    """Apply the numbers and the unit that a structure states beside a history."""
    return series_of(values, _attributes_of(about))


def _attributes_of(tree: Mapping[str, Tree]) -> dict[str, str | float]:
    """Texts and single numbers of a structure."""
    single = {name: item if isinstance(item, str) else _number(item) for name, item in tree.items()}
    return {name: item for name, item in single.items() if item is not None}


def _add_first_clock(series: Series, *clocks: Series | None) -> Series:
    """Give a history the first clock of its length."""
    for clock in clocks:
        if clock is not None and clock.values.size == series.values.size:
            start = series.start if clock.start is None else clock.start
            return replace(series, times=clock.values, times_unit=clock.unit, start=start)
    return series


def _scalars(tree: Tree, name: str) -> Iterator[tuple[str, float]]:
    if isinstance(tree, Mapping):
        for key, item in tree.items():
            yield from _scalars(item, f"{name}.{key}".lstrip("."))
    elif (value := _number(tree)) is not None:
        yield name, value


def _columns(path: Path, test: str, histories: _Histories) -> Columns:
    """Make a test of histories; without clocks of their own only those of the most common length."""
    plain = [series.values.size for series in histories.series.values() if series.times is None]
    size = max(set(plain), key=lambda length: (plain.count(length), length)) if plain else 0
    columns = {
        name: series
        for name, series in histories.series.items()
        if series.times is not None or series.values.size == size
    }
    for name, series in columns.items():
        require_few_samples(series.values.size, f"{path.name}, {name}")
    return Columns(
        path=path,
        series=columns,
        scalars=histories.scalars,
        named=histories.named,
        test=test,
    )


def short_names(names: Sequence[str]) -> list[str]:
    """Shorten the paths of blocks to their last part that says something, or to more where two would agree.

    >>> short_names(['Platform()://HIL/"Model Root"/Disp_Cmd/Out1', "Model Root/Meas/Disp", "Force (kN/V)"])
    ['Disp_Cmd', 'Disp', 'Force (kN/V)']
    """
    telling = [_telling_parts(name) for name in names]
    depth = [1] * len(names)
    for _ in range(_DEEPEST_NAME):
        short = [".".join(parts[-k:]) for parts, k in zip(telling, depth, strict=True)]
        depth = [k + (short.count(name) > 1) for name, k in zip(short, depth, strict=True)]
    return short


def _telling_parts(name: str) -> list[str]:
    parts = [part.strip().strip('"').strip() for part in name.split("/")]
    if any(part.count("(") != part.count(")") or part.count("[") != part.count("]") for part in parts):
        parts = [name.strip()]  # the stroke stands in a unit
    return [part for part in parts if part and not _GENERIC.match(part)] or [name.strip()]


def _as_list(tree: Tree) -> list[Tree]:
    return tree if isinstance(tree, list) else [] if tree is None else [tree]


def _text(tree: Tree) -> str:
    return tree.strip() if isinstance(tree, str) else ""


def _number(tree: Tree) -> float | None:
    if isinstance(tree, bool | int | float):
        return float(tree)
    if isinstance(tree, np.ndarray | np.number) and _is_number_type(np.asarray(tree)) and np.size(tree) == 1:
        return float(np.asarray(tree).reshape(-1)[0])
    return None


def _names(tree: Tree) -> list[str]:
    if isinstance(tree, list) and tree and all(isinstance(item, str) for item in tree):
        return [item.strip() for item in tree]
    if isinstance(tree, np.ndarray) and tree.dtype.kind in "US":
        return [str(item).strip() for item in tree.reshape(-1)]
    return []


def _is_number_type(array: NDArray[Any]) -> bool:
    return bool(np.issubdtype(array.dtype, np.number) or array.dtype == np.bool_) and bool(
        np.isrealobj(array)
    )


def _vector(tree: Tree) -> NDArray[np.float64] | None:
    columns = _columns_of(tree)
    return columns[0] if len(columns) == 1 else None


def _columns_of(tree: Tree) -> list[NDArray[np.float64]]:
    """Histories in an array: itself, or the columns of a narrow matrix."""
    values = tree.values if isinstance(tree, Series) else tree
    if not isinstance(values, np.ndarray) or not _is_number_type(values):
        return []
    values = values.squeeze()
    if values.ndim == 1 and values.size > 1:
        return [np.asarray(values, dtype=np.float64)]
    if values.ndim == _MATRIX and min(values.shape) <= _WIDEST and max(values.shape) >= _FEWEST_SAMPLES:
        long = values if values.shape[0] >= values.shape[1] else values.T
        return [np.ascontiguousarray(column, dtype=np.float64) for column in long.T]
    return []
