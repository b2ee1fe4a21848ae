"""What `reliab` offers to Python, in the words of its command line.

The functions take plain numbers and names and hand over to the rooms of the package, which offer more.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Final, TypeVar

import xarray as xr

from reliab.boundary import Curve, Ellipse
from reliab.errors import InputError
from reliab.indices.window import Window
from reliab.loop.engine import Engine
from reliab.motions import MotionSuite
from reliab.progress import Progress, silent
from reliab.sweep import (
    EllipseRequest,
    ExplicitGrid,
    Grid,
    ScaledGrid,
    SweepRequest,
    open_results,
    run_sweep,
    trace_ellipses,
)
from reliab.vocabulary import Metric

_Choice = TypeVar("_Choice")
_GRIDS: Final[dict[str, Grid]] = {"scaled": ScaledGrid(), "paper": ExplicitGrid()}


def simulate(
    motions: MotionSuite,
    *,
    out: str | Path,
    f: Sequence[float] = (1.0,),
    xi: Sequence[float] = (0.02,),
    grid: str = "scaled",
    window: Sequence[str] = ("record",),
    alpha: float = 1.0,
    engine: str = "automatic",
    resume: bool = False,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress = silent,
) -> xr.Dataset:
    """Simulate motions for all structures and actuators and store the results.

    Parameters
    ----------
    motions : MotionSuite
        The ground motions, as `load_motions` gives them.
    out : str or pathlib.Path
        The Zarr store to write.
    f, xi : sequence of float, optional
        Natural frequencies [Hz] and damping ratios [-].
    grid : {"scaled", "paper"}, optional
        Actuators that are simulated: scaled to each structure, or those of the paper.
    window : sequence of str, optional
        Where errors are taken, "record", "arias" or seconds; several may be stored.
    alpha : float, optional
        Experimental fraction of the stiffness [-].
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
        `rms`, `mte`, `A` [-], `d` [s] and `stable` over (motion, f, xi, kp, tau).

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
    >>> dict(results.sizes)
    {'motion': 2, 'f': 1, 'xi': 1, 'kp': 41, 'tau': 31}
    """
    request = SweepRequest(
        frequencies=tuple(sorted(f)),
        damping_ratios=tuple(sorted(xi)),
        grid=_one_of(grid, _GRIDS, "grid"),
        windows=tuple(Window.parse(text) for text in window),
        experimental_fraction=alpha,
        engine=_one_of(engine, {each.value: each for each in Engine}, "engine"),
    )
    path = run_sweep(
        motions, request, out, resume=resume, workers=workers, scheduler=scheduler, progress=progress
    )
    return open_results(path)


def ellipses(
    source: MotionSuite | xr.Dataset,
    *,
    f: Sequence[float] = (1.0,),
    xi: Sequence[float] = (0.02,),
    threshold: Sequence[float] = (0.05,),
    metric: Sequence[str] = ("rms",),
    window: str = "record",
    alpha: float = 1.0,
    curves: Sequence[type[Curve]] = (Ellipse,),
    progress: Progress = silent,
) -> xr.Dataset:
    """Trace the boundary of equal error of each motion and fit an ellipse to it.

    Parameters
    ----------
    source : MotionSuite or xarray.Dataset
        Ground motions, which are simulated along the boundary, or stored results, which answer for all
        their structures and in their own window.
    f, xi : sequence of float, optional
        Natural frequencies [Hz] and damping ratios [-], for ground motions.
    threshold : sequence of float, optional
        Errors on the boundary [-].
    metric : sequence of {"rms", "mte"}, optional
        Which errors.
    window : str, optional
        Where errors are taken, for ground motions: "record", "arias" or seconds.
    alpha : float, optional
        Experimental fraction of the stiffness [-], for ground motions.
    curves : sequence of type, optional
        Curves that are fitted; the ellipse by default.
    progress : callable, optional
        Called after each motion, or structure of stored results.

    Returns
    -------
    xarray.Dataset
        `a` [-], `b` [ms²], `sse` [ms⁴] and `n` over (motion, f, xi, threshold, metric, curve).

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
    metrics = tuple(_one_of(name, {str(each): each for each in Metric}, "metric") for name in metric)
    if isinstance(source, xr.Dataset):
        stored: xr.Dataset = source.reliab.ellipses(tuple(threshold), metrics, curves, progress=progress)
        return stored
    request = EllipseRequest(
        frequencies=tuple(f),
        damping_ratios=tuple(xi),
        thresholds=tuple(threshold),
        metrics=metrics,
        curves=tuple(curves),
        window=Window.parse(window),
        experimental_fraction=alpha,
    )
    return trace_ellipses(source, request, progress=progress)


def _one_of(name: str, choices: dict[str, _Choice], what: str) -> _Choice:
    if name not in choices:
        raise InputError(
            f"The {what} is one of {', '.join(choices)}", value=name, remedy="Choose one of these"
        )
    return choices[name]
