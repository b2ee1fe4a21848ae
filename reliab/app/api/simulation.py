"""`reliab.simulate`: motions for all structures and actuators, stored."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Unpack

import xarray as xr

from reliab.app import questions
from reliab.app.api.sources import listed, paths
from reliab.app.declaration import asks
from reliab.core.progress import Progress, Show, quietly, silent
from reliab.motions.loading import load_motions
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.sweep.plain import WHOLLY_EXPERIMENTAL, Motions, suite_of, sweep_request
from reliab.sweep.request import SweepRequest
from reliab.sweep.results import open_results
from reliab.sweep.run import run_sweep
from reliab.sweep.several import Names, Numbers
from reliab.sweep.store_layout import attributes

_STATED = ("grid", "windows", "engine", "tolerance", "experimental_fraction", "model", "study_hash")


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
        Part of the record over which errors are computed: "record", "arias" or seconds; may be several.
    alpha : float or sequence of float, optional
        Share of the stiffness in the laboratory [-]; of several the results have a dimension.
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


@dataclass(frozen=True, kw_only=True)
class Simulation:
    """A suite of ground motions that was simulated and stored."""

    store: Path
    motions: int
    request: SweepRequest

    def results(self) -> xr.Dataset:
        """Open the store, as :func:`reliab.simulate` does."""
        return open_results(self.store)

    def to_dict(self) -> dict[str, Any]:
        """Plain values with stable keys: what was simulated, and where it is stored."""
        described = self.request.describe()
        stated = attributes(self.request, self.request.windows[0].label)
        return {
            "store": str(self.store),
            "motions": self.motions,
            **{name: described[name] for name in ("f", "xi", "kp", "tau")},
            "alpha": list(self.request.experimental_fractions),
            **{name: stated[name] for name in _STATED if name in stated},
        }


@asks(questions.Simulation)
def simulate_suite(
    *, out: str | Path, show: Show = quietly, **asked: Unpack[questions.Simulation]
) -> Simulation:
    """Simulate motions from several sources and sets for all structures and actuators, and store the results.

    With `model` the structure and the effects are the model's, and gain, delay and the index (A, d) of the
    results are those of its actuator alone.

    Parameters
    ----------
    out : str or pathlib.Path
        The Zarr store to write.
    show : callable, optional
        Takes the name of a task and shows its progress.

    Returns
    -------
    Simulation
        Where the results are stored, and what was simulated.

    Raises
    ------
    InputError
        If a value is not allowed, a record is bad or the store cannot be written to.
    IncompleteError
        If the disk is full; what is stored is safe.
    """
    suite = load_motions(*paths(asked["motions"] or "synthetic"), sets=listed(asked["sets"]))
    request = sweep_request(
        f=asked["f"],
        xi=asked["xi"],
        grid=asked["grid"],
        window=asked["window"] or "record",
        alpha=WHOLLY_EXPERIMENTAL if asked["alpha"] is None else asked["alpha"],
        model=asked["model"],
        engine=asked["engine"],
    )
    with show("Simulating") as progress:
        run_sweep(
            suite,
            request,
            out,
            resume=asked["resume"],
            workers=asked["workers"],
            scheduler=asked["scheduler"],
            progress=progress,
        )
    return Simulation(store=Path(out), motions=len(suite), request=request)
