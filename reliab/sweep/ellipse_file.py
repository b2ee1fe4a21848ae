"""Ellipses of many ground motions in a NetCDF file."""

from pathlib import Path

import xarray as xr

from reliab.errors import InputError
from reliab.vocabulary import ELLIPSE_DIMENSIONS


def write_ellipses(ellipses: xr.Dataset, path: str | Path) -> None:
    """Write a dataset of ellipses.

    Parameters
    ----------
    ellipses : xarray.Dataset
        As `trace_ellipses` makes it.
    path : str or pathlib.Path
        The NetCDF file, overwritten.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    encoding = {str(name): {"zlib": True, "complevel": 9} for name in ellipses.data_vars}
    try:
        ellipses.to_netcdf(path, engine="h5netcdf", encoding=encoding)
    except OSError as error:
        raise InputError(
            "The file of ellipses must be writable",
            value=error.strerror,
            remedy="Name another file",
            where=str(path),
        ) from None


def open_ellipses(path: str | Path) -> xr.Dataset:
    """Read a dataset of ellipses.

    Parameters
    ----------
    path : str or pathlib.Path
        A file that `write_ellipses` wrote.

    Returns
    -------
    xarray.Dataset
        `a` [-], `b` [ms²], `sse` [ms⁴] and `n` over (motion, f, xi, threshold, metric, curve).

    Raises
    ------
    InputError
        If it is no such file.
    """
    try:
        with xr.open_dataset(path, engine="h5netcdf") as file:
            dataset: xr.Dataset = file.load()
    except (OSError, ValueError):
        dataset = xr.Dataset()
    if not set(ELLIPSE_DIMENSIONS) <= set(dataset.dims) or not {"a", "b"} <= set(dataset):
        raise InputError(
            "Ellipses in NetCDF are a and b over motion, f, xi, threshold, metric and curve",
            value=path,
            remedy="Check the path, or write the file with `reliab ellipses --out FILE.nc`",
        )
    return dataset
