"""Opening stored results: a Zarr store, or a NetCDF file derived from one."""

import os
import re
from pathlib import Path

import numpy as np
import xarray as xr

from reliab.errors import InputError
from reliab.files import decoding
from reliab.sweep import results_accessor  # noqa: F401 - gives opened datasets the accessor `reliab`
from reliab.sweep.compact import open_compact
from reliab.sweep.real_suite import stored_results
from reliab.sweep.store_layout import MEND, STORED, ZARR_FORMAT, array_of, open_group, read_attributes
from reliab.vocabulary import SHARE_ATTRIBUTE, Dimension

_CHUNK = re.compile(r"(c\.)?\d+(\.\d+)*")  # file of one chunk, in either layout
_OF_MOTIONS = ("motion", "event", "duration", "dt", "pga", "checksum")
_COORDINATES = ("f", "xi", "kp", "tau", *_OF_MOTIONS)
_AT_REST = "rms_at_rest"
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
    path = stored_results(Path(path), None, None)
    compact = None if path.is_dir() else open_compact(path)
    with decoding(STORED, remedy=MEND, where=path):
        attributes = read_attributes(path) if compact is None else compact.attrs
        first = str(attributes["window"])
        stored = np.asarray(attributes["windows" if compact is None else "window"])
        windows = [str(label) for label in np.atleast_1d(stored)]
    if windows[:1] != [first]:
        raise InputError(
            STORED, value=f"windows {', '.join(windows) or 'none'}", remedy=MEND, where=str(path)
        )
    window = window or first
    if window not in windows:
        raise InputError(
            "The window must be one that was stored",
            value=f"{window!r}, stored are {', '.join(windows)}",
            remedy="Choose one of these, or simulate with that window",
        )
    if compact is not None:
        return compact
    with decoding(STORED, remedy=MEND, where=path):
        return _stored(path, None if window == first else f"window_{window}")


def _check_arrays(folder: Path) -> None:
    """Check that no array of a group is missing, and open each alone.

    Zarr opens them together, and prints a traceback for each beyond the first that cannot be opened.
    """
    for name in _ARRAYS:
        if not (folder / name / "zarr.json").is_file():
            raise InputError(STORED, value=f"no array {name}", remedy=MEND, where=str(folder))
    group = open_group(folder)
    for description in sorted(folder.glob("*/zarr.json")):
        _ = array_of(group, description.parent.name)


def _check_dimensions(dataset: xr.Dataset) -> None:
    """Check that every array of a group lies over the dimensions that its name promises."""
    share = (Dimension.SHARE,) if Dimension.SHARE in dataset.dims else ()
    structures = (Dimension.FREQUENCY, Dimension.DAMPING_RATIO, *share)
    actuators = (Dimension.GAIN, Dimension.DELAY)
    for name in (*_ARRAYS, *({_AT_REST} & set(dataset))):
        dims = dataset[name].dims
        if name in actuators:
            sound = dims[-1:] == (name,) and set(dims[:-1]) <= set(structures)
        elif name in (*structures, *_OF_MOTIONS):
            sound = dims == (name if name in structures else Dimension.MOTION,)
        else:
            sound = dims == (Dimension.MOTION, *structures, *(() if name == _AT_REST else actuators))
        if not sound:
            raise InputError(
                STORED, value=f"{name} over {', '.join(map(str, dims)) or 'nothing'}", remedy=MEND
            )


def _check_chunks(folder: Path) -> None:
    """Check that no chunk of a group is missing, in whose place Zarr would put NaN in silence."""
    group = open_group(folder)
    for name in _ARRAYS:
        chunks = array_of(group, name).nchunks
        files = (file for _, _, files in os.walk(folder / name) for file in files)
        missing = chunks - sum(1 for file in files if _CHUNK.fullmatch(file))
        if missing > 0:
            value = f"{missing} of {chunks} chunks of {name} missing"
            raise InputError(STORED, value=value, remedy=MEND, where=str(folder))


def _stored(path: Path, group: str | None) -> xr.Dataset:
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
            "A store must be complete before it is used",
            value=f"{missing} motions missing in {path}",
            remedy="Finish it with `resume`",
        )
    _check_chunks(folder)
    # Strings of fixed width are what everyone can compare, save and group by.
    texts = {
        name: ("motion", np.array(dataset[name].values.tolist()), dataset[name].attrs)
        for name in ("motion", "event", "checksum")
    }
    plain = dataset.drop_vars(["journal", *texts], errors="ignore")
    opened: xr.Dataset = plain.assign_coords(texts).set_coords(_COORDINATES)
    for name in opened.coords:
        variable = opened.variables[name].load()  # small, and used where no error is explained
        if variable.dtype.kind == "f" and not np.isfinite(variable.values).all():
            raise InputError(STORED, value=f"{name} that is not finite", remedy=MEND, where=str(path))
    # A store lists its arrays in the order of its folder; whatever is derived from it would inherit that.
    return opened[sorted(map(str, opened.variables))]
