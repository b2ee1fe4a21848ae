"""`reliab simulate`: fill a results store, once and for all later questions."""

from pathlib import Path
from typing import Annotated, TypeVar

import typer

from reliab.cli.options import (
    ONE_HERTZ,
    TWO_PERCENT,
    DampingRatios,
    ExperimentalFraction,
    Frequencies,
    JsonTarget,
    ModelFile,
    Motions,
    Sets,
)
from reliab.cli.output import console, progress_bar, write_json
from reliab.cli.sources import modelled
from reliab.errors import InputError

_Choice = TypeVar("_Choice")


def simulate(
    *,
    motions: Motions = None,
    sets: Sets = None,
    f: Frequencies = None,
    xi: DampingRatios = None,
    out: Annotated[Path, typer.Option("--out", metavar="STORE", help="The Zarr store to write.")],
    grid: Annotated[
        str, typer.Option("--grid", metavar="scaled|paper", help="Actuators that are simulated.")
    ] = "scaled",
    window: Annotated[
        list[str] | None,
        typer.Option(
            "--window",
            metavar="record|SECONDS|arias...",
            help="Where errors are taken; several may be stored.",
        ),
    ] = None,
    alpha: ExperimentalFraction = 1.0,
    model: ModelFile = None,
    engine: Annotated[
        str, typer.Option("--engine", metavar="automatic|pole|delay|spectral", help="How the loop is solved.")
    ] = "automatic",
    resume: Annotated[bool, typer.Option("--resume", help="Continue a store that was begun.")] = False,
    workers: Annotated[
        int | None, typer.Option("--workers", min=1, help="Threads; all processors by default.")
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option("--scheduler", metavar="ADDRESS", help="A dask scheduler that solves the motions."),
    ] = None,
    json_target: JsonTarget = None,
) -> None:
    """Simulate motions for all structures and actuators and store the results.

    With --model the structure and the effects are the model's, and gain, delay and the index (A, d) of the
    results are those of its actuator alone.
    """
    from reliab.indices.window import Window
    from reliab.loop.engine import Engine
    from reliab.motions import load_motions
    from reliab.sweep import ExplicitGrid, ScaledGrid, SweepRequest, run_sweep

    suite = load_motions(*(motions or ["synthetic"]), sets=sets)
    test = modelled(model, f, xi, alpha)
    structure = None if test is None else test.structure
    request = SweepRequest(
        frequencies=(structure.frequency,) if structure else tuple(sorted(f or [ONE_HERTZ])),
        damping_ratios=(structure.damping_ratio,) if structure else tuple(sorted(xi or [TWO_PERCENT])),
        grid=_one_of(grid, {"scaled": ScaledGrid(), "paper": ExplicitGrid()}, "grid"),
        windows=tuple(Window.parse(text) for text in window or ["record"]),
        experimental_fraction=structure.experimental_fraction if structure else alpha,
        engine=_one_of(engine, {each.value: each for each in Engine}, "engine"),
        model=test,
    )
    with progress_bar("Simulating") as progress:
        run_sweep(suite, request, out, resume=resume, workers=workers, scheduler=scheduler, progress=progress)
    done = {"store": str(out), "motions": len(suite), **request.describe(), "study_hash": request.digest()}
    if not write_json(done, json_target):
        structures = len(request.structures)
        console().print(f"{len(suite)} motions × {structures} structures stored in {out}", highlight=False)


def _one_of(name: str, choices: dict[str, _Choice], what: str) -> _Choice:
    if name not in choices:
        raise InputError(
            f"The {what} is one of {', '.join(choices)}", value=name, remedy="Choose one of these"
        )
    return choices[name]
