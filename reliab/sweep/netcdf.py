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
from reliab.core.untrusted_files import objects_of, opened_hdf5


def packed(
    dataset: xr.Dataset, names: Sequence[str], *, step: float, along: Sequence[str], unknown: str
) -> xr.Dataset:
    """Round variables to steps of their logarithm, for a small file that :func:`read_netcdf` reads.

    `names`: the variables, positive; `step`: of the natural logarithm; `along`: dimensions along which
    neighbours resemble each other; `unknown`: variable of the dataset that is not zero where they have no
    value. Returns the dataset with whole numbers in their place.
    """
    stored = {
        name: stepped(dataset[name], step=step, along=along).assign_attrs({UNKNOWN: unknown})
        for name in names
    }
    return dataset.assign(stored)


def stepped(values: xr.DataArray, *, step: float, along: Sequence[str]) -> xr.DataArray:
    """Round positive numbers to steps of their logarithm, told by differences along dimensions.

    The attributes of what is returned say how, in place of those of the numbers with these names.
    """
    axes = [values.get_axis_num(name) for name in along]
    steps = to_steps(values.values.astype(np.float64), step, axes)
    return values.copy(data=steps).assign_attrs({STEP: step, NEIGHBOURS: " ".join(along)})


def numbered(stored: xr.DataArray) -> xr.DataArray:
    """Read what :func:`stepped` rounded."""
    names = [str(name) for name in stored.dims]
    numbers = stored.copy(data=numbers_of(stored.values, stored.attrs, names))
    numbers.attrs = {name: value for name, value in stored.attrs.items() if name not in {STEP, NEIGHBOURS}}
    return numbers


def unpacked(dataset: xr.Dataset) -> xr.Dataset:
    """Read what :func:`packed` rounded; other variables stay."""
    return dataset.assign(
        {name: _numbers(dataset, str(name)) for name in dataset if UNKNOWN in dataset[name].attrs}
    )


def _numbers(dataset: xr.Dataset, name: str) -> xr.DataArray:
    numbers = numbered(dataset[name])
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
        with opened_hdf5(path) as file:
            declared = sum(_size(item) for _, item in objects_of(file))
            _refuse_empty_promises(declared, Path(path))
            LIMITS["dataset"].require_few_numbers(declared, path)
        with xr.open_dataset(path, engine="h5netcdf") as file:
            return unpacked(select(file).load())


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
            remedy="Export or download the file again",
            where=str(path),
        )
