"""`reliab simulate`: simulate once and store the results for all later questions."""

from pathlib import Path
from typing import Annotated

import typer

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

_STATED = ("grid", "windows", "engine", "tolerance", "experimental_fraction", "model", "study_hash")


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
            help="Part of the record over which errors are computed; several may be stored.",
        ),
    ] = None,
    alpha: Fractions = None,
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
    from reliab.motions import load_motions
    from reliab.sweep import attributes, run_sweep, sweep_request

    suite = load_motions(*(motions or ["synthetic"]), sets=sets)
    request = sweep_request(
        f=f,
        xi=xi,
        grid=grid,
        window=window or ["record"],
        alpha=alpha or [1.0],
        model=model,
        engine=engine,
    )
    with progress_bar("Simulating") as progress:
        run_sweep(suite, request, out, resume=resume, workers=workers, scheduler=scheduler, progress=progress)
    described = request.describe()
    stated = attributes(request, request.windows[0].label)
    done = {
        "store": str(out),
        "motions": len(suite),
        **{name: described[name] for name in ("f", "xi", "kp", "tau")},
        "alpha": list(request.experimental_fractions),
        **{name: stated[name] for name in _STATED if name in stated},
    }
    if not write_json(done, json_target):
        console().print(
            f"{len(suite)} motions × {len(request.structures)} structures stored in {out}", highlight=False
        )
