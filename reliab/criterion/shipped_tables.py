"""The ellipses of 100 real motions that ship, and measures of the responses to them, in plain arrays."""

from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from reliab.criterion.ellipse_table import DIMENSIONS, REST, EllipseTable, words_of
from reliab.criterion.response_measures import BoundaryScales, ResponseMeasures
from reliab.files import decoding
from reliab.received import opened_hdf5
from reliab.shipped import shipped
from reliab.vocabulary import SHARE_ATTRIBUTE

if TYPE_CHECKING:
    import h5py

_ELLIPSES, _MEASURES = "real_suite/ellipses.nc", "real_suite/first_order.nc"
_REMEDY = "Install the package again"


@cache
def shipped_ellipses(curve: str) -> dict[str, EllipseTable]:
    """Ellipses of one kind that ship, for each window over which errors were computed."""
    path = shipped("datasets", _ELLIPSES)
    with decoding("Ellipses must be a NetCDF file", remedy=_REMEDY, where=path), opened_hdf5(path) as file:
        at = {name: _values(file, name) for name in DIMENSIONS}
        place = at["curve"].tolist().index(curve)
        at["curve"] = at["curve"][place : place + 1]
        pair = {name: file[name][..., place : place + 1, :] for name in ("a", "b")}
        rest, windows = file[REST][()], _values(file, "window")
        of_motions = {name: _values(file, name) for name in ("event", "duration", "checksum")}
        share = float(file.attrs[SHARE_ATTRIBUTE][0])
    return {
        str(window): EllipseTable(
            **{name: values[k] for name, values in pair.items()},
            at=at,
            of_motions=of_motions,
            error_at_rest=rest[k],
            attrs={SHARE_ATTRIBUTE: share, "window": str(window)},
            words=words_of(),
        )
        for k, window in enumerate(windows)
    }


@cache
def shipped_measures() -> ResponseMeasures:
    """Measures of the responses to the motions of the ellipses that ship."""
    path = shipped("datasets", _MEASURES)
    rule = "Measures of responses must be a NetCDF file"
    with decoding(rule, remedy=_REMEDY, where=path), opened_hdf5(path) as file:
        return ResponseMeasures(
            **{name: file[name][()] for name in ("a_first", "b_first", "effective_duration", "duration")},
            motions=_values(file, "motion"),
            frequencies=file["f"][()],
            damping_ratios=file["xi"][()],
            scales=BoundaryScales(
                least=file["scale"][()],
                towards=file["scale_towards"][()],
                thresholds=file["threshold"][()],
                sides=_values(file, "side").tolist(),
            ),
        )


def _values(file: "h5py.File", name: str) -> NDArray[Any]:
    """Numbers or texts along a dimension."""
    values = file[name]
    return np.array(values.asstr()[()].tolist(), dtype=np.str_) if values.dtype.kind == "O" else values[()]
