"""The ellipses of 100 real motions that ship, and measures of the responses to them, in plain arrays."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from reliab.criterion.ellipse_table import DIMENSIONS, REST, EllipseTable, words_of
from reliab.criterion.response_measures import BoundaryScales, ResponseMeasures
from reliab.files import decoding
from reliab.received import opened_hdf5
from reliab.shipped import shipped
from reliab.steps_of_logarithm import NEIGHBOURS, UNKNOWN, numbers_of
from reliab.vocabulary import SHARE_ATTRIBUTE

if TYPE_CHECKING:
    import h5py

_ELLIPSES, _MEASURES = "real_suite/ellipses.nc", "real_suite/first_order.nc"
_WHOLE: Final[Mapping[str, slice]] = MappingProxyType({})


@cache
def shipped_windows() -> tuple[str, ...]:
    """Windows over which the errors of the ellipses that ship were computed."""
    with _opened(_ELLIPSES, "Ellipses") as file:
        return tuple(_values(file, "window").tolist())


@cache
def shipped_ellipses(curve: str, window: str) -> EllipseTable:
    """Ellipses of one kind that ship, for one of the windows over which errors were computed."""
    with _opened(_ELLIPSES, "Ellipses") as file:
        at = {name: _values(file, name) for name in DIMENSIONS}
        place, k = (
            names.tolist().index(name)
            for names, name in ((at["curve"], curve), (_values(file, "window"), window))
        )
        at["curve"] = at["curve"][place : place + 1]
        part = {"window": slice(k, k + 1), "curve": slice(place, place + 1)}
        return EllipseTable(
            **{name: _numbers(file, name, part)[0] for name in ("a", "b")},
            at=at,
            of_motions={name: _values(file, name) for name in ("event", "duration", "checksum")},
            error_at_rest=file[REST][k],
            attrs={SHARE_ATTRIBUTE: float(file.attrs[SHARE_ATTRIBUTE][0]), "window": window},
            words=words_of(),
        )


@cache
def shipped_measures() -> ResponseMeasures:
    """Measures of the responses to the motions of the ellipses that ship."""
    with _opened(_MEASURES, "Measures of responses") as file:
        return ResponseMeasures(
            **{name: file[name][()] for name in ("a_first", "b_first", "effective_duration", "duration")},
            motions=_values(file, "motion"),
            frequencies=file["f"][()],
            damping_ratios=file["xi"][()],
            scales=BoundaryScales(
                least=_numbers(file, "scale"),
                towards=_numbers(file, "scale_towards"),
                thresholds=file["threshold"][()],
                sides=_values(file, "side").tolist(),
            ),
        )


@contextmanager
def _opened(name: str, words: str) -> Iterator["h5py.File"]:
    """Open a file that ships; `words`: what it holds."""
    path, rule = shipped("datasets", name), f"{words} must be a NetCDF file"
    with decoding(rule, remedy="Install the package again", where=path), opened_hdf5(path) as file:
        yield file


def _numbers(file: "h5py.File", name: str, part: Mapping[str, slice] = _WHOLE) -> NDArray[Any]:
    """Read numbers that are stored in steps of their logarithm, or a part of them along some dimensions.

    Numbers are told by those before them: along neighbours they are read from the first on.
    """
    stored = file[name]
    dimensions = [str(scale[0].name).rpartition("/")[2] for scale in stored.dims]
    asked = [part.get(dimension, slice(None)) for dimension in dimensions]
    near = [dimension in stored.attrs[NEIGHBOURS].split() for dimension in dimensions]
    pairs = list(zip(asked, near, strict=True))
    read = tuple(slice(each.stop) if beside else each for each, beside in pairs)
    within = tuple(slice(each.start, None) if beside else slice(None) for each, beside in pairs)
    numbers = numbers_of(stored[read], stored.attrs, dimensions)[within]
    unknown = file[stored.attrs[UNKNOWN]]
    of_all = unknown[()].reshape(unknown.shape + (1,) * (stored.ndim - unknown.ndim))
    known = np.broadcast_to(of_all, stored.shape)[tuple(asked)] == 0
    return np.where(known, numbers, np.float32(np.nan))


def _values(file: "h5py.File", name: str) -> NDArray[Any]:
    """Numbers or texts along a dimension."""
    values = file[name]
    return np.array(values.asstr()[()].tolist(), dtype=np.str_) if values.dtype.kind == "O" else values[()]
