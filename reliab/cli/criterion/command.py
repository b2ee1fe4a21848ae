"""`reliab criterion`: how much amplitude error and delay a test may have."""

from dataclasses import dataclass
from pathlib import Path

from reliab.cli.completion import laws, methods
from reliab.cli.demand import Demand, flag, option, takes
from reliab.cli.options import (
    DAMPING_RATIOS,
    ELLIPSES,
    FRACTIONS,
    FREQUENCIES,
    JSON_TARGET,
    METRIC_NAME,
    MODEL_FILE,
    MOTIONS,
    RESULTS,
    SETS,
    STRUCTURE_FILE,
    THRESHOLDS,
    WINDOW_IF_GIVEN,
    written_as,
)


@dataclass(frozen=True, kw_only=True)
class CriterionDemand(Demand):
    """Options of `reliab criterion`; those of the derivation are arguments of `reliab.derive_criteria`."""

    motions: list[str] | None = MOTIONS
    sets: list[str] | None = SETS
    results: Path | None = RESULTS
    ellipses: Path | None = ELLIPSES
    f: list[float] | None = FREQUENCIES
    xi: list[float] | None = DAMPING_RATIOS
    threshold: list[float] | None = THRESHOLDS
    confidence: list[float] | None = option("SHARE...", "Shares of the population's ground motions.")
    metric: str = METRIC_NAME
    window: str | None = WINDOW_IF_GIVEN
    alpha: list[float] | None = FRACTIONS
    duration: float | None = option(
        "SECONDS",
        "Length of the records of the tests; by default the criterion is for lengths like those of "
        "the motions behind it.",
    )
    motion: Path | None = option(
        "FILE",
        "Record under which the test will be run: a criterion for responses like that under it, and "
        "the record's own boundary.",
    )
    suite: list[Path] | None = option(
        "NAME|FOLDER...",
        "A few records of the earthquakes that are expected, pooled with the motions behind the criterion.",
    )
    weights: Path | None = option(
        "FILE.csv",
        "Magnitudes, distances, lengths or significant durations that a site expects, by which the "
        "motions are weighted; columns quantity, low, high, share.",
    )
    model: Path | None = MODEL_FILE
    structure: Path | None = STRUCTURE_FILE
    actuator: int | None = option(
        "N", "Number of the only actuator of --structure that errs, from 1; all err alike by default."
    )
    method: str | None = option(
        "NAME",
        "What the confidence means: dirichlet (recommended, the default), quantile (the "
        "paper's), or another; --list names all.",
        autocompletion=methods,
    )
    assurance: float | None = option(
        "SHARE",
        "How sure the promise is, for methods that state it (see --list): the share of suites "
        "that keep it, or its posterior probability.",
    )
    distribution: str | None = option("NAME", "Family for the method quantile.")
    joint: bool | None = option(
        "",
        "Whether the confidence holds for a and b together or for each of them separately; by "
        "default together, with quantile separately.",
        name="--joint/--each",
    )
    law: str = option(
        "NAME",
        "How the limits depend on f and ξ: table (of the simulated structures, the default), or "
        "another law, fitted or printed; --list names all.",
        default="table",
        autocompletion=laws,
    )
    steps: int | None = option("N", "Steps of the hierarchical methods' chains, a multiple of 4.")
    chains: Path | None = option(
        "FILE.h5",
        "Keep the chains of the hierarchical methods, so that an interrupted or short run can resume.",
    )
    compare: bool = flag("Also judge distributions and laws on earthquakes that they have not seen.")
    figures: Path | None = option(
        "FOLDER", "Draw criteria over the motions' own ellipses, and traces, ranks and pairs of a posterior."
    )
    out: Path | None = option("FILE.json", "Write the criterion for later use.", callback=written_as(".json"))
    list_all: bool = flag("Name all methods, laws and distributions, with what each means.", name="--list")
    json_target: str | None = JSON_TARGET


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
