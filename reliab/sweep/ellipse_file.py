"""Ellipses of many ground motions in a NetCDF file."""

from pathlib import Path

import xarray as xr

from reliab.errors import InputError
from reliab.indices.window import Window
from reliab.sweep.labels import with_labels
from reliab.sweep.netcdf import read_netcdf, write_netcdf
from reliab.vocabulary import ELLIPSE_DIMENSIONS, CurveName, Dimension, Side

_RULE = "Ellipses in NetCDF are a and b over motion, f, xi, threshold and metric"
_REMEDY = "Check the path, or write the file with `reliab ellipses --out FILE.nc`"


def write_ellipses(ellipses: xr.Dataset, path: str | Path) -> None:
    """Write a dataset of ellipses.

    Parameters
    ----------
    ellipses : xarray.Dataset
        As returned by `trace_ellipses`.
    path : str or pathlib.Path
        The NetCDF file, overwritten.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    encoding = {str(name): {"zlib": True, "complevel": 9, "shuffle": True} for name in ellipses.data_vars}
    try:
        write_netcdf(ellipses, path, encoding=encoding)
    except OSError as error:
        raise InputError(
            "The file of ellipses must be writable",
            value=error.strerror,
            remedy="Name another file",
            where=str(path),
        ) from None


def open_ellipses(path: str | Path, *, window: str | None = None) -> xr.Dataset:
    """Read a dataset of ellipses.

    A file of an older version, without curves or sides, holds least-squares ellipses for delays only.

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
        `a` [-], `b` [ms²], `sse` [ms⁴], `n` and, of this version, `no_ellipse` over (motion, f, xi,
        threshold, metric, curve, side) and `error_at_rest`; the attribute `window` names the window.

    Raises
    ------
    InputError
        If the file is not a file of ellipses, or does not hold the window.
    """
    return _in_window(_read(path), window, path)


def open_windows(path: str | Path) -> dict[str, xr.Dataset]:
    """Read a dataset of ellipses in each of its windows.

    Parameters
    ----------
    path : str or pathlib.Path
        A file that `write_ellipses` wrote.

    Returns
    -------
    dict of str to xarray.Dataset
        For each window ("record", "arias" or a number of seconds) the dataset that `open_ellipses` returns.

    Raises
    ------
    InputError
        If the file is not a file of ellipses.
    """
    dataset = _read(path)
    return {window: _in_window(dataset, window, path) for window in _windows(dataset)}


def _read(path: str | Path) -> xr.Dataset:
    dataset = read_netcdf(path, _RULE, _REMEDY)
    needed = set(ELLIPSE_DIMENSIONS) - {Dimension.CURVE, Dimension.SIDE}
    if not needed <= set(dataset.dims) or not {"a", "b"} <= set(dataset):
        raise InputError(
            _RULE, value=", ".join(map(str, dataset.dims)) or "none", remedy=_REMEDY, where=str(path)
        )
    return with_sides(dataset)


def _windows(dataset: xr.Dataset) -> tuple[str, ...]:
    if Dimension.WINDOW in dataset.dims:
        return tuple(str(label) for label in dataset[Dimension.WINDOW].values)
    return (str(dataset.attrs.get("window", Window().label)),)


def with_sides(dataset: xr.Dataset) -> xr.Dataset:
    """Add the dimensions curve and side to ellipses without them: least squares, and delays.

    Parameters
    ----------
    dataset : xarray.Dataset
        `a` and `b` over (motion, f, xi, threshold, metric) and perhaps (curve, side).

    Returns
    -------
    xarray.Dataset
        The same over all dimensions of ellipses.
    """
    for name, value in ((Dimension.CURVE, CurveName.ELLIPSE), (Dimension.SIDE, Side.LAG)):
        if name not in dataset.dims:
            within = [str(variable) for variable in dataset if Dimension.THRESHOLD in dataset[variable].dims]
            wider = dataset[within].expand_dims({str(name): [str(value)]}, axis=-1)
            dataset = dataset.drop_vars([*within, str(name)], errors="ignore").merge(wider)
    return with_labels(dataset)


def _in_window(dataset: xr.Dataset, window: str | None, path: str | Path) -> xr.Dataset:
    """Choose one of the windows of a file."""
    stored = _windows(dataset)
    chosen = window or (Window().label if Window().label in stored else stored[0])
    if chosen not in stored:
        raise InputError(
            "The window must be one for which there are ellipses",
            value=f"{chosen!r}, there are {', '.join(stored)}",
            remedy="Choose one of these, or trace the boundaries in that window",
            where=str(path),
        )
    if Dimension.WINDOW in dataset.dims:
        dataset = dataset.isel({Dimension.WINDOW: stored.index(chosen)}, drop=True)
    return dataset.assign_attrs(window=chosen)
