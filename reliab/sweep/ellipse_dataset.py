"""The labelled dataset of ellipses and other curves fitted to the boundaries of many ground motions.

One row is one side of one boundary. A side has no ellipse for the reasons that
`reliab.core.vocabulary.NoEllipse` lists; a and b are then NaN, or zero where the loop's other effects alone
exceed the threshold, and the variable `no_ellipse` gives the reason. Nowhere is a or b negative or infinite.
"""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from reliab.core.arrays import Array
from reliab.core.vocabulary import ELLIPSE_DIMENSIONS, Dimension, Metric, NoEllipse, Side
from reliab.sweep.labels import with_labels
from reliab.tracking.boundary.contour import Contour
from reliab.tracking.boundary.curves import Curve, Ellipse, InscribedEllipse

COLUMNS = ("a", "b", "sse", "n", "no_ellipse")
"""Values stored for a curve; shape of a table is (motion, f, xi, threshold, metric, curve, side, columns)."""

CURVES: tuple[type[Curve], ...] = (Ellipse, InscribedEllipse)
"""Curves fitted to a boundary by default."""

_REST_DIMENSIONS = (
    Dimension.MOTION,
    Dimension.FREQUENCY,
    Dimension.DAMPING_RATIO,
    Dimension.METRIC,
)
_FEWEST_POINTS = 3


def curve_row(contour: Contour | None, curve: type[Curve]) -> list[float]:
    """Parameters of the curve fitted to one side of a boundary."""
    if contour is None:
        return _without(NoEllipse.OUTSIDE_GRID, 0)
    points = contour.amplitude.size
    if points == 0 and contour.corners.size == 0:
        return [0.0, 0.0, 0.0, 0.0, float(NoEllipse.NO_ROOM)]
    cut = contour.corners[1]
    if not issubclass(curve, InscribedEllipse) and (cut.any() or points < _FEWEST_POINTS):
        return _without(NoEllipse.NOT_REACHED, points)
    fit = curve.fit(contour)
    elliptic = not issubclass(curve, Ellipse) or (fit.a > 0.0 and fit.b > 0.0)
    if not (elliptic and np.isfinite([fit.a, fit.b, fit.sse]).all()):
        return _without(NoEllipse.NOT_ELLIPTIC, points)
    return [fit.a, fit.b, fit.sse, float(fit.n), float(NoEllipse.NOT_SO)]


def _without(reason: NoEllipse, points: int) -> list[float]:
    return [np.nan, np.nan, np.nan, float(points), float(reason)]


def curve_table(contours: Sequence[Sequence[Contour | None]], curves: Sequence[type[Curve]]) -> Array:
    """Fit curves to contours and put their parameters into one array.

    Returns shape (motion or metric, pair, curve, column), the columns those of an ellipse dataset.
    """
    rows = [[[curve_row(contour, curve) for curve in curves] for contour in row] for row in contours]
    return np.asarray(rows, dtype=np.float64)


def ellipse_dataset(
    table: Array,
    coordinates: Mapping[str, object],
    *,
    thresholds: Sequence[float],
    metrics: Sequence[Metric],
    curves: Sequence[type[Curve]],
    sides: Sequence[Side],
    attributes: Mapping[str, object],
    error_at_rest: Array | None = None,
) -> xr.Dataset:
    """Label a table of curves.

    `error_at_rest` [-].
    Returns `a` [-], `b` [ms²], `sse` [ms⁴], `n` and `no_ellipse` over (motion, f, xi, threshold, metric,
    curve, side), and `error_at_rest` [-] over (motion, f, xi, metric) where it is known.
    """
    variables: dict[str, object] = {
        column: (ELLIPSE_DIMENSIONS, table[..., k]) for k, column in enumerate(COLUMNS)
    }
    variables["n"] = (ELLIPSE_DIMENSIONS, table[..., COLUMNS.index("n")].astype(np.int32))
    reasons = table[..., COLUMNS.index("no_ellipse")].astype(np.int8)
    flags = {
        "flag_values": np.array(list(NoEllipse), dtype=np.int8),
        "flag_meanings": " ".join(flag.name.lower() for flag in NoEllipse),
    }
    variables["no_ellipse"] = (ELLIPSE_DIMENSIONS, reasons, flags)
    if error_at_rest is not None:
        variables["error_at_rest"] = (_REST_DIMENSIONS, error_at_rest)
    dataset = xr.Dataset(
        variables,
        coords={
            **coordinates,
            Dimension.THRESHOLD: list(thresholds),
            Dimension.METRIC: [str(metric) for metric in metrics],
            Dimension.CURVE: [str(curve.name) for curve in curves],
            Dimension.SIDE: [str(side) for side in sides],
        },
        attrs=dict(attributes),
    )
    return with_labels(dataset)


def share_at_rest(ellipses: xr.Dataset) -> xr.DataArray:
    """Share of the motions under which an actuator that does not move keeps the error below a threshold.

    Where it is more than a few percent the error of the whole test is no useful measure: a test in which
    nothing moved would pass. This happens at 20 % RMS^R for many structures, since RMS^R is normalised by the
    peak.

    Returns share [-] over (f, xi, threshold, metric), and over the windows where the file has several; NaN
    where the file does not hold the error at rest.

    >>> from reliab import ellipses, load_motions
    >>> traced = ellipses(load_motions("synthetic")[:2], threshold=[0.05, 0.9])
    >>> share_at_rest(traced).squeeze().values
    array([0., 1.])
    """
    if "error_at_rest" not in ellipses:
        sizes = [name for name in ("f", "xi", "threshold", "metric") if name in ellipses.dims]
        nothing = np.full([ellipses.sizes[name] for name in sizes], np.nan)
        return xr.DataArray(nothing, dims=sizes, coords={name: ellipses[name] for name in sizes})
    below = ellipses["error_at_rest"] < ellipses[Dimension.THRESHOLD]
    return below.mean(Dimension.MOTION)
