"""A whole grid solved for one ground motion, and the layout of the store that takes it.

A chunk holds the results of one motion and is written here, not by Zarr, which passes every chunk through an
event loop and a pool of threads; that costs as much processor time as simulating it. The bytes are the same:
little-endian values, Blosc, CRC-32C, under the name that the array prescribes.
"""

import json
import shutil
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.files import decoding, make_unfinished_name, ordinary, refuse_links
from reliab.core.vocabulary import LABELS, SHARE_ATTRIBUTE, Dimension, Metric
from reliab.motions.motion import Motion
from reliab.simulation.excitation import Excitation
from reliab.simulation.linear_loop.cells import Cells
from reliab.simulation.linear_loop.tracking_sums import QuadraturePair, TrackedCells, tracking_sums
from reliab.structures.structure import Structure, critical_delay
from reliab.sweep.request import Grid, SweepRequest, excitation_of, loop_of
from reliab.tracking.indices.response_error import relative_error
from reliab.tracking.indices.tracking import evaluate_sums
from reliab.tracking.indices.window import Window

if TYPE_CHECKING:
    import zarr


_NODES = 4  # along each axis, at which the index is summed; A/k_p and d/τ vary little between
_SHORTEST = 0.1  # of the longest delay; d/τ of shorter ones is that of this one
_CENTRAL = 2.0  # damping ratios of amplitude error within which the nodes lie


@dataclass(frozen=True, kw_only=True)
class MotionResults:
    """Results of one ground motion and one window over (f, xi, kp, tau), or (f, xi, alpha, kp, tau)."""

    rms: NDArray[np.float32]  # rms, mte: Errors of the whole test [-]
    mte: NDArray[np.float32]
    A: NDArray[np.float32]  # Amplitude of the evaluation index [-]
    d: NDArray[np.float32]  # Equivalent delay [s]
    stable: NDArray[np.bool_]  # Whether the delay is below the critical delay
    # RMS^R of an actuator that does not move [-], over the structures; its MTE^R is 1
    rms_at_rest: NDArray[np.float32]


VARIABLES = ("rms", "mte", "A", "d", "stable", "rms_at_rest")


@lru_cache(maxsize=256)
def _cells(grid: Grid, structure: Structure) -> Cells:
    """Cells of a structure, computed once for all motions."""
    return grid.cells(structure)


def solve_motion(motion: Motion, request: SweepRequest) -> list[MotionResults]:
    """Simulate one ground motion for all structures and actuators."""
    return [_solve_window(motion, request, window) for window in request.windows]


def _solve_window(motion: Motion, request: SweepRequest, window: Window) -> MotionResults:
    excitation = excitation_of(motion, window)
    pair = QuadraturePair.from_excitation(excitation)
    tables = [_solve_structure(excitation, pair, request, structure) for structure in request.structures]
    shape = tuple(map(len, request.structure_axes.values()))
    columns = {
        name: np.stack([table[name] for table in tables]).reshape(shape + tables[0][name].shape)
        for name in VARIABLES
    }
    return MotionResults(**columns)


def _solve_structure(
    excitation: Excitation,
    pair: QuadraturePair,
    request: SweepRequest,
    structure: Structure,
) -> dict[str, NDArray[np.generic]]:
    cells = _cells(request.grid, structure)
    shape = (request.grid.gains(structure).size, request.grid.delays(structure).size)
    loop = loop_of(request.model, excitation, structure, request.engine)
    deviation = loop.deviation(cells)
    amplitude, delay = _evaluate(pair, request.grid, structure)
    with np.errstate(over="ignore"):  # a violently unstable cell becomes infinite on disk
        return {
            "rms": relative_error(deviation, Metric.RMS).reshape(shape).astype(np.float32),
            "mte": relative_error(deviation, Metric.MTE).reshape(shape).astype(np.float32),
            "A": amplitude.astype(np.float32),
            "d": delay.astype(np.float32),
            "stable": cells.stable.reshape(shape),
            "rms_at_rest": relative_error(loop.rest_deviation(), Metric.RMS)[0].astype(np.float32),
        }


def _evaluate(pair: QuadraturePair, grid: Grid, structure: Structure) -> tuple[Array, Array]:
    """Amplitude [-] and equivalent delay [s] over the grid, from sums at a few of its nodes.

    Lags and leads have separate nodes. Beyond the critical delay, and beyond twice the damping ratio of
    amplitude error, the shares A/k_p and d/τ are those of the last node.
    """
    gains, delays = grid.gains(structure), grid.delays(structure)
    amplitude, equivalent = np.empty((2, gains.size, delays.size))
    cells, sides = _nodes(grid, structure)
    statistics = evaluate_sums(tracking_sums(pair, cells))
    units = (cells.gain, gains[:, np.newaxis]), (cells.delay, delays)
    for table, values, (node_unit, grid_unit) in zip((amplitude, equivalent), statistics, units, strict=True):
        for side in sides:
            table[:, side.columns] = (
                side.gain_weights @ (values / node_unit)[side.cells] @ side.delay_weights.T
            )
        np.multiply(table, grid_unit, out=table)
    return amplitude, equivalent


@dataclass(frozen=True, kw_only=True)
class _Nodes:
    """Cells of one side at which the evaluation index is computed, and the weights that interpolate it."""

    cells: NDArray[np.intp]  # Which cells, shape (gain nodes, delay nodes)
    columns: slice  # Delays of the grid that they serve
    # over_gain, over_delay: Weights of the nodes along each axis, shapes (kp, gain nodes) and (tau, delay
    # nodes)
    gain_weights: Array
    delay_weights: Array


@lru_cache(maxsize=256)
def _nodes(grid: Grid, structure: Structure) -> tuple[TrackedCells, list[_Nodes]]:
    """Nodes of the lags, including the actuator without delay, and of the leads if the grid has any."""
    gains, delays = grid.gains(structure), grid.delays(structure)
    central = np.abs(np.log(gains)) <= _CENTRAL * structure.damping_ratio
    gain_nodes = _evenly(gains[central])
    leads = int(np.searchsorted(delays, 0.0))
    late = delays[(delays > 0.0) & (delays < critical_delay(structure))]
    sides = [(slice(leads, None), _evenly(_distinct(late)))]
    if leads:
        sides.append((slice(0, leads), _evenly(_distinct(delays[:leads]))))
    delay_nodes = np.concatenate([side_nodes for _, side_nodes in sides])
    gain, delay = np.meshgrid(gain_nodes, delay_nodes, indexing="ij")
    places, ends = np.arange(gain.size).reshape(gain.shape), np.cumsum([side.size for _, side in sides])
    nodes = [
        _Nodes(
            cells=places[:, end - side_nodes.size : end],
            columns=columns,
            gain_weights=_polynomial_weights(gain_nodes, gains),
            delay_weights=_polynomial_weights(side_nodes, delays[columns]),
        )
        for (columns, side_nodes), end in zip(sides, ends.tolist(), strict=True)
    ]
    return TrackedCells(structure=structure, gain=gain.ravel(), delay=delay.ravel()), nodes


def _distinct(delays: Array) -> Array:
    """Leave out delays so short that the error of the sums, some 10 µs, is not small against them."""
    return np.asarray(delays[np.abs(delays) >= _SHORTEST * np.abs(delays).max()])


def _evenly(values: Array) -> Array:
    """Choose a few of the values, as evenly spaced as possible."""
    even = np.linspace(values[0], values[-1], _NODES)
    nearest = np.unique(np.argmin(np.abs(values[:, np.newaxis] - even), axis=0))
    return np.asarray(values[nearest])


def _polynomial_weights(nodes: Array, values: Array) -> Array:
    """Weights of the polynomial through the nodes, constant beyond them; shape (values, nodes)."""
    powers = np.polynomial.chebyshev.chebvander
    centre, half = 0.5 * (nodes[0] + nodes[-1]), 0.5 * (nodes[-1] - nodes[0]) or 1.0
    scaled_values = (np.clip(values, nodes[0], nodes[-1]) - centre) / half
    node_powers = powers((nodes - centre) / half, nodes.size - 1)
    return np.asarray(powers(scaled_values, nodes.size - 1) @ np.linalg.inv(node_powers), dtype=np.float64)


# Zarr takes long to import and is imported where a store is opened or written.

_COMPRESSOR: Final = "zstd"
_LEVEL: Final = 1


def codecs() -> list[Any]:
    """Zarr's codecs of arrays of numbers, with which chunks are read."""
    from zarr.codecs import BloscCodec, Crc32cCodec

    return [BloscCodec(cname=_COMPRESSOR, clevel=_LEVEL), Crc32cCodec()]


def encode(values: NDArray[np.generic]) -> bytes:
    """Encode the values of a chunk."""
    from numcodecs.blosc import BITSHUFFLE, SHUFFLE, Blosc
    from numcodecs.checksum32 import CRC32C

    plain = np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("<"))
    shuffle = BITSHUFFLE if plain.itemsize == 1 else SHUFFLE
    content = Blosc(cname=_COMPRESSOR, clevel=_LEVEL, shuffle=shuffle).encode(plain)
    return bytes(CRC32C(location="end").encode(content))


def chunk_path(folder: Path, array: Any, index: int) -> Path:  # noqa: ANN401
    """Place of the results of a motion within the folder of an array, which prescribes their name."""
    return Path(folder, array.metadata.encode_chunk_key((index, *[0] * (array.ndim - 1))))


def write_chunk(store: Path, chunk_path: Path, chunk: bytes) -> None:
    """Write a file of a store at once or not at all, without waiting for the disk."""
    place, partial_file = store / chunk_path, make_unfinished_name(store / "chunk")
    try:
        with partial_file.open("xb") as file:
            file.write(chunk)
        if "." not in place.name:
            place.parent.mkdir(parents=True, exist_ok=True)
        partial_file.replace(place)
    except BaseException:
        partial_file.unlink(missing_ok=True)
        raise


SCHEMA_VERSION = 2
READABLE_VERSIONS: Final = (1, SCHEMA_VERSION)
"""Versions of stored results that are read; the first has no consolidated metadata, coordinates or status."""

ZARR_FORMAT: Final = 3
JOURNAL = "journal/entries"
"""Array of the entries that show which motions are done, apart from what users of xarray open."""

UNFINISHED_NOTE, COMPLETE_NOTE = "unfinished: motions without results are NaN", "complete"
"""What the attribute `status` says of the motions."""

RECORD_FIELDS: dict[str, type | str] = {
    "duration": "float64",
    "dt": "float64",
    "pga": "float64",
    "checksum": str,
}
"""Data stored for each record, with their types."""

STORED_RULE = "Stored results must be as `reliab simulate` wrote them, with every checksum right"
MEND = "Repair the store with `reliab simulate --resume`, or simulate again to another store"
"""Rule for stored results, and the remedy where it is broken."""

_MOTION_VARIABLES = ("event", *RECORD_FIELDS)
_GRID_SCALES: Final = {
    Dimension.GAIN: "scaled with the damping ratio: one row of gains for each xi",
    Dimension.DELAY: "scaled with xi / (2 pi f): one row of delays for each f and xi",
}
"""What stands beside the gains and delays of a grid that differs between structures."""

_DTYPES = {name: "bool" if name == "stable" else "float32" for name in VARIABLES}
_MOTIONS_PER_CHUNK = 1024
_PACKAGES = ("reliab", "numpy", "numba", "scipy", "xarray", "zarr")


def open_group(path: Path, mode: Literal["r", "r+"] = "r") -> "zarr.Group":
    """Open a group of a store in the format that we write; format 2 can hold code that is run on reading."""
    import zarr

    return zarr.open_group(path, mode=mode, zarr_format=ZARR_FORMAT, use_consolidated=False)


def array_of(group: "zarr.Group", name: str) -> Any:  # noqa: ANN401 - arrays of many types
    """Array of a group by its name."""
    return group[name]


def group_names(request: SweepRequest) -> list[str]:
    """Group of each window: the root for the first, `window_…` for further ones."""
    return ["", *(f"window_{window.label}" for window in request.windows[1:])]


def create_store(path: Path, request: SweepRequest, names: Sequence[str], events: Sequence[str]) -> None:
    """Create an empty store with all its arrays, under a temporary name that is then changed."""
    import zarr

    if not names:
        raise InputError("No ground motions given", remedy="Name files, folders or a suite")
    partial_store = path.with_name(path.name + ".unfinished")
    shutil.rmtree(partial_store, ignore_errors=True)
    root = zarr.create_group(partial_store, zarr_format=ZARR_FORMAT)
    chunk = min(len(names), _MOTIONS_PER_CHUNK)
    for group_name, window in zip(group_names(request), request.windows, strict=True):
        group = root.create_group(group_name) if group_name else root
        group.attrs.update(attributes(request, window.label))
        _create_variables(group, request, len(names))
        for name, values in (("motion", names), ("event", events)):
            array = _create_array(group, name, (len(names),), (chunk,), str, (Dimension.MOTION,))
            array[:] = np.array(values, dtype=np.dtypes.StringDType())
        for name, dtype in RECORD_FIELDS.items():
            _create_array(group, name, (len(names),), (chunk,), dtype, (Dimension.MOTION,))
    folder, entries = JOURNAL.split("/")
    _create_array(root.create_group(folder), entries, (len(names),), (chunk,), str, (Dimension.MOTION,))
    consolidate(partial_store, group_names(request))
    partial_store.rename(path)


def consolidate(path: Path, groups: Sequence[str]) -> None:
    """Gather the descriptions of all arrays where xarray looks for them; of groups inside others first."""
    import zarr

    with warnings.catch_warnings():
        # Zarr warns that its format 3 does not know this yet; others then read the arrays one by one
        warnings.simplefilter("ignore", UserWarning)
        for name in reversed(groups):
            zarr.consolidate_metadata(path, path=name, zarr_format=ZARR_FORMAT)


def _create_variables(group: "zarr.Group", request: SweepRequest, motions: int) -> None:
    coordinates = request.grid.coordinates(request.frequencies, request.damping_ratios)
    axes = {
        **{str(name): ((name,), np.array(values)) for name, values in request.structure_axes.items()},
        **coordinates,
    }
    for name, (dims, values) in axes.items():
        array = _create_array(group, name, values.shape, values.shape, "float64", dims)
        array[...] = values
        if len(dims) > 1:
            array.attrs["comment"] = _GRID_SCALES[Dimension(name)]
    for name, axis_sizes in _sizes_of_variables(request, motions).items():
        sizes = tuple(axis_sizes.values())
        _create_array(group, name, sizes, (1, *sizes[1:]), _DTYPES[name], tuple(axis_sizes))


def _sizes_of_variables(request: SweepRequest, motions: int) -> dict[str, dict[str, int]]:
    """Size of every variable over each of its dimensions."""
    coordinates = request.grid.coordinates(request.frequencies, request.damping_ratios)
    structure_sizes: dict[str, int] = {
        Dimension.MOTION: motions,
        **{name: len(values) for name, values in request.structure_axes.items()},
    }
    actuator_sizes: dict[str, int] = {
        name: coordinates[name][1].shape[-1] for name in (Dimension.GAIN, Dimension.DELAY)
    }
    return {
        name: structure_sizes if name == "rms_at_rest" else structure_sizes | actuator_sizes
        for name in VARIABLES
    }


def shapes(request: SweepRequest, motions: int) -> dict[str, tuple[int, ...]]:
    """Shape of every array of results and records in a store."""
    window_shapes: dict[str, tuple[int, ...]] = {
        **{name: tuple(sizes.values()) for name, sizes in _sizes_of_variables(request, motions).items()},
        **dict.fromkeys((str(Dimension.MOTION), *_MOTION_VARIABLES), (motions,)),
    }
    windows = {
        f"{group}/{name}".lstrip("/"): shape
        for group in group_names(request)
        for name, shape in window_shapes.items()
    }
    return windows | {JOURNAL: (motions,)}


def _create_array(
    group: "zarr.Group",
    name: str,
    shape: tuple[int, ...],
    chunks: tuple[int, ...],
    dtype: type | str,
    dims: Sequence[str],
) -> "zarr.Array[Any]":
    from zarr.codecs import Crc32cCodec

    compressors = [Crc32cCodec()] if dtype is str else codecs()
    label = LABELS.get(name)
    attributes: dict[str, Any] = {} if label is None else {"long_name": label.long_name, "units": label.units}
    return group.create_array(
        name,
        shape=shape,
        chunks=chunks,
        dtype=dtype,
        dimension_names=[str(dim) for dim in dims],
        compressors=compressors,
        # A folder for each index of a chunk would take longer to make than its values to simulate.
        chunk_key_encoding={"name": "default", "separator": "."},
        fill_value=float("nan") if dtype in ("float32", "float64") else None,
        attributes=attributes,
    )


def attributes(request: SweepRequest, window: str) -> dict[str, Any]:
    """Attributes of the group of a window: what was asked for, and the versions that answer."""
    description = request.describe()
    model = {"model": json.dumps(description["model"])} if "model" in description else {}
    share = {name: description[name] for name in (SHARE_ATTRIBUTE,) if name in description}
    return {
        "schema_version": SCHEMA_VERSION,
        "status": UNFINISHED_NOTE,
        "coordinates": " ".join((Dimension.GAIN, Dimension.DELAY, *_MOTION_VARIABLES)),
        "study_hash": request.digest(),
        "window": window,
        "windows": description["windows"],
        "grid": description["grid"],
        "engine": description["engine"],
        "tolerance": description["tolerance"],
        **share,
        **model,
        "versions": json.dumps({name: version(name) for name in _PACKAGES}),
    }


def read_attributes(path: Path) -> dict[str, object]:
    """Attributes of a store, whose schema must be known to this version."""
    rule = "Results are read from a Zarr store that 'reliab simulate' wrote"
    with decoding(rule, remedy="Check the path, or simulate first", where=path):
        refuse_links(path, reads=True)
        for file in path.rglob("*"):
            ordinary(file)
        attributes: dict[str, object] = dict(open_group(path).attrs)
    require_readable(attributes, path)
    return attributes


def require_readable(attributes: Mapping[Any, object], path: Path) -> None:
    """Refuse results whose schema this version does not know."""
    if attributes.get("schema_version") not in READABLE_VERSIONS:
        raise InputError(
            f"This version reads results of schema versions {' and '.join(map(str, READABLE_VERSIONS))}",
            value=f"version {attributes.get('schema_version', 'none')} in {path}",
            remedy="Simulate again, or use the version of reliab that wrote them",
        )
