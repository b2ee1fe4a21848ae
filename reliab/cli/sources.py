"""Where ellipses come from: a file of them, stored results, or records that are simulated here and now."""

from pathlib import Path
from typing import TYPE_CHECKING

from reliab.cli.options import FIVE_PERCENT, ONE_HERTZ, TWO_PERCENT
from reliab.cli.output import progress_bar
from reliab.errors import InputError

if TYPE_CHECKING:
    import xarray as xr

    from reliab.loop.hybrid_test import HybridTest
    from reliab.vocabulary import Metric


def modelled(
    path: Path | None, f: list[float] | None, xi: list[float] | None, alpha: float
) -> "HybridTest | None":
    """Read a model with effects, which brings its own structure.

    Parameters
    ----------
    path : pathlib.Path or None
        The model's file, if one is given.
    f, xi : list of float or None
        Natural frequencies and damping ratios that are given as options.
    alpha : float
        Experimental fraction that is given as an option.

    Returns
    -------
    HybridTest or None
        The model.

    Raises
    ------
    InputError
        If the model has no structure, or one is given beside it.
    """
    if path is None:
        return None
    from reliab.discrepancy.updated_model import read_model

    if f or xi or alpha != 1.0:
        raise InputError(
            "A model brings its own structure",
            value="--model together with --f, --xi or --alpha",
            remedy="Leave these out, or change the [structure] table of the model",
        )
    model = read_model(path).test
    if model.structure is None:
        raise InputError(
            "The error of a whole test needs a numerical substructure",
            remedy="Add a [structure] table to the model",
            where=path.name,
        )
    return model


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

    Returns
    -------
    xarray.Dataset
        `a`, `b`, `sse`, `n` over (motion, f, xi, threshold, metric, curve).

    Raises
    ------
    InputError
        If not exactly one source is given, or a model without records.
    """
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
    if metric not in list(Metric):
        raise InputError("The metric is rms or mte", value=metric, remedy="Choose one of these")
    if ellipses is not None:
        return _read(ellipses, f, xi, threshold, Metric(metric))
    thresholds = tuple(threshold or (FIVE_PERCENT,))
    if results is not None:
        return _stored(results, f, xi, thresholds, Metric(metric), window)
    test = modelled(model, f, xi, alpha)
    return _traced(motions or [], sets, f, xi, thresholds, Metric(metric), window, alpha, test)


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


def _traced(
    motions: list[str],
    sets: list[str] | None,
    f: list[float] | None,
    xi: list[float] | None,
    thresholds: tuple[float, ...],
    metric: "Metric",
    window: str,
    alpha: float,
    model: "HybridTest | None",
) -> "xr.Dataset":
    from reliab.indices.window import Window
    from reliab.motions import load_motions
    from reliab.sweep import EllipseRequest, trace_ellipses

    structure = None if model is None else model.structure
    request = EllipseRequest(
        frequencies=(structure.frequency,) if structure else tuple(f or (ONE_HERTZ,)),
        damping_ratios=(structure.damping_ratio,) if structure else tuple(xi or (TWO_PERCENT,)),
        thresholds=thresholds,
        metrics=(metric,),
        window=Window.parse(window),
        experimental_fraction=structure.experimental_fraction if structure else alpha,
        model=model,
    )
    with progress_bar("Tracing boundaries") as progress:
        return trace_ellipses(load_motions(*motions, sets=sets), request, progress=progress)
