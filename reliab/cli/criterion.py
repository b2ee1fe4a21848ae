"""`reliab criterion`: how much amplitude error and delay a test may have."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from reliab.cli.criterion_answer import check_one, row, show, write
from reliab.cli.criterion_comparison import show_comparison
from reliab.cli.criterion_derivation import (
    check_files,
    check_printed_source,
    check_room,
    derive,
    printed_criterion,
    promises_of,
)
from reliab.cli.options import (
    ONE_HERTZ,
    TWO_PERCENT,
    DampingRatios,
    FractionIfGiven,
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
)
from reliab.cli.output import write_json
from reliab.cli.sources import check_thresholds, ellipse_dataset
from reliab.errors import IncompleteError, InputError

if TYPE_CHECKING:
    import xarray as xr

    from reliab.criterion import Criterion
    from reliab.criterion.derivation import Derivation

Ellipses = Annotated[
    Path | None,
    typer.Option(
        "--ellipses",
        metavar="FILE.csv|FILE.nc",
        help="Ellipses: columns a, b and motion or event; or as `reliab ellipses --out` keeps them.",
    ),
]
Confidences = Annotated[
    list[float] | None, typer.Option("--confidence", metavar="SHARE...", help="Shares of ground motions.")
]
MethodName = Annotated[
    str | None,
    typer.Option(
        "--method",
        metavar="NAME",
        help="What the confidence means: dirichlet (recommended, the default), tolerance, posterior, "
        "predictive, order_statistic, conformal, bootstrap, each structure for itself; hierarchical, "
        "hierarchical_robust, all structures at once by MCMC; quantile is the paper's, with fitted "
        "ellipses and a and b each for itself.",
    ),
]
Assurance = Annotated[
    float | None,
    typer.Option(
        "--assurance",
        metavar="SHARE",
        help="Share of suites that keep the promise (tolerance, posterior, order_statistic, bootstrap), "
        "or its posterior probability (hierarchical).",
    ),
]
Steps = Annotated[
    int | None,
    typer.Option("--steps", metavar="N", help="Steps of the hierarchical methods' chains, a multiple of 4."),
]
Chains = Annotated[
    Path | None,
    typer.Option(
        "--chains",
        metavar="FILE.h5",
        help="Keep the chains of the hierarchical methods, so that an interrupted or short run can resume.",
    ),
]
Compare = Annotated[
    bool,
    typer.Option(
        "--compare", help="Also judge distributions and laws on earthquakes that they have not seen."
    ),
]
Figures = Annotated[
    Path | None,
    typer.Option(
        "--figures",
        metavar="FOLDER",
        help="Draw criteria over the motions' own ellipses, and traces, ranks and pairs of a posterior.",
    ),
]
DistributionName = Annotated[
    str | None, typer.Option("--distribution", metavar="NAME", help="Family for the method quantile.")
]
Joint = Annotated[
    bool | None,
    typer.Option(
        "--joint/--each",
        help="Whether a and b hold together or each for itself; by default together, with quantile each.",
    ),
]
LawName = Annotated[
    str,
    typer.Option(
        "--law",
        metavar="NAME",
        help="table, dimensionless, power or exponential, fitted to the structures; or printed: "
        "guo_2017_12, guo_2017_15, guo_2017_18, and with _corrected.",
    ),
]
Out = Annotated[
    Path | None, typer.Option("--out", metavar="FILE.json", help="Write the criterion for later use.")
]


def criterion(
    *,
    motions: Motions = None,
    sets: Sets = None,
    results: Results = None,
    ellipses: Ellipses = None,
    f: Frequencies = None,
    xi: DampingRatios = None,
    threshold: Thresholds = None,
    confidence: Confidences = None,
    metric: MetricName = "rms",
    window: WindowIfGiven = None,
    alpha: FractionIfGiven = None,
    model: ModelFile = None,
    structure: StructureFile = None,
    method: MethodName = None,
    assurance: Assurance = None,
    distribution: DistributionName = None,
    joint: Joint = None,
    law: LawName = "table",
    steps: Steps = None,
    chains: Chains = None,
    compare: Compare = False,
    figures: Figures = None,
    out: Out = None,
    json_target: JsonTarget = None,
) -> None:
    """Derive how much amplitude error and delay a test may have."""
    from reliab.criterion.laws import FITTED, OF_MANY_MOTIONS, known
    from reliab.criterion.methods import RECOMMENDED, method_of

    printed, given = law in OF_MANY_MOTIONS, any((motions, results, ellipses))
    settings = {"assurance": assurance, "distribution": distribution, "steps": steps, "chains": chains}
    check_thresholds(threshold)
    fitted = None if printed else known(FITTED, law)
    criteria: list[Criterion] = []
    if printed:
        criteria = [printed_criterion(law, threshold, confidence, metric, method, settings, joint=joint)]
        source = {"--sets": sets, "--model": model, "--window": window, "--alpha": alpha}
        source["--structure"] = structure
        check_printed_source(law, source, given=given, drawn=figures is not None or compare)
    del settings["chains"]
    chosen = None if printed else method_of(method or RECOMMENDED, **settings)
    check_files(chosen, chains, figures)
    dataset = None
    if given or not printed:
        dataset = ellipse_dataset(
            motions=motions,
            sets=sets,
            results=results,
            ellipses=ellipses,
            f=f if law == "table" or motions else None,  # a fitted law learns from all that is stored
            xi=xi if law == "table" or motions else None,
            threshold=threshold,
            metric=metric,
            window=window,
            alpha=alpha,
            model=model,
            structure=structure,
        )
        check_room(dataset)
    derivations: list[Derivation] = []
    if dataset is not None and fitted is not None and chosen is not None:
        promises = promises_of(dataset, threshold, confidence)
        check_one(len(promises), out)
        criteria, derivations = derive(dataset, promises, metric, chosen, fitted, chains, joint=joint)
    structures = _structures(dataset, f, xi)
    rows = [
        row(criterion, None if printed else dataset, *structure)
        for structure in structures
        for criterion in criteria
    ]
    write(criteria[0], out)
    posteriors = [diagnostics for derivation in derivations for diagnostics in derivation.diagnostics]
    drawn = []
    if figures is not None:
        drawn = _draw(figures, dataset, criteria, structures, derivations)
    content: dict[str, Any] = {"criteria": rows, **(rows[0] if len(rows) == 1 else {})}
    content |= {"posteriors": posteriors} if posteriors else {}
    content |= {"figures": drawn} if drawn else {}
    if compare:
        content["comparison"] = _compared(dataset, structures, criteria)
    if not write_json(content, json_target):
        show(rows, posteriors)
        if compare:
            show_comparison(content["comparison"])
    _refuse_unconverged(posteriors, chains)


def _structures(
    dataset: "xr.Dataset | None", f: list[float] | None, xi: list[float] | None
) -> list[tuple[float, float]]:
    """Take the structures that are asked for, or all that are there."""
    all_f = [ONE_HERTZ] if dataset is None else dataset["f"].values.tolist()
    all_xi = [TWO_PERCENT] if dataset is None else dataset["xi"].values.tolist()
    return [(frequency, damping_ratio) for frequency in f or all_f for damping_ratio in xi or all_xi]


def _compared(
    dataset: "xr.Dataset | None", structures: Sequence[tuple[float, float]], criteria: "Sequence[Criterion]"
) -> dict[str, Any]:
    from reliab.cli.criterion_comparison import compare

    if dataset is None:
        raise InputError(
            "Distributions and laws are compared on ellipses of motions",
            value="--compare without a source of ellipses",
            remedy="Give --motions, --results or --ellipses too, real_suite for example",
        )
    thresholds = list(dict.fromkeys(criterion.threshold for criterion in criteria))
    first = criteria[0]
    curve = first.provenance.curve
    return compare(dataset, structures, thresholds, str(first.metric), first.confidence, curve)


def _draw(
    folder: Path,
    dataset: "xr.Dataset | None",
    criteria: "Sequence[Criterion]",
    structures: Sequence[tuple[float, float]],
    derivations: "Sequence[Derivation]",
) -> list[str]:
    from reliab.cli.criterion_figures import draw_all

    if dataset is None:
        raise InputError(
            "A criterion is drawn over ellipses of motions",
            value="--figures without a source of ellipses",
            remedy="Give --motions, --results or --ellipses too, real_suite for example",
        )
    return draw_all(folder, dataset, criteria, structures, derivations)


def _refuse_unconverged(posteriors: Sequence[Mapping[str, Any]], chains: Path | None) -> None:
    """End with an error where a posterior cannot be relied on, after everything has been written."""
    failed = [posterior for posterior in posteriors if not posterior["converged"]]
    if failed:
        complaints = " ".join(sentence for posterior in failed for sentence in posterior["complaints"])
        again = f"{2 * failed[0]['steps']}"
        where = f"Resume with --chains {chains} --steps {again}" if chains else f"Give --steps {again}"
        message = (
            f"THE POSTERIOR HAS NOT CONVERGED, and no limit above may be relied on. {complaints} {where}."
        )
        raise IncompleteError(message)
