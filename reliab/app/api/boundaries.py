"""`reliab.ellipses`: boundaries of equal error as ellipses."""

from collections.abc import Sequence
from pathlib import Path
from typing import Unpack

import xarray as xr

from reliab.app import questions
from reliab.app.declaration import asks
from reliab.core.errors import InputError
from reliab.core.progress import Progress, silent
from reliab.core.vocabulary import Metric, Side
from reliab.sweep.ellipse_dataset import CURVES
from reliab.sweep.ellipse_table import EllipseRequest, predict_ellipses, trace_ellipses
from reliab.sweep.plain import WHOLLY_EXPERIMENTAL, Motions, StatedStructures, one_of, suite_of
from reliab.sweep.results import REAL
from reliab.sweep.several import Names, several
from reliab.tracking.boundary.curves import Curve
from reliab.tracking.indices.window import Window


@asks(questions.TracedBoundaries)
def ellipses(
    source: Motions | xr.Dataset,
    *,
    metric: Names = ("rms",),
    curves: Sequence[type[Curve]] = CURVES,
    progress: Progress = silent,
    **asked: Unpack[questions.TracedBoundaries],
) -> xr.Dataset:
    """Trace the boundary of equal error of each motion, for late and early actuators, as ellipses.

    Stored results are taken with all their structures and in their own window; of ground motions the
    structure is one of 1 Hz and 0.02 by default. Ellipses that are predicted (`first_order`) are exact for
    small errors, but at 5 % RMS^R the traced a is 5 % smaller and b 16 to 44 % smaller. The boundary of a
    model has delays only.

    Parameters
    ----------
    source : MotionSuite, Motion, xarray.Dataset, str or pathlib.Path
        Ground motions, which are simulated along the boundary, or stored results; either also by the name or
        path that `load_motions` or `open_results` takes.
    metric : {"rms", "mte"} or sequence of these, optional
        Which errors.
    curves : sequence of type, optional
        Curves that stand for a boundary; the ellipse of least squares (the paper's) and the largest ellipse
        inside the boundary by default.
    progress : callable, optional
        Called after each motion, or structure of stored results.

    Returns
    -------
    xarray.Dataset
        `a` [-], `b` [ms²], `sse` [ms⁴] and `n` over (motion, f, xi, threshold, metric, curve, side), with
        `alpha` after `xi` where there are several fractions; the side is "lag" for actuators that are late
        and "lead" for those that are early, which a model with effects does not have. `no_ellipse` says why
        a and b are NaN or zero, and `error_at_rest` is the error of an actuator that does not move.

    Raises
    ------
    InputError
        If a value is not allowed or a record is bad.

    Examples
    --------
    >>> import reliab
    >>> motions = reliab.load_motions("synthetic")[:2]
    >>> found = reliab.ellipses(motions, threshold=[0.05, 0.10])
    >>> bool((found["a"].sel(threshold=0.10) > found["a"].sel(threshold=0.05)).all())
    True
    """
    metrics = tuple(
        one_of(name, {str(choice): choice for choice in Metric}, "metric") for name in several(metric)
    )
    thresholds = several((0.05,) if asked["threshold"] is None else asked["threshold"])
    if isinstance(source, str | Path) and _holds_results(Path(source)):
        from reliab.sweep.results import open_results

        source = open_results(source)
    if isinstance(source, xr.Dataset):
        if asked["first_order"]:
            raise InputError(
                "A prediction of ellipses needs ground motions",
                value="stored results",
                remedy="Give the ground motions, or leave the prediction out",
            )
        stored: xr.Dataset = source.reliab.ellipses(thresholds, metrics, curves, progress=progress)
        return stored
    stated = StatedStructures.from_plain(
        f=asked["f"],
        xi=asked["xi"],
        alpha=WHOLLY_EXPERIMENTAL if asked["alpha"] is None else asked["alpha"],
        model=asked["model"],
    )
    request = EllipseRequest(
        frequencies=stated.frequencies,
        damping_ratios=stated.damping_ratios,
        thresholds=thresholds,
        metrics=metrics,
        curves=tuple(curves),
        window=Window.parse(asked["window"] or "record"),
        experimental_fractions=stated.experimental_fractions,
        model=stated.model,
        sides=tuple(Side) if stated.model is None else (Side.LAG,),
    )
    trace = predict_ellipses if asked["first_order"] else trace_ellipses
    return trace(suite_of(source), request, progress=progress)


def _holds_results(path: Path) -> bool:
    """Tell a store of results, or the name of the shipped ones, from ground motions."""
    return path.suffix in (".zarr", ".nc") or path == Path(REAL)
