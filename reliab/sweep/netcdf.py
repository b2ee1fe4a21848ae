"""Reading and writing NetCDF files; damaged files and full disks give an error for the user."""

from collections.abc import Hashable, Mapping
from pathlib import Path

import h5py
import xarray as xr

from reliab.errors import InputError
from reliab.files import decoding, written_whole
from reliab.received import objects_of, opened_hdf5
from reliab.significant import significant
from reliab.sweep.packing import unpacked

_MOST_EXPANSION = 1032
"""Bytes that one byte of a file can stand for: the limit of DEFLATE, by which NetCDF files are compressed."""


def read_netcdf(path: str | Path, rule: str, remedy: str) -> xr.Dataset:
    """Read a NetCDF file.

    `rule`: rule that the file must fulfil, for the error message; `remedy`: remedy, for the error message.
    Returns contents of the file, in memory; of what is stored in steps of the logarithm the numbers. Raises
    InputError if it cannot be read.
    """
    with decoding(rule, remedy=remedy, where=path):
        with opened_hdf5(path) as file:
            _refuse_empty_promises(sum(_size(item) for _, item in objects_of(file)), Path(path))
        with xr.open_dataset(path, engine="h5netcdf") as file:
            return unpacked(file.load())


def write_netcdf(
    dataset: xr.Dataset | xr.DataArray,
    path: str | Path,
    *,
    encoding: Mapping[str, Mapping[str, object]] | None = None,
) -> None:
    """Write a NetCDF file as a whole.

    The file is made in memory: HDF5 that writes to a disk notices only when it closes the file that the disk
    is full, and an error there is lost.

    `path`: the file, replaced if it is there; `encoding`: how each variable is stored, as of
    `xarray.Dataset.to_netcdf`. Raises OSError if it cannot be written; the file of before stays.
    """
    stored: dict[Hashable, Mapping[str, object]] = {}
    stored.update(encoding or {})
    with written_whole(path) as file:
        file.write_bytes(dataset.to_netcdf(engine="h5netcdf", encoding=stored))


def _size(item: h5py.HLObject) -> int:
    """Bytes of a part of a file in memory; h5netcdf would print a traceback over a damaged description."""
    dict(item.attrs)
    return int(item.nbytes) if isinstance(item, h5py.Dataset) else 0


def _refuse_empty_promises(promised: int, path: Path) -> None:
    """Refuse a file that declares more numbers than it can hold, before they fill the memory."""
    size = path.stat().st_size
    if promised > _MOST_EXPANSION * size:
        raise InputError(
            "A NetCDF file must hold the numbers that it declares, at most "
            f"{_MOST_EXPANSION} bytes in each byte of its own",
            value=f"{significant(promised)} bytes declared in {size}",
            remedy="Obtain the file again",
            where=str(path),
        )
