"""Results of a sweep in one small NetCDF file, to be shipped or sent.

The errors are kept, up to 100 % and to eleven binary digits of mantissa (2.4e-4 relative); the indices
are left out. What remains answers every question about thresholds, metrics and confidences.
"""

from pathlib import Path

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from reliab.errors import InputError
from reliab.sweep.store import SCHEMA_VERSION
from reliab.vocabulary import Dimension, Metric

_LARGEST_ERROR = 1.0
_AT_REST = "rms_at_rest"
_DIGITS = 11  # of the 23 binary digits of a float32's mantissa


def write_compact(results: xr.Dataset, path: str | Path) -> None:
    """Write the errors of a results dataset to one small NetCDF file.

    Parameters
    ----------
    results : xarray.Dataset
        As `open_results` gives it.
    path : str or pathlib.Path
        The file, overwritten.
    """
    kept = [*Metric, *({_AT_REST} & set(results))]
    compact = results[kept].load()
    for metric in Metric:
        errors = np.nan_to_num(compact[metric].values, nan=_LARGEST_ERROR, posinf=_LARGEST_ERROR)
        compact[metric] = compact[metric].copy(data=_rounded(np.minimum(errors, _LARGEST_ERROR)))
    compact.attrs["precision"] = "errors above 1 are stored as 1; relative rounding 2.4e-4"
    sizes = compact.sizes
    chunk = tuple(1 if name == Dimension.MOTION else sizes[name] for name in compact[Metric.RMS].dims)
    encoding = {
        str(name): {"zlib": True, "complevel": 9, "shuffle": True, "chunksizes": chunk} for name in Metric
    }
    compact.to_netcdf(path, engine="h5netcdf", encoding=encoding)


def open_compact(path: Path) -> xr.Dataset:
    """Open a file that `write_compact` wrote.

    Parameters
    ----------
    path : pathlib.Path
        The file.

    Returns
    -------
    xarray.Dataset
        `rms` and `mte` over (motion, f, xi, kp, tau).

    Raises
    ------
    InputError
        If it is no such file, or of another schema version.
    """
    try:
        with xr.open_dataset(path, engine="h5netcdf") as file:
            dataset: xr.Dataset = file.load()
    except (OSError, ValueError):
        raise InputError(
            "Results are read from a Zarr store or from the NetCDF file of one",
            value=path,
            remedy="Check the path, or simulate first",
        ) from None
    if dataset.attrs.get("schema_version") != SCHEMA_VERSION:
        raise InputError(
            f"This version reads results of schema version {SCHEMA_VERSION}",
            value=f"version {dataset.attrs.get('schema_version', 'none')} in {path}",
            remedy="Simulate again, or use the version of reliab that wrote them",
        )
    dataset.attrs["experimental_fraction"] = float(dataset.attrs["experimental_fraction"])
    return dataset


def _rounded(values: NDArray[np.floating]) -> NDArray[np.float32]:
    """Round half to even at the last digit kept, in integer arithmetic on the bits."""
    dropped = 23 - _DIGITS
    bits = values.astype(np.float32).view(np.uint32)
    half = np.uint32((1 << (dropped - 1)) - 1) + ((bits >> np.uint32(dropped)) & np.uint32(1))
    return ((bits + half) & ~np.uint32((1 << dropped) - 1)).view(np.float32)
