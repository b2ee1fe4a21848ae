"""Reading and writing NetCDF files; damaged files and full disks give an error for the user.

Variables of files that ship stand there in whole steps of their logarithm.
"""

from collections.abc import Callable, Hashable, Mapping, Sequence
from pathlib import Path

import h5py
import numpy as np
import xarray as xr

from reliab.core.errors import InputError
from reliab.core.files import LIMITS, decoding, ordinary, written_whole
from reliab.core.log_quantization import NEIGHBOURS, STEP, UNKNOWN, numbers_of, to_steps
from reliab.core.significant_digits import significant
from reliab.core.untrusted_files import objects_of, open_hdf5


def pack(
    dataset: xr.Dataset, names: Sequence[str], *, step: float, dimensions: Sequence[str], unknown: str
) -> xr.Dataset:
    """Round variables to steps of their logarithm, for a small file that :func:`read_netcdf` reads.

    `names`: the variables, positive; `step`: of the natural logarithm; `dimensions`: dimensions along which
    neighbours resemble each other; `unknown`: variable of the dataset that is not zero where they have no
    value. Returns the dataset with whole numbers in their place.
    """
    packed_variables = {
        name: quantise(dataset[name], step=step, dimensions=dimensions).assign_attrs({UNKNOWN: unknown})
        for name in names
    }
    return dataset.assign(packed_variables)


def quantise(values: xr.DataArray, *, step: float, dimensions: Sequence[str]) -> xr.DataArray:
    """Round positive numbers to steps of their logarithm, told by differences along dimensions.

    The attributes of what is returned say how, in place of those of the numbers with these names.
    """
    axes = [values.get_axis_num(name) for name in dimensions]
    steps = to_steps(values.values.astype(np.float64), step, axes)
    return values.copy(data=steps).assign_attrs({STEP: step, NEIGHBOURS: " ".join(dimensions)})


def restore_steps(steps: xr.DataArray) -> xr.DataArray:
    """Read what :func:`quantise` rounded."""
    names = [str(name) for name in steps.dims]
    numbers = steps.copy(data=numbers_of(steps.values, steps.attrs, names))
    numbers.attrs = {name: value for name, value in steps.attrs.items() if name not in {STEP, NEIGHBOURS}}
    return numbers


def unpack(dataset: xr.Dataset) -> xr.Dataset:
    """Read what :func:`pack` rounded; other variables stay."""
    return dataset.assign(
        {name: _numbers(dataset, str(name)) for name in dataset if UNKNOWN in dataset[name].attrs}
    )


def _numbers(dataset: xr.Dataset, name: str) -> xr.DataArray:
    numbers = restore_steps(dataset[name])
    unknown = dataset[numbers.attrs.pop(UNKNOWN)]
    return numbers.where(unknown == 0).transpose(*numbers.dims)


_MOST_EXPANSION = 1032
"""Bytes that one byte of a file can stand for: the limit of DEFLATE, by which NetCDF files are compressed."""


def read_netcdf(
    path: str | Path, rule: str, remedy: str, select: Callable[[xr.Dataset], xr.Dataset] = xr.Dataset.copy
) -> xr.Dataset:
    """Read a NetCDF file.

    `rule`: rule that the file must fulfil, for the error message; `remedy`: remedy, for the error message;
    `select`: takes what is needed of the file, from the first on along dimensions of differences.
    Returns contents of the file, in memory; of what is stored in steps of the logarithm the numbers. Raises
    InputError if it cannot be read.
    """
    with decoding(rule, remedy=remedy, where=path):
        LIMITS["dataset"].require_small(ordinary(path))
        with open_hdf5(path) as file:
            declared_size = sum(_size(item) for _, item in objects_of(file))
            size = Path(path).stat().st_size
            if declared_size > _MOST_EXPANSION * size:
                raise InputError(
                    "A NetCDF file must hold the numbers that it declares, at most "
                    f"{_MOST_EXPANSION} bytes in each byte of its own",
                    value=f"{significant(declared_size)} bytes declared in {size}",
                    remedy="Export or download the file again",
                    where=str(Path(path)),
                )
            LIMITS["dataset"].require_few_numbers(declared_size, path)
        with xr.open_dataset(path, engine="h5netcdf") as file:
            return unpack(select(file).load())


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
    encodings: dict[Hashable, Mapping[str, object]] = {}
    encodings.update(encoding or {})
    with written_whole(path) as file:
        file.write_bytes(dataset.to_netcdf(engine="h5netcdf", encoding=encodings))


def _size(item: h5py.HLObject) -> int:
    """Bytes of a part of a file in memory; h5netcdf would print a traceback over a damaged description."""
    dict(item.attrs)
    return int(item.nbytes) if isinstance(item, h5py.Dataset) else 0
