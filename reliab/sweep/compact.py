"""Results of a sweep in one small NetCDF file.

The errors are kept from 0.001 % to 100 %, rounded to steps of 5e-4 in their logarithm (2.5e-4 relative); the
indices are left out. The file is enough to derive criteria for any threshold, metric and confidence. The file
holds the differences of these steps between neighbouring delays and gains: small whole numbers, which
compress to two thirds of the size of rounded errors.
"""

from pathlib import Path

import numpy as np
import xarray as xr

from reliab.errors import InputError
from reliab.files import decoding
from reliab.sweep.netcdf import read_netcdf, write_netcdf
from reliab.sweep.store_layout import SCHEMA_VERSION
from reliab.vocabulary import SHARE_ATTRIBUTE, Dimension, Metric

_SMALLEST_ERROR, _LARGEST_ERROR = 1e-5, 1.0
_AT_REST = "rms_at_rest"
_STEP = 5e-4  # of the logarithm
_CODED = "step_of_logarithm"
_NEIGHBOURS = (Dimension.GAIN, Dimension.DELAY)

_RULE = "Results are read from a Zarr store or from the NetCDF file of one"
_REMEDY = "Check the path, or simulate first"


def write_compact(results: xr.Dataset, path: str | Path) -> None:
    """Write the errors of a results dataset to one small NetCDF file.

    Parameters
    ----------
    results : xarray.Dataset
        As returned by `open_results`.
    path : str or pathlib.Path
        The file, overwritten.
    """
    kept = [*Metric, *({_AT_REST} & set(results))]
    compact = results[kept].load()
    for metric in Metric:
        compact[metric] = _coded(compact[metric])
    compact.attrs["precision"] = (
        f"errors above {_LARGEST_ERROR:g} are stored as {_LARGEST_ERROR:g} and those below "
        f"{_SMALLEST_ERROR:g} as 0; relative rounding {0.5 * _STEP:g}"
    )
    compact.attrs[_CODED] = _STEP
    sizes = compact.sizes
    chunk = tuple(1 if name == Dimension.MOTION else sizes[name] for name in compact[Metric.RMS].dims)
    encoding = {
        str(name): {"zlib": True, "complevel": 9, "shuffle": True, "chunksizes": chunk} for name in Metric
    }
    write_netcdf(compact, path, encoding=encoding)


def open_compact(path: Path) -> xr.Dataset:
    """Open a file that `write_compact` wrote.

    Returns `rms` and `mte` over (motion, f, xi, kp, tau), or (motion, f, xi, alpha, kp, tau).
    """
    dataset = read_netcdf(path, _RULE, _REMEDY)
    if dataset.attrs.get("schema_version") != SCHEMA_VERSION:
        raise InputError(
            f"This version reads results of schema version {SCHEMA_VERSION}",
            value=f"version {dataset.attrs.get('schema_version', 'none')} in {path}",
            remedy="Simulate again, or use the version of reliab that wrote them",
        )
    with decoding(_RULE, remedy=_REMEDY, where=path):
        if _CODED in dataset.attrs:
            step = float(dataset.attrs.pop(_CODED))
            for metric in Metric:
                dataset[metric] = _decoded(dataset[metric], step)
        if Dimension.SHARE not in dataset.dims:
            dataset.attrs[SHARE_ATTRIBUTE] = float(dataset.attrs[SHARE_ATTRIBUTE])
    return dataset


def _coded(errors: xr.DataArray) -> xr.DataArray:
    """Write errors as differences of whole steps of their logarithm between neighbours."""
    known = np.nan_to_num(errors.values.astype(np.float64), nan=_LARGEST_ERROR, posinf=_LARGEST_ERROR)
    steps = np.round(np.log(np.clip(known, _SMALLEST_ERROR, _LARGEST_ERROR)) / _STEP).astype(np.int32)
    for name in _NEIGHBOURS:
        steps = np.diff(steps, axis=errors.get_axis_num(name), prepend=np.int32(0))
    return errors.copy(data=steps)


def _decoded(steps: xr.DataArray, step: float) -> xr.DataArray:
    """Read errors that :func:`_coded` wrote."""
    whole = steps.values.astype(np.int64)
    for name in _NEIGHBOURS:
        whole = np.cumsum(whole, axis=steps.get_axis_num(name))
    smallest = round(np.log(_SMALLEST_ERROR) / step)
    errors = np.where(whole <= smallest, 0.0, np.exp(step * whole)).astype(np.float32)
    return steps.copy(data=errors)
