"""What `reliab` offers to Python, in the words of its command line.

The functions take plain numbers and names and hand over to the rooms of the package, which offer more.
"""

from collections.abc import Sequence
from pathlib import Path

import xarray as xr

from reliab.boundary import Curve
from reliab.errors import InputError
from reliab.indices.window import Window
from reliab.loop.hybrid_test import HybridTest
from reliab.motions import Motion, MotionSuite, load_motions
from reliab.progress import Progress, silent
from reliab.sweep import CURVES, EllipseRequest, predict_ellipses, trace_ellipses
from reliab.sweep.plain import (
    WHOLLY_EXPERIMENTAL,
    Names,
    Numbers,
    StatedStructures,
    one_of,
    several,
    sweep_request,
)
from reliab.sweep.real_suite import REAL
from reliab.vocabulary import Metric, Side

Motions = MotionSuite | Motion | str | Path
"""Ground motions, one of them, or what `load_motions` reads."""


def simulate(
    motions: Motions,
    *,
    out: str | Path,
    f: Numbers | None = None,
    xi: Numbers | None = None,
    grid: str = "scaled",
    window: Names = ("record",),
    alpha: Numbers = WHOLLY_EXPERIMENTAL,
    model: str | Path | HybridTest | None = None,
    engine: str = "automatic",
    resume: bool = False,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress = silent,
) -> xr.Dataset:
    """Simulate motions for all structures and actuators and store the results.

    Parameters
    ----------
    motions : MotionSuite, Motion, str or pathlib.Path
        The ground motions, as `load_motions` gives them, one of them, or what it would read: a folder, a file
        or the name of a suite.
    out : str or pathlib.Path
        The Zarr store to write.
    f, xi : float or sequence of float, optional
        Natural frequencies [Hz] and damping ratios [-]; 1 Hz and 0.02 by default.
    grid : {"scaled", "paper"}, optional
        Actuators that are simulated: scaled to each structure, late and early (with a model late only), or
        those of the paper, which are late.
    window : str or sequence of str, optional
        Where errors are taken, "record", "arias" or seconds; several may be stored.
    alpha : float or sequence of float, optional
        Experimental fraction of the stiffness [-]; of several the results have a dimension.
    model : str, pathlib.Path or HybridTest, optional
        A hybrid test with effects, or the file of one. Its structure takes the place of `f`, `xi` and
        `alpha`, and gain, delay and the index (A, d) of the results are those of its actuator alone.
    engine : {"automatic", "pole", "delay", "spectral"}, optional
        How the loop is solved.
    resume : bool, optional
        Whether to continue a store that was begun.
    workers : int, optional
        Threads; one for each processor by default.
    scheduler : str, optional
        Address of a dask scheduler that solves the motions instead.
    progress : callable, optional
        Called after each motion.

    Returns
    -------
    xarray.Dataset
        `rms`, `mte`, `A` [-], `d` [s] and `stable` over (motion, f, xi, kp, tau), with `alpha` after `xi`
        where several fractions are given.

    Raises
    ------
    InputError
        If a value is not allowed, a record is bad or the store cannot be written to.
    IncompleteError
        If the disk is full; what is stored is safe.

    Examples
    --------
    >>> import tempfile, reliab
    >>> motions = reliab.load_motions("synthetic")[:2]
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     results = reliab.simulate(motions, out=f"{folder}/results.zarr").load()
    >>> results["rms"].dims, results["rms"].shape
    (('motion', 'f', 'xi', 'kp', 'tau'), (2, 1, 1, 41, 57))
    """
    request = sweep_request(f=f, xi=xi, grid=grid, window=window, alpha=alpha, model=model, engine=engine)
    from reliab.sweep import open_results, run_sweep

    path = run_sweep(
        suite_of(motions),
        request,
        out,
        resume=resume,
        workers=workers,
        scheduler=scheduler,
        progress=progress,
    )
    return open_results(path)


def ellipses(
    source: Motions | xr.Dataset,
    *,
    f: Numbers | None = None,
    xi: Numbers | None = None,
    threshold: Numbers = (0.05,),
    metric: Names = ("rms",),
    window: str = "record",
    alpha: Numbers = WHOLLY_EXPERIMENTAL,
    model: str | Path | HybridTest | None = None,
    curves: Sequence[type[Curve]] = CURVES,
    first_order: bool = False,
    progress: Progress = silent,
) -> xr.Dataset:
    """Trace the boundary of equal error of each motion, for late and early actuators, as ellipses.

    Parameters
    ----------
    source : MotionSuite, Motion, xarray.Dataset, str or pathlib.Path
        Ground motions, which are simulated along the boundary, or stored results, with all their structures
        and in their own window; either also by the name or path that `load_motions` or `open_results` takes.
    f, xi : float or sequence of float, optional
        Natural frequencies [Hz] and damping ratios [-], for ground motions; 1 Hz and 0.02 by default.
    threshold : float or sequence of float, optional
        Errors on the boundary [-].
    metric : {"rms", "mte"} or sequence of these, optional
        Which errors.
    window : str, optional
        Where errors are taken, for ground motions: "record", "arias" or seconds.
    alpha : float or sequence of float, optional
        Experimental fraction of the stiffness [-], for ground motions; of several the ellipses have a
        dimension.
    model : str, pathlib.Path or HybridTest, optional
        A hybrid test with effects, or the file of one, whose structure takes the place of `f`, `xi` and
        `alpha`, for ground motions; such a boundary has delays only.
    curves : sequence of type, optional
        Curves that stand for a boundary; the ellipse of least squares (the paper's) and the largest ellipse
        inside the boundary by default.
    first_order : bool, optional
        Whether ellipses of ground motions are predicted from their spectra in closed form instead of traced;
        exact for small errors, but at 5 % RMS^R the traced a is 5 % smaller and b 16 to 44 % smaller.
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
    if isinstance(source, str | Path) and _holds_results(Path(source)):
        from reliab.sweep import open_results

        source = open_results(source)
    if isinstance(source, xr.Dataset):
        if first_order:
            raise InputError(
                "Ellipses are predicted from the spectra of ground motions",
                value="stored results",
                remedy="Give the ground motions, or leave the prediction out",
            )
        stored: xr.Dataset = source.reliab.ellipses(several(threshold), metrics, curves, progress=progress)
        return stored
    stated = StatedStructures.of(f=f, xi=xi, alpha=alpha, model=model)
    request = EllipseRequest(
        frequencies=stated.frequencies,
        damping_ratios=stated.damping_ratios,
        thresholds=several(threshold),
        metrics=metrics,
        curves=tuple(curves),
        window=Window.parse(window),
        experimental_fractions=stated.experimental_fractions,
        model=stated.model,
        sides=tuple(Side) if stated.model is None else (Side.LAG,),
    )
    trace = predict_ellipses if first_order else trace_ellipses
    return trace(suite_of(source), request, progress=progress)


def suite_of(motions: Motions) -> MotionSuite:
    """Take a suite as it is, put a motion into one, and load what is named.

    Parameters
    ----------
    motions : MotionSuite, Motion, str or pathlib.Path
        A suite, a motion, or a folder, file or name that `load_motions` takes.

    Returns
    -------
    MotionSuite
        The motions.
    """
    if isinstance(motions, MotionSuite):
        return motions
    return MotionSuite.from_motions([motions]) if isinstance(motions, Motion) else load_motions(motions)


def _holds_results(path: Path) -> bool:
    """Tell a store of results, or the name of the shipped ones, from ground motions."""
    return path.suffix in (".zarr", ".nc") or path == Path(REAL)
