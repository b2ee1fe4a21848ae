"""The ellipses of 100 real motions that ship, and measures of the responses to them, in plain arrays."""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from reliab.criterion.ellipse_table import DIMENSIONS, REST, EllipseTable, words_of
from reliab.criterion.response_measures import BoundaryScales, ResponseMeasures
from reliab.files import decoding
from reliab.received import opened_hdf5
from reliab.shipped import shipped
from reliab.steps_of_logarithm import NEIGHBOURS, STEP, UNKNOWN, from_steps
from reliab.vocabulary import SHARE_ATTRIBUTE

if TYPE_CHECKING:
    import h5py

_ELLIPSES, _MEASURES = "real_suite/ellipses.nc", "real_suite/first_order.nc"


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
        part = np.s_[k : k + 1, ..., place : place + 1, :]
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
                least=file["scale"][()],
                towards=_numbers(file, "scale_towards", (...,)),
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


def _numbers(file: "h5py.File", name: str, part: tuple[Any, ...]) -> NDArray[Any]:
    """Read a part, whole along the neighbours, of numbers that are stored in steps of their logarithm."""
    stored = file[name]
    dimensions = [str(scale[0].name).rpartition("/")[2] for scale in stored.dims]
    axes = [dimensions.index(dimension) for dimension in stored.attrs[NEIGHBOURS].split()]
    numbers = from_steps(stored[part], float(np.ravel(stored.attrs[STEP])[0]), axes)
    unknown = file[stored.attrs[UNKNOWN]]
    of_all = unknown[()].reshape(unknown.shape + (1,) * (stored.ndim - unknown.ndim))
    return np.where(np.broadcast_to(of_all, stored.shape)[part] == 0, numbers, np.float32(np.nan))


def _values(file: "h5py.File", name: str) -> NDArray[Any]:
    """Numbers or texts along a dimension."""
    values = file[name]
    return np.array(values.asstr()[()].tolist(), dtype=np.str_) if values.dtype.kind == "O" else values[()]
