"""`reliab criterion`: how much amplitude error and delay a test may have."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from reliab.cli.completion import laws, methods
from reliab.cli.demand import Demand, takes
from reliab.cli.options import (
    DampingRatios,
    Ellipses,
    Fractions,
    Frequencies,
    JsonTarget,
    MetricName,
    ModelFile,
    Motions,
    Results,
    Sets,
    StructureFile,
    Thresholds,
    WindowIfGiven,
    written_as,
)


@dataclass(frozen=True, kw_only=True)
class CriterionDemand(Demand):
    """Options of `reliab criterion`; those of the derivation are arguments of `reliab.derive_criteria`."""

    motions: Motions = None
    sets: Sets = None
    results: Results = None
    ellipses: Ellipses = None
    f: Frequencies = None
    xi: DampingRatios = None
    threshold: Thresholds = None
    confidence: Annotated[
        list[float] | None,
        typer.Option("--confidence", metavar="SHARE...", help="Shares of the population's ground motions."),
    ] = None
    metric: MetricName = "rms"
    window: WindowIfGiven = None
    alpha: Fractions = None
    duration: Annotated[
        float | None,
        typer.Option(
            "--duration",
            metavar="SECONDS",
            help="Length of the records of the tests; by default the criterion is for lengths like those of "
            "the motions behind it.",
        ),
    ] = None
    motion: Annotated[
        Path | None,
        typer.Option(
            "--motion",
            metavar="FILE",
            help="Record under which the test will be run: a criterion for responses like that under it, and "
            "the record's own boundary.",
        ),
    ] = None
    suite: Annotated[
        list[Path] | None,
        typer.Option(
            "--suite",
            metavar="NAME|FOLDER...",
            help="A few records of the earthquakes that are expected, pooled with the motions behind the "
            "criterion.",
        ),
    ] = None
    weights: Annotated[
        Path | None,
        typer.Option(
            "--weights",
            metavar="FILE.csv",
            help="Magnitudes, distances, lengths or significant durations that a site expects, by which the "
            "motions are weighted; columns quantity, low, high, share.",
        ),
    ] = None
    model: ModelFile = None
    structure: StructureFile = None
    actuator: Annotated[
        int | None,
        typer.Option(
            "--actuator",
            metavar="N",
            help="Number of the only actuator of --structure that errs, from 1; all err alike by default.",
        ),
    ] = None
    method: Annotated[
        str | None,
        typer.Option(
            "--method",
            autocompletion=methods,
            metavar="NAME",
            help="What the confidence means: dirichlet (recommended, the default), quantile (the "
            "paper's), or another; --list names all.",
        ),
    ] = None
    assurance: Annotated[
        float | None,
        typer.Option(
            "--assurance",
            metavar="SHARE",
            help="How sure the promise is, for methods that state it (see --list): the share of suites "
            "that keep it, or its posterior probability.",
        ),
    ] = None
    distribution: Annotated[
        str | None, typer.Option("--distribution", metavar="NAME", help="Family for the method quantile.")
    ] = None
    joint: Annotated[
        bool | None,
        typer.Option(
            "--joint/--each",
            help="Whether the confidence holds for a and b together or for each of them separately; by "
            "default together, with quantile separately.",
        ),
    ] = None
    law: Annotated[
        str,
        typer.Option(
            "--law",
            autocompletion=laws,
            metavar="NAME",
            help="How the limits depend on f and ξ: table (of the simulated structures, the default), or "
            "another law, fitted or printed; --list names all.",
        ),
    ] = "table"
    steps: Annotated[
        int | None,
        typer.Option(
            "--steps", metavar="N", help="Steps of the hierarchical methods' chains, a multiple of 4."
        ),
    ] = None
    chains: Annotated[
        Path | None,
        typer.Option(
            "--chains",
            metavar="FILE.h5",
            help="Keep the chains of the hierarchical methods, so that an interrupted or short run can "
            "resume.",
        ),
    ] = None
    compare: Annotated[
        bool,
        typer.Option(
            "--compare", help="Also judge distributions and laws on earthquakes that they have not seen."
        ),
    ] = False
    figures: Annotated[
        Path | None,
        typer.Option(
            "--figures",
            metavar="FOLDER",
            help="Draw criteria over the motions' own ellipses, and traces, ranks and pairs of a posterior.",
        ),
    ] = None
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="FILE.json",
            callback=written_as(".json"),
            help="Write the criterion for later use.",
        ),
    ] = None
    list_all: Annotated[
        bool, typer.Option("--list", help="Name all methods, laws and distributions, with what each means.")
    ] = False
    json_target: JsonTarget = None


@takes(CriterionDemand)
def criterion(demand: CriterionDemand) -> None:
    """Derive how much amplitude error and delay a test may have."""
    from reliab.cli.criterion.shown import show_choices, show_criteria
    from reliab.cli.output import progress_bar, write_json

    if demand.list_all:
        demand.refuse_all_but({"list_all"}, "beside `list_all`")
        show_choices()
        return
    from reliab.api import derive_criteria

    derived = demand.ask(derive_criteria, "json_target", show=progress_bar)
    content = derived.to_dict()
    if not write_json(content, demand.json_target):
        show_criteria(content)
    derived.require_converged(demand.chains)
