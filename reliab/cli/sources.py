"""Where ellipses come from: a results store, or records that are simulated here and now."""

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
    f: list[float] | None,
    xi: list[float] | None,
    threshold: list[float] | None,
    metric: str,
    window: str,
    alpha: float,
) -> "xr.Dataset":
    """Trace or look up the ellipses that a command is about.

    Parameters
    ----------
    motions, sets : list of str or None
        Sources of ground motions and sets of their catalogue.
    results : pathlib.Path or None
        A results store instead.
    f, xi : list of float or None
        Natural frequencies [Hz] and damping ratios [-]; of a store all that it holds by default.
    threshold : list of float or None
        Errors on the boundary [-].
    metric, window : str
        Error of the whole test, and where it is taken.
    alpha : float
        Experimental fraction [-], for records.

    Returns
    -------
    xarray.Dataset
        `a`, `b`, `sse`, `n` over (motion, f, xi, threshold, metric, curve).

    Raises
    ------
    InputError
        If not exactly one of motions and results is given.
    """
    from reliab.vocabulary import Metric

    if (motions is None) == (results is None):
        raise InputError(
            "Ground motions or stored results are needed, and not both",
            value="neither" if motions is None else "both",
            remedy="Give --motions with records or 'synthetic', or --results with a store",
        )
    if metric not in list(Metric):
        raise InputError("The metric is rms or mte", value=metric, remedy="Choose one of these")
    thresholds = tuple(threshold or (FIVE_PERCENT,))
    if results is not None:
        return _stored(results, f, xi, thresholds, Metric(metric), window)
    return _traced(motions or [], sets, f, xi, thresholds, Metric(metric), window, alpha)


def _stored(
    path: Path,
    f: list[float] | None,
    xi: list[float] | None,
    thresholds: tuple[float, ...],
    metric: "Metric",
    window: str,
) -> "xr.Dataset":
    from reliab.sweep import open_results

    results = open_results(path, window=window)
    for each_f in f or []:
        for each_xi in xi or [results["xi"].values[0]]:
            results.reliab.structure(each_f, each_xi)
    chosen = results.sel(f=f or results["f"].values, xi=xi or results["xi"].values, method="nearest")
    with progress_bar("Tracing boundaries") as progress:
        traced: xr.Dataset = chosen.reliab.ellipses(thresholds, (metric,), progress=progress)
    return traced


def _traced(
    motions: list[str],
    sets: list[str] | None,
    f: list[float] | None,
    xi: list[float] | None,
    thresholds: tuple[float, ...],
    metric: "Metric",
    window: str,
    alpha: float,
) -> "xr.Dataset":
    from reliab.indices.window import Window
    from reliab.motions import load_motions
    from reliab.sweep import EllipseRequest, trace_ellipses

    request = EllipseRequest(
        frequencies=tuple(f or (ONE_HERTZ,)),
        damping_ratios=tuple(xi or (TWO_PERCENT,)),
        thresholds=thresholds,
        metrics=(metric,),
        window=Window.parse(window),
        experimental_fraction=alpha,
    )
    with progress_bar("Tracing boundaries") as progress:
        return trace_ellipses(load_motions(*motions, sets=sets), request, progress=progress)
