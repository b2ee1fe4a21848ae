"""HDF5 files, among them NetCDF 4, MATLAB 7.3 and the open record of a test, and classic NetCDF files."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np
import scipy

from reliab.core.errors import InputError
from reliab.core.files import LIMITS
from reliab.core.significant_digits import counted
from reliab.core.untrusted_files import lists_of_scales, objects_of, open_hdf5
from reliab.recordings.readers.columns import Columns, Series, plain, series_of
from reliab.recordings.readers.layouts import Tree, require_shallow, tests_of_tree
from reliab.recordings.readers.matlab import tree_of_objects
from reliab.recordings.recording import require_few_samples

if TYPE_CHECKING:
    import h5py

_MATRIX: Final = 2  # dimensions
_SCHEMA: Final = "reliab recording"
_PARTS: Final = {
    "time": "time",
    "command": "command",
    "measured": "measured",
    "force": "force",
    "ground_acceleration": "ground acceleration",
}
STATED_ATTRIBUTES: Final = ("f", "xi", "alpha", "mass", "scale", "skew")
"""Attributes that state the structure and the sensor."""

_SIGNATURE: Final = b"\x89HDF\r\n\x1a\n"
_MATLAB_BLOCK: Final = 512  # bytes that MATLAB 7.3 puts before the signature
_CLASSIC: Final = (b"CDF\x01", b"CDF\x02")
_MOST_ITEMS: Final = 20_000  # of cells and elements of structures together
_LARGE: Final = 1_000_000  # bytes of what may not be referred to twice
_NEVER_WRITTEN: Final = {
    "i2": (-32767.0,),
    "i4": (-2147483647.0,),
    "f4": (9.969209968386869e36,),
    "f8": (9.969209968386869e36,),
}
"""Numbers of classic NetCDF where nothing was written, by type, unless an attribute names others."""


def is_record(file: "h5py.File") -> bool:
    """Whether an open file says that it is a record."""
    return text_of(file.attrs.get("schema", "")).startswith(_SCHEMA)


def columns_of_record(file: "h5py.File", path: Path) -> Columns:
    """Read the variables of a record, those of several actuators with their numbers."""
    numbers = (
        [text_of(value) for value in np.asarray(file["actuator"][()]).reshape(-1)]
        if "actuator" in file
        else [""]
    )
    series: dict[str, Series] = {}
    parts: dict[str, tuple[str, str]] = {}
    for name, item in file.items():
        if not hasattr(item, "shape") or item.dtype.kind not in "iuf" or name == "actuator":
            continue
        location = f"{path.name}, {name}"
        require_few_samples(max(item.shape, default=0), location)
        matrix = series_of(np.atleast_2d(item[()]), item.attrs, marks=_marks(item), location=location)
        for number, row in zip(numbers if len(matrix.values) > 1 else [""], matrix.values, strict=True):
            column = f"{name}_{number}" if number else name
            series[column] = replace(matrix, values=row)
            if name in _PARTS:
                parts[column] = (_PARTS[name], number)
    attributes = {name: text_of(file.attrs[name]) for name in STATED_ATTRIBUTES if name in file.attrs}
    return Columns(path=path, series=series, parts=parts, header=attributes)


def text_of(value: object) -> str:
    """Text of an attribute, whatever HDF5 made of it."""
    if isinstance(value, np.ndarray):
        value = value.reshape(-1)[0] if value.size else ""
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)


def recognises(head: bytes) -> bool:
    """Whether a file begins as HDF5."""
    return head.startswith(_SIGNATURE) or head[_MATLAB_BLOCK:].startswith(_SIGNATURE)


def recognises_classic(head: bytes) -> bool:
    """Whether a file begins as classic NetCDF."""
    return head.startswith(_CLASSIC)


def read_hierarchical(path: Path, _delimiter: str | None = None) -> list[Columns]:
    """Read the tests of an HDF5 file: its datasets in all groups, or the variables of MATLAB 7.3."""
    with open_hdf5(path) as file:
        if is_record(file):
            return [columns_of_record(file, path)]
        if any("MATLAB_object_decode" in item.attrs for _, item in objects_of(file)):
            _require_single_references(file)
            tree = None
        else:
            tree = _Contents(file, path).tree()
    return tests_of_tree(path, tree_of_objects(path) if tree is None else tree)


def read_classic(path: Path, _delimiter: str | None = None) -> list[Columns]:
    """Read the variables of a classic NetCDF file."""
    with scipy.io.netcdf_file(path, "r", mmap=False, maskandscale=False) as file:
        tree = {
            name: _unpack_variable(variable, f"{path.name}, {name}")
            for name, variable in file.variables.items()
        }
    return tests_of_tree(path, tree)


def _unpack_variable(variable: "scipy.io.netcdf_variable", location: str) -> Tree:
    """Unpack a vector or a matrix of a classic NetCDF file, whose times have the name of its dimension."""
    values = np.array(variable[()])
    if not 0 < values.ndim <= _MATRIX or values.dtype.kind not in "iuf":
        return values
    attributes = vars(variable)["_attributes"]
    series = series_of(
        values.astype(values.dtype.newbyteorder("=")),
        attributes,
        marks=_NEVER_WRITTEN.get(values.dtype.str[1:], ()),
        location=location,
    )
    return replace(series, axis=variable.dimensions[0] if values.ndim < _MATRIX else "")


class _Contents:
    """What an open file holds, as a tree; cells and structures of MATLAB are followed by their references."""

    def __init__(self, file: "h5py.File", path: Path) -> None:
        self._file, self._path = file, path
        self._bytes = self._items = 0

    def tree(self) -> dict[str, Tree]:
        """All groups and datasets but those that MATLAB only refers to."""
        return self._group(self._file, 0)

    def _item(self, item: "h5py.HLObject", depth: int) -> Tree:
        import h5py

        return self._group(item, depth) if isinstance(item, h5py.Group) else self._dataset(item, depth)

    def _group(self, group: "h5py.Group", depth: int) -> dict[str, Tree]:
        import h5py

        require_shallow(depth, self._path.name)
        content: dict[str, Tree] = {}
        for name in group:
            link = group.get(name, getlink=True)
            if name.startswith("#") or not isinstance(link, h5py.HardLink):
                continue
            content[name] = self._item(group[name], depth + 1)
        if "MATLAB_sparse" in group.attrs:
            return {}  # no history: places and values of what is not zero
        if group.attrs.get("MATLAB_class") == b"struct" and (elements := self._elements(group, content)):
            return elements  # type: ignore[return-value]  # an array of structures
        single = {
            name: text_of(value) if isinstance(value, str | bytes) else np.asarray(value)
            for name, value in group.attrs.items()
            if np.ndim(value) == 0 and not name.startswith("MATLAB_")
        }
        return {**single, **content}

    def _elements(self, group: "h5py.Group", content: dict[str, Tree]) -> list[dict[str, Tree]]:
        """Elements of an array of structures, whose fields are datasets of references without a class."""
        import h5py

        fields = [name for name in content if isinstance(group[name], h5py.Dataset)]
        arrays = [
            name
            for name in fields
            if isinstance(content[name], list) and "MATLAB_class" not in group[name].attrs
        ]
        if not arrays or len(arrays) != len(content) or len({len(content[name]) for name in arrays}) != 1:
            return []
        return [
            dict(zip(arrays, values, strict=True))
            for values in zip(*(content[name] for name in arrays), strict=True)
        ]

    def _dataset(self, item: "h5py.Dataset", depth: int) -> Tree:
        require_shallow(depth, self._path.name)
        kind = item.attrs.get("MATLAB_class", b"")
        if "MATLAB_empty" in item.attrs:
            return np.zeros(0)
        if _refers(item):
            return self._resolve_references(item, depth)
        require_few_samples(
            max(item.shape, default=0), f"{self._path.name}, {item.name.strip('/').replace('/', '.')}"
        )
        self._bytes += int(item.nbytes)
        LIMITS["test"].require_few_numbers(self._bytes, self._path.name)
        values = np.asarray(item[()])
        if item.dtype.names:
            return {name: np.asarray(values[name]) for name in item.dtype.names}
        if kind == b"char":
            return _characters(values)
        if item.dtype.kind in "SOU":
            texts = [text_of(value) for value in values.reshape(-1)]
            return texts[0] if len(texts) == 1 else texts
        return (
            self._apply_attributes(item, values) if item.dtype.kind in "iuf" and values.size > 1 else values
        )

    def _apply_attributes(self, item: "h5py.Dataset", values: np.ndarray) -> Tree:
        """Apply what stands beside a vector, or beside a matrix with names and units of its columns."""
        items = dict(item.attrs)
        texts = {name: _texts(value) for name, value in items.items()}
        units = next((texts[name] for name in items if plain(name) in {"unit", "units"} and texts[name]), [])
        location = f"{self._path.name}, {_name_of(item)}"
        series = _mark_gaps(series_of(values, items, marks=_marks(item), location=location), item)
        scales = [self._scales_of(axis) for axis in lists_of_scales(item)]
        if values.squeeze().ndim == 1:
            times = [_name_of(scale) for scale in scales[int(np.argmax(values.shape))]] if scales else []
            return replace(series, values=series.values.squeeze(), axis=times[0] if times else "")
        if values.ndim != _MATRIX:
            return series
        labels = [_texts(scale[()]) for axis in scales for scale in axis if scale.dtype.kind in "SOU"]
        for names in (*(name_list for name_list in texts.values() if name_list is not units), *labels):
            if len(names) in values.shape and len(set(names)) == len(names) > 1:
                upright = series.values if len(names) == values.shape[1] else series.values.T
                column_units = units * len(names) if len(units) == 1 else units
                column_units = column_units if len(column_units) == len(names) else [""] * len(names)
                return {
                    name: replace(series, values=column, unit=unit)
                    for name, column, unit in zip(names, upright.T, column_units, strict=True)
                }
        return series

    def _scales_of(self, references: np.ndarray) -> "list[h5py.Dataset]":
        """Find the scales of a dimension among the datasets of the file."""
        import h5py

        targets = [self._file[reference] for reference in np.ravel(references) if reference]
        return [target for target in targets if isinstance(target, h5py.Dataset)]

    def _resolve_references(self, item: "h5py.Dataset", depth: int) -> list[Tree]:
        self._items += item.size
        if self._items > _MOST_ITEMS:
            raise InputError(
                f"The file holds more than {_MOST_ITEMS:,} cells and elements of structures",
                remedy="Save the channels as vectors",
                where=self._path.name,
            )
        return [self._item(self._file[reference], depth + 1) for reference in np.ravel(item[()])]


def _refers(item: "h5py.Dataset") -> bool:
    """Whether a dataset holds references to other parts of the file; texts have the same type for NumPy."""
    import h5py

    return h5py.check_ref_dtype(item.dtype) is not None


def _name_of(item: "h5py.Dataset") -> str:
    return str(item.name).strip("/").replace("/", ".")


def _mark_gaps(series: Series, item: "h5py.Dataset") -> Series:
    """Mark samples of chunks that were never written, where others were; the library reads zeros there."""
    chunk_count = 0 if item.chunks is None else item.id.get_num_chunks()
    grid = [-(-size // chunk) for size, chunk in zip(item.shape, item.chunks or item.shape, strict=True)]
    if not 0 < chunk_count < np.prod(grid):
        return series
    is_written = np.zeros(grid, dtype=np.bool_)
    for place in range(chunk_count):
        is_written[tuple(np.floor_divide(item.id.get_chunk_info(place).chunk_offset, item.chunks))] = True
    for axis, (size, chunk) in enumerate(zip(item.shape, item.chunks, strict=True)):
        is_written = np.repeat(is_written, chunk, axis=axis).take(range(size), axis=axis)
    gap = f"{counted(int((~is_written).sum()), 'sample')} never written"
    return replace(
        series, values=np.where(is_written, series.values, np.nan), corrections=(*series.corrections, gap)
    )


def _marks(item: "h5py.Dataset") -> tuple[float, ...]:
    """Return what stands where nothing was written, if the file states it; zero may be a reading."""
    import h5py

    has_fill_value = item.id.get_create_plist().fill_value_defined() == h5py.h5d.FILL_VALUE_USER_DEFINED
    return (float(item.fillvalue),) if has_fill_value and item.fillvalue else ()


def _texts(value: object) -> list[str]:
    """Texts of an attribute or of a vector; none where it holds anything else."""
    items = np.asarray(value).reshape(-1)
    plain = items.dtype.kind in "SU" or all(isinstance(item, str | bytes) for item in items)
    return [text_of(item).strip() for item in items] if plain and items.size <= _MOST_ITEMS else []


def _require_single_references(file: "h5py.File") -> None:
    """Refuse what is referred to twice and large or refers further: it would multiply in memory."""
    import h5py

    visited, total = set(), 0
    for _, item in objects_of(file):
        if not isinstance(item, h5py.Dataset):
            continue
        total += int(item.nbytes)
        if not _refers(item):
            continue
        for reference in np.asarray(item[()]).reshape(-1):
            target = file[reference]
            place = h5py.h5o.get_info(target.id).addr
            small = isinstance(target, h5py.Dataset) and not _refers(target) and target.nbytes < _LARGE
            if place in visited and not small:
                raise ValueError("a part that is referred to twice")
            visited.add(place)
    LIMITS["test"].require_few_numbers(total, file.filename)


def _characters(values: np.ndarray) -> str | list[str]:
    """Characters of MATLAB 7.3, in numbers of UTF-16; rows of a matrix of them are texts of their own."""
    character_rows = np.moveaxis(np.atleast_2d(values.T), 1, -1)
    rows = character_rows.reshape(-1, character_rows.shape[-1]).astype("<u2")
    texts = [row.tobytes().decode("utf-16-le", errors="replace").strip() for row in rows]
    return texts[0] if len(texts) == 1 else texts
