"""`reliab criterion`: how much amplitude error and delay a test may have."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from reliab.cli.options import (
    FIVE_PERCENT,
    ONE_HERTZ,
    TWO_PERCENT,
    DampingRatios,
    ExperimentalFraction,
    Frequencies,
    JsonTarget,
    MetricName,
    ModelFile,
    Motions,
    Results,
    Sets,
    Thresholds,
    WindowName,
)
from reliab.cli.output import console, table, write_json
from reliab.cli.sources import ellipse_dataset
from reliab.errors import InputError

if TYPE_CHECKING:
    import xarray as xr

    from reliab.criterion import Criterion


_HEADINGS = ("f [Hz]", "ξ [-]", "error [-]", "confidence [-]", "a [-]", "b [ms²]", "|A − 1| ≤", "d ≤ [ms]")

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
    str,
    typer.Option(
        "--method",
        metavar="NAME",
        help="What the confidence means: quantile (the paper's), tolerance, posterior, predictive, "
        "order_statistic, conformal, bootstrap, dirichlet; recommended is dirichlet --joint.",
    ),
]
Assurance = Annotated[
    float | None,
    typer.Option(
        "--assurance", metavar="SHARE", help="Share of suites that keep the promise (tolerance ...)."
    ),
]
DistributionName = Annotated[
    str | None, typer.Option("--distribution", metavar="NAME", help="Family for the method quantile.")
]
Joint = Annotated[
    bool, typer.Option("--joint/--each", help="Whether a and b hold together or each for itself.")
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
    window: WindowName = "record",
    alpha: ExperimentalFraction = 1.0,
    model: ModelFile = None,
    method: MethodName = "quantile",
    assurance: Assurance = None,
    distribution: DistributionName = None,
    joint: Joint = False,
    law: LawName = "table",
    out: Out = None,
    json_target: JsonTarget = None,
) -> None:
    """Derive how much amplitude error and delay a test may have."""
    from reliab.criterion import derive_criterion, published_criterion
    from reliab.criterion.laws import FITTED, OF_MANY_MOTIONS, known
    from reliab.criterion.methods import method_of

    if law in OF_MANY_MOTIONS:
        found = [published_criterion(law)]
        structures = [(each_f, each_xi) for each_f in f or [ONE_HERTZ] for each_xi in xi or [TWO_PERCENT]]
        rows = [_row(found[0], None, *structure) for structure in structures]
    else:
        chosen, fitted = method_of(method, assurance=assurance, distribution=distribution), known(FITTED, law)
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
        )
        _check_room(dataset)
        found = [
            derive_criterion(
                dataset,
                threshold=each_threshold,
                metric=metric,
                confidence=each_confidence,
                method=chosen,
                joint=joint,
                law=fitted,
            )
            for each_threshold in threshold or _default_thresholds(dataset)
            for each_confidence in confidence or [0.95]
        ]
        rows = [
            _row(each, dataset, each_f, each_xi)
            for each_f in f or dataset["f"].values.tolist()
            for each_xi in xi or dataset["xi"].values.tolist()
            for each in found
        ]
    _write(found, out)
    content: dict[str, Any] = {"criteria": rows, **(rows[0] if len(rows) == 1 else {})}
    if not write_json(content, json_target):
        _show(rows)


def _check_room(dataset: "xr.Dataset") -> None:
    """Refuse motions under which a model's effects alone exceed the error."""
    full = (dataset["a"] == 0.0) & (dataset["b"] == 0.0)
    if full.any():
        motions = full.any([name for name in full.dims if name != "motion"])
        raise InputError(
            "The effects of the model must leave room for errors of the actuator",
            value=f"none under {int(motions.sum())} of {motions.size} motions, even for a perfect actuator",
            remedy="Remove or compensate the effects, or allow a larger error by --threshold",
        )


def _default_thresholds(dataset: "xr.Dataset") -> list[float]:
    """Take 5 % where it is there, or all that is."""
    there: list[float] = dataset["threshold"].values.tolist()
    return [FIVE_PERCENT] if FIVE_PERCENT in there else there


def _row(
    criterion: "Criterion", dataset: "xr.Dataset | None", frequency: float, damping_ratio: float
) -> dict[str, Any]:
    from reliab.criterion.summary import describe_sample, summarise

    row = summarise(criterion, frequency, damping_ratio)
    if dataset is not None and frequency in dataset["f"] and damping_ratio in dataset["xi"]:
        row.update(describe_sample(dataset, criterion, frequency, damping_ratio))
    return row


def _write(found: "list[Criterion]", out: Path | None) -> None:
    if out is None:
        return
    if len(found) > 1:
        raise InputError(
            "One criterion fits into a file",
            value=f"{len(found)} of them",
            remedy="Give one threshold and one confidence",
            where=str(out),
        )
    try:
        out.write_text(found[0].to_json(), encoding="utf-8")
    except OSError as error:
        raise InputError(
            "The criterion's file must be writable",
            value=error.strerror,
            remedy="Name another file",
            where=str(out),
        ) from error


def _show(rows: list[dict[str, Any]]) -> None:
    first = rows[0]
    shown = table(
        f"(A − 1)²/a + d²/b ≤ 1 from {first['n_motions']} motions of {first['n_events']} earthquakes",
        dict.fromkeys(_HEADINGS, "right"),
    )
    for row in rows:
        shown.add_row(
            *(f"{row[key]:g}" for key in ("f", "xi", "threshold", "confidence")),
            *(f"{row[key]:.3g}" for key in ("a", "b", "amplitude_limit", "delay_limit_ms")),
        )
    terminal = console()
    terminal.print(shown)
    together = "a and b together" if first["joint"] else "a and b each for itself"
    terminal.print(f"Method: {first['method']}, {together}. Law: {first['law']}.", highlight=False)
    for warning in dict.fromkeys(warning for row in rows for warning in row["warnings"]):
        terminal.print(f"Note: {warning}", markup=False, highlight=False)
