"""`reliab.simulate`: motions for all structures and actuators, stored."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Unpack

import xarray as xr

from reliab.app import questions
from reliab.app.api.sources import as_list, paths
from reliab.app.declaration import asks
from reliab.core.plain_values import PlainResult
from reliab.core.progress import Progress, Show, quietly, silent
from reliab.motions.loading import load_motions
from reliab.sweep.plain import WHOLLY_EXPERIMENTAL, Motions, suite_of, sweep_request
from reliab.sweep.request import SweepRequest
from reliab.sweep.results import open_results
from reliab.sweep.run import run_sweep
from reliab.sweep.store_layout import attributes

_STATED = ("grid", "windows", "engine", "tolerance", "experimental_fraction", "model", "study_hash")


@asks(questions.Sweep)
def simulate(
    motions: Motions, *, out: str | Path, progress: Progress = silent, **request: Unpack[questions.Sweep]
) -> xr.Dataset:
    """Simulate motions for all structures and actuators and store the results.

    Structures are of 1 Hz, 0.02 and all stiffness in the laboratory by default. The scaled grid has late and
    early actuators, with a model late ones only; those of the paper are late. Of a model, gain, delay and the
    index (A, d) of the results are those of its actuator alone.

    Parameters
    ----------
    motions : MotionSuite, Motion, str or pathlib.Path
        The ground motions, as `load_motions` gives them, one of them, or what it would read: a folder, a file
        or the name of a suite.
    out : str or pathlib.Path
        The Zarr store to write.
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
    return open_results(
        run_sweep(suite_of(motions), _request(request), out, **_run(request), progress=progress)
    )


def _request(request: questions.Sweep) -> SweepRequest:
    return sweep_request(
        f=request["f"],
        xi=request["xi"],
        grid=request["grid"],
        window=request["window"] or "record",
        alpha=WHOLLY_EXPERIMENTAL if request["alpha"] is None else request["alpha"],
        model=request["model"],
        engine=request["engine"],
    )


def _run(request: questions.Sweep) -> dict[str, Any]:
    return {"resume": request["resume"], "workers": request["workers"], "scheduler": request["scheduler"]}


@dataclass(frozen=True, kw_only=True)
class Simulation(PlainResult):
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
    """Simulate motions from several sources and sets as :func:`simulate` does, and say what was stored."""
    suite = load_motions(*paths(asked["motions"] or "synthetic"), sets=as_list(asked["sets"]))
    request = _request(asked)
    with show("Simulating") as progress:
        run_sweep(suite, request, out, **_run(asked), progress=progress)
    return Simulation(store=Path(out), motions=len(suite), request=request)
