"""HDF5 files, among them NetCDF 4 and MATLAB 7.3, and classic NetCDF files."""

from pathlib import Path

import numpy as np
import scipy

from reliab.received import objects_of, opened_hdf5
from reliab.recordings.readers.arrays import columns_of_arrays
from reliab.recordings.readers.columns import Columns
from reliab.recordings.recording import require_few_samples


def read_hierarchical(path: Path) -> Columns:
    """Read the numeric datasets of an HDF5 file in all its groups.

    Returns vectors by name, those of a group as ``group.name``; units from the attribute `units`, single
    numbers also from the file's own attributes.
    """
    import h5py

    arrays: dict[str, np.ndarray] = {}
    units: dict[str, str] = {}

    with opened_hdf5(path) as file:
        arrays |= {name: np.asarray(value) for name, value in file.attrs.items() if np.ndim(value) == 0}
        for name, item in objects_of(file):
            label = name.replace("/", ".")
            if isinstance(item, h5py.Dataset) and not name.startswith("#"):
                require_few_samples(max(item.shape, default=0), f"{path.name}, {label}")
                arrays[label] = np.asarray(item[()])
                if "units" in item.attrs:
                    units[label] = _text(item.attrs["units"])
    return columns_of_arrays(path, arrays, units)


def read_classic_netcdf(path: Path) -> Columns:
    """Read the variables of a classic NetCDF file, as :func:`read_hierarchical` does."""
    with scipy.io.netcdf_file(path, "r", mmap=False) as file:
        variables = dict(file.variables)
        arrays = {name: np.array(variable[()]) for name, variable in variables.items()}
        units = {
            name: _text(variable.units) for name, variable in variables.items() if hasattr(variable, "units")
        }
    return columns_of_arrays(path, arrays, units)


def _text(value: object) -> str:
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)
