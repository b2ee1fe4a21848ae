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
            help="Where errors are taken; several may be stored.",
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
    from reliab import api
    from reliab.motions import load_motions
    from reliab.sweep.shares import shares_of

    suite = load_motions(*(motions or ["synthetic"]), sets=sets)
    with progress_bar("Simulating") as progress:
        results = api.simulate(
            suite,
            out=out,
            f=f,
            xi=xi,
            grid=grid,
            window=window or ["record"],
            alpha=alpha or [1.0],
            model=model,
            engine=engine,
            resume=resume,
            workers=workers,
            scheduler=scheduler,
            progress=progress,
        )
    done = {
        "store": str(out),
        "motions": len(suite),
        **{name: results[name].values.tolist() for name in ("f", "xi", "kp", "tau")},
        "alpha": list(shares_of(results)),
        **{name: results.attrs[name] for name in _STATED if name in results.attrs},
    }
    if not write_json(done, json_target):
        structures = results.sizes["f"] * results.sizes["xi"] * len(done["alpha"])
        console().print(f"{len(suite)} motions × {structures} structures stored in {out}", highlight=False)
