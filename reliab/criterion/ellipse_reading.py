"""Ellipses from whatever holds them: files that the commands write, names of what ships, pandas, xarray."""

from pathlib import Path

import pandas as pd
import xarray as xr

from reliab.criterion.ellipse_csv import read_table
from reliab.errors import InputError
from reliab.renamed import renamed
from reliab.shipped import or_shipped
from reliab.vocabulary import Metric

EllipseSource = xr.Dataset | pd.DataFrame | str | Path
"""A dataset or a table of ellipses, stored results, the file of one, or the name of what ships."""


@renamed("0.4", frequency="f", damping_ratio="xi")
def read_ellipses(
    source: EllipseSource,
    *,
    f: float = 1.0,
    xi: float = 0.02,
    threshold: float = 0.05,
    metric: str = Metric.RMS,
) -> xr.Dataset:
    """Read ellipses of many ground motions.

    Parameters
    ----------
    source : str, pathlib.Path, pandas.DataFrame or xarray.Dataset
        A file that `reliab ellipses` wrote, NetCDF or CSV; any table with the columns a [-] and b [ms²]; a
        Zarr store that `reliab simulate` wrote, in which the boundaries of `threshold` and `metric` are
        traced; or "real_suite", the ellipses of 100 real motions that ship.
    f, xi, threshold, metric
        What the ellipses of a table were traced for [Hz, -, -], where it does not say.

    Returns
    -------
    xarray.Dataset
        `a` and `b` over (motion, f, xi, threshold, metric, curve, side), with the coordinate `event`, and
        with `alpha` after `xi` where there are several shares of the stiffness.

    Raises
    ------
    InputError
        If the source cannot be read, a table lacks a column, holds a parameter that is not a positive number,
        or holds one motion twice for one structure and error; the message names the line.

    Examples
    --------
    >>> dict(read_ellipses("real_suite").sizes)["motion"]
    100
    """
    if isinstance(source, str | Path):
        source = or_shipped(Path(source), "datasets", "ellipses.nc")
        if source.suffix == ".nc":
            from reliab.sweep import open_ellipses

            return open_ellipses(source)
        if source.is_dir():
            from reliab.sweep import open_results

            source = open_results(source)
    if isinstance(source, xr.Dataset):
        return _of_dataset(source, threshold, metric)
    return read_table(source, frequency=f, damping_ratio=xi, threshold=threshold, metric=metric)


def _of_dataset(dataset: xr.Dataset, threshold: float, metric: str) -> xr.Dataset:
    """Take ellipses as they are, and trace them in results."""
    if {"a", "b"} <= set(dataset):
        return dataset
    if metric not in dataset:
        raise InputError(
            "A dataset must hold ellipses, a and b, or results, rms and mte",
            value=", ".join(map(str, dataset)) or "nothing",
            remedy="Trace ellipses with reliab.ellipses",
        )
    from reliab.sweep import results_accessor  # noqa: F401 - gives datasets the accessor `reliab`

    traced: xr.Dataset = dataset.reliab.ellipses((threshold,), (Metric.parse(metric),))
    return traced
