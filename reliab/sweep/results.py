"""Stored results: a Zarr store, one small NetCDF file derived from one, or the real motions that ship.

The small file keeps errors from 0.001 % to 100 %, rounded to steps of 5e-4 in their logarithm (2.5e-4
relative), and leaves the indices out; it is enough to derive criteria for any threshold, metric and
confidence. It holds the differences of these steps between neighbouring delays and gains: small whole
numbers, which compress to two thirds of the size of rounded errors.
"""

import itertools
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np
import xarray as xr

from reliab.core.errors import InputError
from reliab.core.files import decoding
from reliab.core.log_quantization import STEP
from reliab.core.shipped import is_own_data, or_shipped, shipped
from reliab.core.vocabulary import SHARE_ATTRIBUTE, Dimension, Metric
from reliab.sweep import results_accessor  # noqa: F401 - gives opened datasets the accessor `reliab`
from reliab.sweep.netcdf import quantise, read_netcdf, restore_steps, write_netcdf
from reliab.sweep.store_layout import (
    MEND,
    STORED_RULE,
    ZARR_FORMAT,
    array_of,
    open_group,
    read_attributes,
    require_readable,
)

REAL: Final = "real_suite"
"""Name of the results and ellipses of 100 real ground motions that ship."""

_SIX_STRUCTURES, _ALL_STRUCTURES = f"{REAL}/results_of_six.nc", f"{REAL}/results.nc"
_SIX: Final = ((0.5, 1.0, 2.0), (0.02, 0.05))


def real_results(f: Sequence[float] | None, xi: Sequence[float] | None) -> Path:
    """Find the results of the real motions for structures.

    `f`, `xi`: natural frequencies [Hz] and damping ratios [-]; None for all that were simulated. Returns the
    smallest file that holds them; in that of six structures errors are rounded to 1e-3. Raises InputError if
    only the file of all structures holds them, and it was not fetched.

    >>> real_results([1.0, 2.0], [0.05]).name
    'results_of_six.nc'
    """
    has_structures = all(
        values is not None and all(np.isclose(nodes, value, rtol=1e-9).any() for value in values)
        for nodes, values in zip(_SIX, (f, xi), strict=True)
    )
    return shipped("datasets", _SIX_STRUCTURES if has_structures else _ALL_STRUCTURES)


def find_results(path: Path, f: Sequence[float] | None, xi: Sequence[float] | None) -> Path:
    """Take a store of results as it is, or the results of the real motions by their name.

    `f`, `xi`: structures that are asked for [Hz, -]; None for all.
    """
    is_shipped_name = path == Path(REAL) and not is_own_data(path, _DESCRIPTION)
    return real_results(f, xi) if is_shipped_name else or_shipped(path, "datasets", "results.nc")


_DESCRIPTION = "zarr.json"
_MOTION_VARIABLES = ("motion", "event", "duration", "dt", "pga", "checksum")
_COORDINATES = ("f", "xi", "kp", "tau", *_MOTION_VARIABLES)
_ERROR_AT_REST = "rms_at_rest"
_ARRAYS = (*_COORDINATES, "rms", "mte", "A", "d", "stable")


def open_results(path: str | Path, *, window: str | None = None) -> xr.Dataset:
    """Open results that `reliab simulate` wrote.

    Parameters
    ----------
    path : str or pathlib.Path
        The Zarr store, a NetCDF file that `write_compact` derived from one, or "real_suite" for the results
        of the real motions that ship.
    window : str, optional
        One of the stored windows; the first by default.

    Returns
    -------
    xarray.Dataset
        `rms`, `mte`, `A` [-], `d` [s] and `stable` over (motion, f, xi, kp, tau), read from disk when they
        are used; from a NetCDF file only `rms` and `mte`. Of several shares of the stiffness there is the
        dimension `alpha` after `xi`; of one it is the attribute `experimental_fraction`.

    Raises
    ------
    InputError
        If there is no such store or window, or not all motions are done.
    """
    path = find_results(Path(path), None, None)
    compact = None if path.is_dir() else open_compact(path)
    with decoding(STORED_RULE, remedy=MEND, where=path):
        attributes = read_attributes(path) if compact is None else compact.attrs
        first = str(attributes["window"])
        stored_windows = np.asarray(attributes["windows" if compact is None else "window"])
        windows = [str(label) for label in np.atleast_1d(stored_windows)]
    if windows[:1] != [first]:
        raise InputError(
            STORED_RULE, value=f"windows {', '.join(windows) or 'none'}", remedy=MEND, where=str(path)
        )
    window = window or first
    if window not in windows:
        raise InputError(
            "No results for this window",
            value=f"{window!r}; the store has {', '.join(windows)}",
            remedy="Choose one of these, or simulate with that window",
        )
    if compact is not None:
        return compact
    with decoding(STORED_RULE, remedy=MEND, where=path):
        return _open_stored(path, None if window == first else f"window_{window}")


def _check_arrays(folder: Path) -> None:
    """Check that no array of a group is missing, and open each alone.

    Zarr opens them together, and prints a traceback for each beyond the first that cannot be opened.
    """
    for name in _ARRAYS:
        if not (folder / name / "zarr.json").is_file():
            raise InputError(STORED_RULE, value=f"no array {name}", remedy=MEND, where=str(folder))
    group = open_group(folder)
    for description in sorted(folder.glob("*/zarr.json")):
        _ = array_of(group, description.parent.name)


def _check_dimensions(dataset: xr.Dataset) -> None:
    """Check that every array of a group lies over the dimensions that its name promises."""
    share = (Dimension.SHARE,) if Dimension.SHARE in dataset.dims else ()
    structures = (Dimension.FREQUENCY, Dimension.DAMPING_RATIO, *share)
    actuators = (Dimension.GAIN, Dimension.DELAY)
    for name in (*_ARRAYS, *({_ERROR_AT_REST} & set(dataset))):
        dims = dataset[name].dims
        if name in actuators:
            sound = dims[-1:] == (name,) and set(dims[:-1]) <= set(structures)
        elif name in (*structures, *_MOTION_VARIABLES):
            sound = dims == (name if name in structures else Dimension.MOTION,)
        else:
            sound = dims == (Dimension.MOTION, *structures, *(() if name == _ERROR_AT_REST else actuators))
        if not sound:
            raise InputError(
                STORED_RULE, value=f"{name} over {', '.join(map(str, dims)) or 'nothing'}", remedy=MEND
            )


def _check_chunks(folder: Path) -> None:
    """Check that no chunk of a group is missing, in whose place Zarr would put NaN in silence."""
    for name, array in open_group(folder).arrays():
        present = {
            Path(place, file).relative_to(folder / name).as_posix()
            for place, _, files in os.walk(folder / name)
            for file in files
            if file != _DESCRIPTION
        }
        missing = array.nchunks - len(present)  # of a damaged description there may be any number
        if missing <= 0:
            counts = (range(-(-size // chunk)) for size, chunk in zip(array.shape, array.chunks, strict=True))
            keys = map(array.metadata.encode_chunk_key, itertools.product(*counts))
            missing = sum(key not in present for key in keys)
        if missing:
            value = f"{missing} of {array.nchunks} chunks of {name} missing"
            raise InputError(STORED_RULE, value=value, remedy=MEND, where=str(folder))


def _open_stored(path: Path, group: str | None) -> xr.Dataset:
    """Open a group of a store, with the coordinates that every store has."""
    folder = path if group is None else path / group
    _check_arrays(folder)
    dataset = xr.open_zarr(path, group=group, zarr_format=ZARR_FORMAT, consolidated=False, chunks=None)
    _check_dimensions(dataset)
    if Dimension.SHARE not in dataset.dims:
        _ = float(dataset.attrs[SHARE_ATTRIBUTE])
    _ = dataset.attrs["study_hash"], dataset.attrs["window"]
    missing = int(np.isnan(dataset["duration"].values).sum())
    if missing:
        raise InputError(
            f"{path} is not complete: {missing} motions are missing",
            remedy="Finish it with `resume`",
        )
    _check_chunks(folder)
    # Strings of fixed width are what everyone can compare, save and group by.
    texts = {
        name: ("motion", np.array(dataset[name].values.tolist()), dataset[name].attrs)
        for name in ("motion", "event", "checksum")
    }
    plain = dataset.drop_vars(["journal", *texts], errors="ignore")
    labelled_dataset: xr.Dataset = plain.assign_coords(texts).set_coords(_COORDINATES)
    for name in labelled_dataset.coords:
        variable = labelled_dataset.variables[name].load()  # small, and used where no error is explained
        if variable.dtype.kind == "f" and not np.isfinite(variable.values).all():
            raise InputError(STORED_RULE, value=f"{name} that is not finite", remedy=MEND, where=str(path))
    # A store lists its arrays in the order of its folder; whatever is derived from it would inherit that.
    return labelled_dataset[sorted(map(str, labelled_dataset.variables))]


_SMALLEST_ERROR, _LARGEST_ERROR = 1e-5, 1.0
_NEIGHBOURS = (Dimension.FREQUENCY, Dimension.GAIN, Dimension.DELAY)

_READABLE = "Results are read from a Zarr store or from the NetCDF file of one"
_CHECK_PATH = "Check the path, or simulate first"


def write_compact(results: xr.Dataset, path: str | Path, *, step: float = 5e-4) -> None:
    """Write the errors of a results dataset to one small NetCDF file.

    `step`: of the logarithm; errors are rounded by half of it at most.
    """
    variables = [*Metric, *({_ERROR_AT_REST} & set(results))]
    compact = results[variables].load()
    for metric in Metric:
        finite = np.nan_to_num(compact[metric].values, nan=_LARGEST_ERROR, posinf=_LARGEST_ERROR)
        errors = compact[metric].copy(data=np.clip(finite, _SMALLEST_ERROR, _LARGEST_ERROR))
        compact[metric] = quantise(errors, step=step, dimensions=_NEIGHBOURS)
    compact.attrs["precision"] = (
        f"errors above {_LARGEST_ERROR:g} are stored as {_LARGEST_ERROR:g} and those below "
        f"{_SMALLEST_ERROR:g} as 0; relative rounding {0.5 * step:g}"
    )
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
    dataset = read_netcdf(path, _READABLE, _CHECK_PATH)
    require_readable(dataset.attrs, path)
    if STEP in dataset.attrs:  # one for both errors, whose differences had signs
        raise InputError(
            _READABLE, value="a file of version 0.2", remedy="Fetch or make it again", where=str(path)
        )
    with decoding(_READABLE, remedy=_CHECK_PATH, where=path):
        for metric in Metric:
            if STEP in dataset[metric].attrs:
                dataset[metric] = _zero_smallest(restore_steps(dataset[metric]), dataset[metric].attrs[STEP])
        if Dimension.SHARE not in dataset.dims:
            dataset.attrs[SHARE_ATTRIBUTE] = float(dataset.attrs[SHARE_ATTRIBUTE])
    return dataset


def _zero_smallest(errors: xr.DataArray, step: float) -> xr.DataArray:
    """Read the smallest errors as zero."""
    smallest = np.exp(step * (round(np.log(_SMALLEST_ERROR) / step) + 0.5))
    return errors.where(errors > smallest, np.float32(0.0))
