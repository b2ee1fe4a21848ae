"""Ellipses from whatever holds them: files that the commands write, names of what ships, pandas, xarray.

A CSV file, such as the paper's Table 2, has columns `a` [-] and `b` [ms²]; where present, `motion` (or
`record`), `event`, `f` (or `f_hz`) [Hz], `xi`, `alpha`, `threshold` and `metric`. Without `event`, the
motion's name before the first "/" is its earthquake; without a motion, every row is an earthquake of its own.
"""

import warnings
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr

from reliab.core.encodings import encoding_of_file
from reliab.core.errors import InputError
from reliab.core.files import LIMITS, decoding, ordinary
from reliab.core.shipped import or_shipped
from reliab.core.stated_value import QUANTITIES_BY_DIMENSION, RANGES
from reliab.core.vocabulary import LABELS, Dimension, Metric
from reliab.sweep.labels import select_share

_OTHER_NAMES = {"record": "motion", "f_hz": "f"}
_SHARE = str(Dimension.SHARE)
_CELL = ("f", "xi", _SHARE, "threshold", "metric")


def read_table(
    source: str | Path | pd.DataFrame,
    *,
    frequency: float = 1.0,
    damping_ratio: float = 0.02,
    threshold: float = 0.05,
    metric: str = Metric.RMS,
) -> xr.Dataset:
    """Read a table of ellipses.

    `frequency` [Hz], `damping_ratio`, `threshold` [-] and `metric`: what a table without these columns is of.
    Returns `a` and `b` over (motion, f, xi, threshold, metric, curve, side), with the coordinate `event`, and
    with `alpha` after `xi` where the file has several shares of the stiffness.
    """
    path = "the data frame" if isinstance(source, pd.DataFrame) else str(source)
    table = _name_columns(
        source.astype(str) if isinstance(source, pd.DataFrame) else _cells(Path(source)), path
    )
    columns = pd.DataFrame(
        {"f": frequency, "xi": damping_ratio, "threshold": threshold, "metric": str(metric)},
        index=table.index,
    )
    states_share = _SHARE in table
    table = table.assign(**({} if states_share else {_SHARE: "1"}))
    table = table.join(columns[[name for name in columns if name not in table]])
    for name in ("a", "b", "f", "xi", _SHARE, "threshold"):
        table[name] = _require_range(table[name], name, path)
    is_duplicate = table.duplicated(["motion", *_CELL])
    if is_duplicate.any():
        raise InputError(
            "A motion occurs twice for one structure and error",
            value=table["motion"][is_duplicate].iloc[0],
            remedy="Rename one, or add the columns f, xi, alpha, threshold that distinguish them",
            where=f"{path}, line {_line(is_duplicate)}",
        )
    cube = _dataset(table)
    if cube.sizes[_SHARE] > 1:
        return cube
    return select_share(cube) if states_share else cube.isel({_SHARE: 0}, drop=True)


def _cells(path: Path) -> pd.DataFrame:
    rule, remedy = "A table of ellipses must be a readable CSV file", "Give a file with the columns a and b"
    with decoding(rule, remedy=remedy, where=path), warnings.catch_warnings():
        warnings.simplefilter("error", pd.errors.ParserWarning)  # a row of more cells than the first line
        LIMITS["table of ellipses"].require_small(ordinary(path))
        LIMITS["table of ellipses"].require_narrow(path)
        rows = pd.read_csv(
            path,
            header=None,  # which would number names that occur twice
            skipinitialspace=True,
            dtype=str,
            keep_default_na=False,
            index_col=False,
            encoding=encoding_of_file(path),
        )
    return rows[1:].set_axis(list(rows.iloc[0]), axis="columns").reset_index(drop=True)


def _name_columns(table: pd.DataFrame, path: str) -> pd.DataFrame:
    """Give every column the name that it has here, and the motions names and earthquakes."""
    table = table.rename(columns=lambda name: str(name).strip().lower())
    table = table.rename(columns={k: v for k, v in _OTHER_NAMES.items() if v not in table})
    if not table.columns.is_unique:
        raise InputError(
            "Two columns have the same name",
            value=repr(table.columns[table.columns.duplicated()][0]),
            remedy="Remove or rename the other column; capital and small letters are the same",
            where=f"{path}, line 1",
        )
    missing = [name for name in ("a", "b") if name not in table]
    if missing:
        raise InputError(
            f"No column {' and no column '.join(missing)}",
            remedy="Name the columns in the first line; a is dimensionless, b in ms²",
            where=f"{path}, line 1",
        )
    if table.empty:
        raise InputError("The table has no rows", remedy="Give a row for each ground motion", where=path)
    if "motion" not in table:
        table["motion"] = [f"row {row}" for row in range(1, len(table) + 1)]
    if "event" not in table:
        table["event"] = table["motion"].str.split("/").str[0]
    return table


def _require_range(column: "pd.Series[str]", name: str, path: str) -> "pd.Series[float]":
    numbers = pd.to_numeric(column, errors="coerce")
    limits = RANGES[QUANTITIES_BY_DIMENSION.get(name, "number")]
    wrong = ~limits.includes(numbers)
    if wrong.any():
        raise InputError(
            f"Not a number {limits.span} in the column {name}",
            value=repr(column[wrong].iloc[0]),
            remedy="Correct or remove the row",
            where=f"{path}, line {_line(wrong)}",
        )
    return numbers


def _line(wrong: "pd.Series[bool]") -> int:
    """Line of the first wrong row; the names of the columns are line 1."""
    return int(np.flatnonzero(wrong)[0]) + 2


def _dataset(table: pd.DataFrame) -> xr.Dataset:
    order = table["motion"].drop_duplicates().to_numpy()
    events = table.drop_duplicates("motion").set_index("motion")["event"]
    dimensions = ["motion", *_CELL, "curve", "side"]
    cube = table.assign(curve="ellipse", side="lag").set_index(dimensions)[["a", "b"]].to_xarray()
    cube = cube.sel(motion=order).assign_coords(event=("motion", events[order].to_numpy().astype(np.str_)))
    for name in cube.variables:
        cube[name].attrs.update(long_name=LABELS[str(name)].long_name, units=LABELS[str(name)].units)
    return cube


EllipseSource = xr.Dataset | pd.DataFrame | str | Path
"""A dataset or a table of ellipses, stored results, the file of one, or the name of what ships."""


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
            from reliab.sweep.ellipse_dataset import open_ellipses

            return open_ellipses(source)
        if source.is_dir():
            from reliab.sweep.results import open_results

            source = open_results(source)
    if isinstance(source, xr.Dataset):
        return _ellipses_of_dataset(source, threshold, metric)
    return read_table(source, frequency=f, damping_ratio=xi, threshold=threshold, metric=metric)


def _ellipses_of_dataset(dataset: xr.Dataset, threshold: float, metric: str) -> xr.Dataset:
    """Take ellipses as they are, and trace them in results."""
    if {"a", "b"} <= set(dataset):
        return dataset
    if metric not in dataset:
        raise InputError(
            "The dataset holds neither ellipses (a and b) nor results (rms and mte)",
            value=", ".join(map(str, dataset)) or "nothing",
            remedy="Trace ellipses with reliab.ellipses",
        )
    from reliab.sweep import results_accessor  # noqa: F401 - gives datasets the accessor `reliab`

    ellipses: xr.Dataset = dataset.reliab.ellipses((threshold,), (Metric.parse(metric),))
    return ellipses
