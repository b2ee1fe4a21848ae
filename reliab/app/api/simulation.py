"""`reliab.simulate`: motions for all structures and actuators, stored."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Unpack

import xarray as xr

from reliab.app import questions
from reliab.app.api.sources import as_list, paths
from reliab.app.declaration import asks
from reliab.core.plain_values import Keys, PlainResult, same_names
from reliab.core.progress import Progress, show_task, silent
from reliab.motions.loading import load_motions
from reliab.motions.suite import MotionSuite
from reliab.sweep.plain import Motions, suite_of, sweep_request
from reliab.sweep.request import SweepRequest
from reliab.sweep.results import open_results
from reliab.sweep.run import run_sweep
from reliab.sweep.store_layout import attributes

_ATTRIBUTES = ("grid", "windows", "engine", "tolerance", "experimental_fraction", "model", "study_hash")


@asks(questions.SweepQuestion, questions.NewStore)
def simulate(
    motions: Motions,
    *,
    out: str | Path,
    progress: Progress = silent,
    **request: Unpack[questions.SweepQuestion],
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
    _, store = _run(suite_of(motions), out, {**request}, progress)
    return open_results(store)


def _run(
    suite: MotionSuite, out: str | Path, question: Mapping[str, Any], progress: Progress
) -> tuple[SweepRequest, Path]:
    """Simulate a suite and store the results; return what was simulated, and where it is stored."""
    request = sweep_request(**questions.select_stated(questions.SweepOptions, question))
    settings = questions.select_stated(questions.SweepRunOptions, question)
    return request, run_sweep(suite, request, out, **settings, progress=progress)


@dataclass(frozen=True, kw_only=True)
class Simulation(PlainResult):
    """A suite of ground motions that was simulated and stored."""

    keys: ClassVar[Keys] = {
        **same_names("store", "motions"),
        **{name: f"request.describe.{name}" for name in ("f", "xi", "kp", "tau")},
        "alpha": "request.experimental_fractions",
        "**": "stored_attributes",
    }

    store: Path
    motions: int
    request: SweepRequest

    def results(self) -> xr.Dataset:
        """Open the store, as :func:`reliab.simulate` does."""
        return open_results(self.store)

    @property
    def stored_attributes(self) -> dict[str, Any]:
        """How it was simulated, as the store states it."""
        stored = attributes(self.request, self.request.windows[0].label)
        return {name: stored[name] for name in _ATTRIBUTES if name in stored}


@asks(questions.SimulationQuestion, questions.NewStore)
def simulate_suite(*, out: str | Path, **request: Unpack[questions.SimulationQuestion]) -> Simulation:
    """Simulate motions from several sources and sets as :func:`simulate` does, and say what was stored."""
    suite = load_motions(*paths(request["motions"] or "synthetic"), sets=as_list(request["sets"]))
    with show_task("Simulating") as progress:
        simulated_request, store = _run(suite, out, {**request}, progress)
    return Simulation(store=store, motions=len(suite), request=simulated_request)
