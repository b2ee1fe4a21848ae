"""The ellipses of 100 real motions that ship, and measures of the responses to them, in plain arrays."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from functools import cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from reliab.core.files import decoding
from reliab.core.log_quantization import NEIGHBOURS, UNKNOWN, numbers_of
from reliab.core.shipped import shipped
from reliab.core.untrusted_files import open_hdf5
from reliab.core.vocabulary import SHARE_ATTRIBUTE
from reliab.criterion.ellipse_table import CUT, DIMENSIONS, REST, CutRecords, EllipseTable, words_of
from reliab.criterion.response_measures import BoundaryScales, ResponseMeasures, directions_about

if TYPE_CHECKING:
    import h5py

_ELLIPSES, _MEASURES = "real_suite/ellipses.nc", "real_suite/first_order.nc"
_NO_SELECTION: Final[Mapping[str, slice]] = MappingProxyType({})


@cache
def read_shipped_ellipses(curve: str, window: str, metric: str) -> EllipseTable:
    """Ellipses of one kind that ship, of one error over one of the windows."""
    with _open_shipped(_ELLIPSES, "Ellipses") as file:
        coordinates = {name: _values(file, name) for name in DIMENSIONS}
        selection = {"window": window, "curve": curve, "metric": metric}
        place = {name: _values(file, name).tolist().index(label) for name, label in selection.items()}
        part = {name: slice(row, row + 1) for name, row in place.items()}
        return EllipseTable(
            **{name: _numbers(file, name, part)[0] for name in ("a", "b")},
            coordinates=coordinates | {name: coordinates[name][part[name]] for name in ("curve", "metric")},
            motion_values={
                name: _values(file, name) for name in ("event", "duration", "checksum", "outline")
            },
            error_at_rest=file[REST][place["window"]][..., part["metric"]],
            cut_records=_cut_records(file) if window == "record" else None,
            attrs={SHARE_ATTRIBUTE: float(file.attrs[SHARE_ATTRIBUTE][0]), "window": window},
            words=words_of(),
        )


def _cut_records(file: "h5py.File") -> CutRecords:
    ratios = np.stack([file[name][()].astype(np.float64) for name in CUT], axis=-1)
    return CutRecords(lengths=_values(file, "length").astype(np.float64), ratios=ratios)


def read_shipped_measures(angle: float | None = None) -> ResponseMeasures:
    """Measures of the responses to the motions of the ellipses that ship.

    `angle` [rad]: the direction in which boundaries will be compared, if in one alone.
    """
    measures = _measures()
    if angle is None or measures.scales is None:
        return measures
    first = directions_about(angle)[0]
    scales = replace(measures.scales, towards=_towards(first), first_direction=first)
    return replace(measures, scales=scales)


@cache
def _measures() -> ResponseMeasures:
    """Read all but the multiples towards directions, of which most questions need none."""
    with _open_shipped(_MEASURES, "Measures of responses") as file:
        return ResponseMeasures(
            **{name: file[name][()] for name in ("a_first", "b_first", "effective_duration", "duration")},
            motions=_values(file, "motion"),
            frequencies=file["f"][()],
            damping_ratios=file["xi"][()],
            scales=BoundaryScales(
                least=_numbers(file, "scale"),
                towards=_numbers(file, "scale_towards", {"direction": slice(0)}),
                thresholds=file["threshold"][()],
                sides=_values(file, "side").tolist(),
            ),
        )


@cache
def _towards(first: int) -> NDArray[Any]:
    """Read the multiples towards a direction and the next."""
    with _open_shipped(_MEASURES, "Measures of responses") as file:
        return _numbers(file, "scale_towards", {"direction": slice(first, first + 2)})


@contextmanager
def _open_shipped(name: str, words: str) -> Iterator["h5py.File"]:
    """Open a file that ships; `words`: what it holds."""
    path, rule = shipped("datasets", name), f"{words} must be a NetCDF file"
    remedy = "Install the package again"
    with decoding(rule, remedy=remedy, where=path), open_hdf5(path, ships=True) as file:
        yield file


def _numbers(file: "h5py.File", name: str, part: Mapping[str, slice] = _NO_SELECTION) -> NDArray[Any]:
    """Read numbers that are stored in steps of their logarithm, or a part of them along some dimensions.

    Numbers are told by those before them: along neighbours one place is read with all before it.
    """
    dataset = file[name]
    dimensions = [str(scale[0].name).rpartition("/")[2] for scale in dataset.dims]
    selection = {dimension: part.get(dimension, slice(None)) for dimension in dimensions}
    neighbours = dataset.attrs[NEIGHBOURS].split()
    read = tuple(slice(index.stop) if name in neighbours else index for name, index in selection.items())
    numbers = numbers_of(dataset[read], dataset.attrs, dimensions, last=list(part))
    unknown = file[dataset.attrs[UNKNOWN]]
    unknown_values = unknown[tuple(selection.values())[: unknown.ndim]]
    is_known = unknown_values.reshape(unknown_values.shape + (1,) * (dataset.ndim - unknown.ndim)) == 0
    return np.where(is_known, numbers, np.float32(np.nan))


def _values(file: "h5py.File", name: str) -> NDArray[Any]:
    """Numbers or texts along a dimension."""
    values = file[name]
    return np.array(values.asstr()[()].tolist(), dtype=np.str_) if values.dtype.kind == "O" else values[()]
