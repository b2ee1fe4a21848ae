"""`reliab simulate`: simulate once and store the results for all later questions."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from reliab.cli.demand import Demand, takes
from reliab.cli.options import (
    DampingRatios,
    Fractions,
    Frequencies,
    JsonTarget,
    ModelFile,
    Motions,
    Sets,
)
from reliab.cli.output import console, progress_bar, write_json


@dataclass(frozen=True, kw_only=True)
class SimulateDemand(Demand):
    """Options of `reliab simulate`, arguments of `reliab.simulate_suite`."""

    motions: Motions = None
    sets: Sets = None
    f: Frequencies = None
    xi: DampingRatios = None
    out: Annotated[Path, typer.Option("--out", metavar="STORE", help="The Zarr store to write.")]
    grid: Annotated[
        str,
        typer.Option(
            "--grid",
            metavar="scaled|paper",
            help="Gains and delays to simulate: scaled to each structure, or the paper's.",
        ),
    ] = "scaled"
    window: Annotated[
        list[str] | None,
        typer.Option(
            "--window",
            metavar="record|SECONDS|arias...",
            help="Part of the record over which errors are computed; several may be stored.",
        ),
    ] = None
    alpha: Fractions = None
    model: ModelFile = None
    engine: Annotated[
        str,
        typer.Option(
            "--engine", metavar="automatic|pole|delay|spectral", help="How the equation of motion is solved."
        ),
    ] = "automatic"
    resume: Annotated[
        bool, typer.Option("--resume", help="Continue a store that an interrupted run has begun.")
    ] = False
    workers: Annotated[
        int | None, typer.Option("--workers", min=1, help="Threads; all processors by default.")
    ] = None
    scheduler: Annotated[
        str | None,
        typer.Option("--scheduler", metavar="ADDRESS", help="A dask scheduler that solves the motions."),
    ] = None
    json_target: JsonTarget = None


@takes(SimulateDemand)
def simulate(demand: SimulateDemand) -> None:
    """Simulate motions for all structures and actuators and store the results.

    With --model the structure and the effects are the model's, and gain, delay and the index (A, d) of the
    results are those of its actuator alone.
    """
    from reliab.api import simulate_suite

    simulation = demand.ask(simulate_suite, "json_target", show=progress_bar)
    if not write_json(simulation.to_dict(), demand.json_target):
        structures = len(simulation.request.structures)
        console().print(
            f"{simulation.motions} motions × {structures} structures stored in {simulation.store}",
            highlight=False,
        )
