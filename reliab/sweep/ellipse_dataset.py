"""Ellipses as a labelled dataset, and the file that holds one."""

from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
import xarray as xr

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.files import refuse_unwritable, require_ending
from reliab.core.stated_value import QUANTITIES_BY_DIMENSION, RANGES, PhysicalRange
from reliab.core.vocabulary import (
    ELLIPSE_DIMENSIONS,
    SHARE_ATTRIBUTE,
    CurveName,
    Dimension,
    Metric,
    NoEllipse,
    Side,
)
from reliab.sweep.labels import label_variables
from reliab.sweep.netcdf import read_netcdf, write_netcdf
from reliab.tracking.boundary.curves import Curve, Ellipse, InscribedEllipse
from reliab.tracking.indices.window import Window

if TYPE_CHECKING:
    from reliab.tracking.boundary.contour import Contour


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


def curve_row(contour: "Contour | None", curve: type[Curve]) -> list[float]:
    """Parameters of the curve fitted to one side of a boundary."""
    if contour is None:
        return _missing_ellipse(NoEllipse.OUTSIDE_GRID, 0)
    points = contour.amplitude.size
    if points == 0 and contour.corners.size == 0:
        return [0.0, 0.0, 0.0, 0.0, float(NoEllipse.NO_ROOM)]
    cut = contour.corners[1]
    if not issubclass(curve, InscribedEllipse) and (cut.any() or points < _FEWEST_POINTS):
        return _missing_ellipse(NoEllipse.NOT_REACHED, points)
    fit = curve.fit(contour)
    elliptic = not issubclass(curve, Ellipse) or (fit.a > 0.0 and fit.b > 0.0)
    if not (elliptic and np.isfinite([fit.a, fit.b, fit.sse]).all()):
        return _missing_ellipse(NoEllipse.NOT_ELLIPTIC, points)
    return [fit.a, fit.b, fit.sse, float(fit.n), float(NoEllipse.NOT_SO)]


def _missing_ellipse(reason: NoEllipse, points: int) -> list[float]:
    return [np.nan, np.nan, np.nan, float(points), float(reason)]


def curve_table(contours: "Sequence[Sequence[Contour | None]]", curves: Sequence[type[Curve]]) -> Array:
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
    return label_variables(dataset)


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
    is_below = ellipses["error_at_rest"] < ellipses[Dimension.THRESHOLD]
    return is_below.mean(Dimension.MOTION)


_RULE = "Ellipses in NetCDF are a and b over motion, f, xi, threshold and metric"
_LENGTH = "length"
_REMEDY = "Check the path, or write the file with `reliab ellipses --out FILE.nc`"
_VARIABLES = {  # dimensions beside windows and shares, and kinds of numbers
    **dict.fromkeys(("a", "b", "sse"), (ELLIPSE_DIMENSIONS, "f")),
    **dict.fromkeys(("n", "no_ellipse"), (ELLIPSE_DIMENSIONS, "biuf")),
    "error_at_rest": (_REST_DIMENSIONS, "f"),
    **dict.fromkeys(("duration", "dt", "pga"), ((Dimension.MOTION,), "iuf")),
}


def write_ellipses(ellipses: xr.Dataset, path: str | Path) -> None:
    """Write a dataset of ellipses."""
    require_ending(path, ".nc")
    encoding = {
        str(name): {"zlib": True, "complevel": 9, "shuffle": True, "chunksizes": _chunks(variable)}
        for name, variable in ellipses.data_vars.items()
    }
    with refuse_unwritable("Cannot write the file of ellipses", where=path):
        write_netcdf(ellipses, path, encoding=encoding)


def _chunks(variable: xr.DataArray) -> tuple[int, ...]:
    """Keep what is read together in one chunk: structures, errors and sides of a hundred motions."""
    largest_chunks: dict[Hashable, int] = {
        Dimension.WINDOW: 1,
        Dimension.MOTION: 100,
        Dimension.METRIC: 1,
        Dimension.CURVE: 1,
    }
    return tuple(
        min(largest_chunks.get(name, size), size)
        for name, size in zip(variable.dims, variable.shape, strict=True)
    )


def open_ellipses(path: str | Path, *, window: str | None = None) -> xr.Dataset:
    """Read a dataset of ellipses.

    A file without curves or sides holds least-squares ellipses for delays only.

    Parameters
    ----------
    path : str or pathlib.Path
        A file that `write_ellipses` wrote.
    window : str, optional
        Part of the record over which the errors were computed: "record", "arias" or a number of seconds; by
        default the only window of the file, or else the whole record.

    Returns
    -------
    xarray.Dataset
        `a` [-], `b` [ms²], `sse` [ms⁴], `n` (not of the motions that ship) and, of this version,
        `no_ellipse` over (motion, f, xi, threshold, metric, curve, side) and `error_at_rest`; the attribute
        `window` names the window.

    Raises
    ------
    InputError
        If the file is not a file of ellipses, or does not hold the window.
    """
    return _select_window(_read(path, lambda dataset: _up_to(dataset, window)), window, path)


def open_windows(path: str | Path) -> dict[str, xr.Dataset]:
    """Read a dataset of ellipses in each of its windows.

    `path`: a file that `write_ellipses` wrote. Returns for each window ("record", "arias" or a number of
    seconds) the dataset that `open_ellipses` returns. Raises InputError if the file holds no ellipses.
    """
    dataset = _read(path)
    return {window: _select_window(dataset, window, path) for window in _windows(dataset)}


def _up_to(dataset: xr.Dataset, window: str | None) -> xr.Dataset:
    """Take the windows of a file up to the one that is asked for; all where it is not among them."""
    windows = _windows(dataset)
    label = window or Window().label
    if Dimension.WINDOW not in dataset.dims or label not in windows:
        return dataset
    return dataset.isel({Dimension.WINDOW: slice(windows.index(label) + 1)})


def _read(path: str | Path, select: Callable[[xr.Dataset], xr.Dataset] = xr.Dataset.copy) -> xr.Dataset:
    dataset = read_netcdf(path, _RULE, _REMEDY, select)
    required_dimensions = set(ELLIPSE_DIMENSIONS) - {Dimension.CURVE, Dimension.SIDE}
    if not required_dimensions <= set(dataset.dims) or not {"a", "b"} <= set(dataset):
        raise InputError(
            _RULE, value=", ".join(map(str, dataset.dims)) or "none", remedy=_REMEDY, where=str(path)
        )
    sound = add_sides(dataset)
    _check_schema(sound, path)
    return sound


def _check_schema(dataset: xr.Dataset, path: str | Path) -> None:
    """Check dimensions, coordinates and attributes once, so that nothing that uses ellipses needs to."""
    extra_dimensions = {Dimension.WINDOW, Dimension.SHARE} & set(dataset.dims)
    faults = [
        f"{name} over {', '.join(map(str, dataset[name].dims))}"
        for name, (dimensions, kinds) in _VARIABLES.items()
        if name in dataset.variables
        and (
            set(dataset[name].dims) != {*dimensions, *(extra_dimensions if name in dataset.data_vars else ())}
            or dataset[name].dtype.kind not in kinds
        )
    ]
    for name in (*ELLIPSE_DIMENSIONS, *extra_dimensions):
        index = dataset.indexes.get(name, pd.Index([]))
        limits = RANGES.get(QUANTITIES_BY_DIMENSION.get(name, ""))
        sound = _are_texts(index) if limits is None else _are_in_range(index, limits)
        if index.empty or not index.is_unique or not sound:
            faults.append(f"no sound values along {name}")
    event = dataset.variables.get("event")
    if event is None or event.dims != (Dimension.MOTION,) or not _are_texts(event.values):
        faults.append("no event, the earthquake of each motion")
    share = dataset.attrs.get(SHARE_ATTRIBUTE, 1.0)
    if not (isinstance(share, int | float | np.number) and 0.0 < share <= 1.0):
        faults.append(f"{SHARE_ATTRIBUTE} = {share!r}")
    if faults:
        raise InputError(_RULE, value="; ".join(faults), remedy=_REMEDY, where=str(path))


def _are_texts(values: Iterable[object]) -> bool:
    return all(isinstance(value, str) for value in values)


def _are_in_range(index: "pd.Index[Any]", limits: PhysicalRange) -> bool:
    return index.dtype.kind in "if" and bool(np.all(limits.includes(index)))


def _windows(dataset: xr.Dataset) -> tuple[str, ...]:
    if Dimension.WINDOW in dataset.dims:
        return tuple(str(label) for label in dataset[Dimension.WINDOW].values)
    return (str(dataset.attrs.get("window", Window().label)),)


def add_sides(dataset: xr.Dataset) -> xr.Dataset:
    """Add the dimensions curve and side to ellipses without them: least squares, and delays."""
    for name, value in ((Dimension.CURVE, CurveName.ELLIPSE), (Dimension.SIDE, Side.LAG)):
        if name not in dataset.dims:
            names = [str(variable) for variable in dataset if Dimension.THRESHOLD in dataset[variable].dims]
            wider = dataset[names].expand_dims({str(name): [str(value)]}, axis=-1)
            dataset = dataset.drop_vars([*names, str(name)], errors="ignore").merge(wider)
    return label_variables(dataset)


def _select_window(dataset: xr.Dataset, window: str | None, path: str | Path) -> xr.Dataset:
    """Choose one of the windows of a file."""
    windows = _windows(dataset)
    label = window or (Window().label if Window().label in windows else windows[0])
    if label not in windows:
        raise InputError(
            "No ellipses for this window",
            value=f"{label!r}; the file has {', '.join(windows)}",
            remedy="Choose one of these, or trace the boundaries in that window",
            where=str(path),
        )
    if Dimension.WINDOW in dataset.dims:
        dataset = dataset.isel({Dimension.WINDOW: windows.index(label)}, drop=True)
    if label != Window().label:
        dataset = dataset.drop_dims(_LENGTH, errors="ignore")  # ratios are those of whole records
    return dataset.assign_attrs(window=label)
