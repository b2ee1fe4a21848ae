"""Reading NetCDF files; damaged files give an error for the user."""

from pathlib import Path

import h5py
import xarray as xr

from reliab.files import decoding, ordinary


def read_netcdf(path: str | Path, rule: str, remedy: str) -> xr.Dataset:
    """Read a whole NetCDF file.

    Parameters
    ----------
    path : str or pathlib.Path
        The file.
    rule : str
        Rule that the file must fulfil, for the error message.
    remedy : str
        Remedy, for the error message.

    Returns
    -------
    xarray.Dataset
        Contents of the file, in memory.

    Raises
    ------
    InputError
        If it cannot be read.
    """
    with decoding(rule, remedy=remedy, where=path):
        with h5py.File(ordinary(path), "r") as file:
            file.visititems(lambda _name, item: _look_at(item))
        with xr.open_dataset(path, engine="h5netcdf") as file:
            return file.load()


def _look_at(item: h5py.HLObject) -> None:
    """Read the description of a part of a file; h5netcdf would print a traceback where this fails."""
    dict(item.attrs)
