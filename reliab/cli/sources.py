"""Where ellipses come from: a file of them, stored results, or records that are simulated here and now."""

from pathlib import Path
from typing import TYPE_CHECKING

from reliab.cli.options import FIVE_PERCENT, ONE_HERTZ, TWO_PERCENT
from reliab.cli.output import progress_bar
from reliab.errors import InputError

if TYPE_CHECKING:
    import xarray as xr

    from reliab.vocabulary import Metric


def ellipse_dataset(
    *,
    motions: list[str] | None,
    sets: list[str] | None,
    results: Path | None,
    ellipses: Path | None = None,
    f: list[float] | None,
    xi: list[float] | None,
    threshold: list[float] | None,
    metric: str,
    window: str,
    alpha: float,
    model: Path | None = None,
    first_order: bool = False,
) -> "xr.Dataset":
    """Trace or look up the ellipses that a command is about.

    Parameters
    ----------
    motions, sets : list of str or None
        Sources of ground motions and sets of their catalogue.
    results : pathlib.Path or None
        Stored results instead.
    ellipses : pathlib.Path or None
        A file of ellipses instead, CSV or NetCDF.
    f, xi : list of float or None
        Natural frequencies [Hz] and damping ratios [-]; of stored results and ellipses all that they
        hold, by default and where one that is asked for is not among them.
    threshold : list of float or None
        Errors on the boundary [-].
    metric, window : str
        Error of the whole test, and where it is taken.
    alpha : float
        Experimental fraction [-], for records.
    model : pathlib.Path or None
        Model with effects instead of structures, for records.
    first_order : bool
        Whether ellipses are predicted from the spectra of records instead of traced.

    Returns
    -------
    xarray.Dataset
        `a`, `b`, `sse`, `n` over (motion, f, xi, threshold, metric, curve, side).

    Raises
    ------
    InputError
        If not exactly one source is given, or a model without records.
    """
    from reliab import api
    from reliab.motions import load_motions
    from reliab.vocabulary import Metric

    given = [source for source in (motions, results, ellipses) if source is not None]
    if len(given) != 1:
        raise InputError(
            "Ellipses come from one source: ground motions, stored results or a file of ellipses",
            value=f"{len(given)} of them",
            remedy="Give --motions (records or 'synthetic'), or --results, or --ellipses where it is known",
        )
    if model is not None and motions is None:
        raise InputError(
            "A model is simulated under ground motions",
            value="--model without --motions",
            remedy="Give --motions; a store knows with which model it was simulated",
        )
    if first_order and motions is None:
        raise InputError(
            "Only the records themselves have spectra to predict from",
            value="--first-order without --motions",
            remedy="Give --motions, or leave --first-order out",
        )
    if metric not in list(Metric):
        raise InputError("The metric is rms or mte", value=metric, remedy="Choose one of these")
    if ellipses is not None:
        return _read(ellipses, f, xi, threshold, Metric(metric))
    thresholds = tuple(threshold or (FIVE_PERCENT,))
    if results is not None:
        return _stored(results, f, xi, thresholds, Metric(metric), window)
    suite = load_motions(*(motions or []), sets=sets)
    with progress_bar("Reading spectra" if first_order else "Tracing boundaries") as progress:
        return api.ellipses(
            suite,
            f=f,
            xi=xi,
            threshold=thresholds,
            metric=[metric],
            window=window,
            alpha=alpha,
            model=model,
            first_order=first_order,
            progress=progress,
        )


def _read(
    path: Path, f: list[float] | None, xi: list[float] | None, threshold: list[float] | None, metric: "Metric"
) -> "xr.Dataset":
    from reliab.criterion import read_ellipses
    from reliab.shipped import or_shipped
    from reliab.sweep import open_ellipses

    path = or_shipped(path, "datasets", "ellipses.nc")
    if path.suffix == ".nc":
        return _among(open_ellipses(path), f, xi)
    return read_ellipses(
        path,
        frequency=(f or [ONE_HERTZ])[0],
        damping_ratio=(xi or [TWO_PERCENT])[0],
        threshold=(threshold or [FIVE_PERCENT])[0],
        metric=metric,
    )


def _stored(
    path: Path,
    f: list[float] | None,
    xi: list[float] | None,
    thresholds: tuple[float, ...],
    metric: "Metric",
    window: str,
) -> "xr.Dataset":
    from reliab.shipped import or_shipped
    from reliab.sweep import open_results

    chosen = _among(open_results(or_shipped(path, "datasets", "results.nc"), window=window), f, xi)
    with progress_bar("Tracing boundaries") as progress:
        traced: xr.Dataset = chosen.reliab.ellipses(thresholds, (metric,), progress=progress)
    return traced


def _among(dataset: "xr.Dataset", f: list[float] | None, xi: list[float] | None) -> "xr.Dataset":
    """Keep the structures that are asked for, or all where one of them lies between those that are there."""
    import numpy as np

    for name, wanted in (("f", f), ("xi", xi)):
        there = dataset[name].values
        if wanted and all(np.isclose(there, value, rtol=1e-9).any() for value in wanted):
            dataset = dataset.sel({name: wanted}, method="nearest")
    return dataset
