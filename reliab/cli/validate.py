"""`reliab validate`: whether criteria hold on motions that they have not seen."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from reliab.cli.criterion import Ellipses
from reliab.cli.options import (
    FIVE_PERCENT,
    DampingRatios,
    ExperimentalFraction,
    Frequencies,
    JsonTarget,
    MetricName,
    Motions,
    Results,
    Sets,
    WindowName,
)
from reliab.cli.output import console, progress_bar, table, write_json
from reliab.cli.sources import ellipse_dataset
from reliab.errors import InputError

if TYPE_CHECKING:
    import xarray as xr

    from reliab.validation.cross_validation import Candidate, CrossValidation, Fold

_CONFIDENCES = (0.50, 0.60, 0.70, 0.80, 0.90, 0.95, 0.99)
_MEASURES = ("containment", "false_safe", "accepted_share")
_HEADINGS = {
    "criterion": "left",
    "stated": "right",
    "contained (95 % interval)": "right",
    "false-safe": "right",
    "good tests accepted": "right",
}
Threshold = Annotated[float, typer.Option("--threshold", metavar="ERROR", help="Error, 0.05 for 5 %.")]
Scheme = Annotated[
    str,
    typer.Option(
        "--scheme",
        metavar="NAME",
        help="How earthquakes are divided: leave_one_event_out, k_fold or random_halves.",
    ),
]
LeaveOut = Annotated[
    str | None,
    typer.Option("--leave-out", metavar="f|xi", help="Also leave out each frequency or damping ratio."),
]
Learn = Annotated[
    list[str] | None, typer.Option("--learn", metavar="SET...", help="Sets of --motions to learn from ...")
]
Judge = Annotated[list[str] | None, typer.Option("--judge", metavar="SET...", help="... and sets to judge.")]
Methods = Annotated[
    list[str] | None,
    typer.Option("--method", metavar="NAME...", help="Meanings of the confidence; dirichlet by default."),
]
Joint = Annotated[
    bool, typer.Option("--joint/--each", help="Whether a and b hold together or each for itself.")
]
Laws = Annotated[
    list[str] | None,
    typer.Option("--law", metavar="NAME...", help="Fitted or printed laws; table and printed by default."),
]
Confidences = Annotated[
    list[float] | None, typer.Option("--confidence", metavar="SHARE...", help="Stated shares of the motions.")
]
Tests = Annotated[int, typer.Option("--trials", min=1, help="Tests per structure, near the boundaries.")]
Case = Annotated[
    str | None,
    typer.Option("--case", metavar="MOTION", help="Run the paper's four cases under this motion instead."),
]


def validate(
    *,
    motions: Motions = None,
    sets: Sets = None,
    results: Results = None,
    ellipses: Ellipses = None,
    f: Frequencies = None,
    xi: DampingRatios = None,
    threshold: Threshold = FIVE_PERCENT,
    metric: MetricName = "rms",
    window: WindowName = "record",
    alpha: ExperimentalFraction = 1.0,
    scheme: Scheme = "leave_one_event_out",
    leave_out: LeaveOut = None,
    learn: Learn = None,
    judge: Judge = None,
    method: Methods = None,
    joint: Joint = True,
    law: Laws = None,
    confidence: Confidences = None,
    trials: Tests = 512,
    case: Case = None,
    json_target: JsonTarget = None,
) -> None:
    """Judge criteria on earthquakes that they were not learned from."""
    if case is not None:
        from reliab.cli.case_mode import judge_cases

        judge_cases(motions, sets, case, json_target)
        return
    from reliab.validation.cross_validation import cross_validate

    suite_sets = _sets_of(motions, sets, learn, judge)
    dataset = ellipse_dataset(
        motions=motions,
        sets=sets,
        results=results,
        ellipses=ellipses,
        f=f,
        xi=xi,
        threshold=[threshold],
        metric=metric,
        window=window,
        alpha=alpha,
    )
    folds, name = _folds(dataset, scheme, leave_out, suite_sets, learn, judge)
    with progress_bar("Cross-validating") as progress:
        found = cross_validate(
            dataset,
            folds,
            _candidates(method, law, threshold, metric, joint=joint),
            scheme=name,
            confidences=confidence or _CONFIDENCES,
            threshold=threshold,
            metric=metric,
            results=_simulated(results, dataset, window),
            trials=trials,
            progress=progress,
        )
    content = _content(found, simulated=results is not None)
    if not write_json(content, json_target):
        _show(content)


def _sets_of(
    motions: list[str] | None, sets: list[str] | None, learn: list[str] | None, judge: list[str] | None
) -> dict[str, str] | None:
    """Set of each motion by its name, where sets are judged by others."""
    if learn is None and judge is None:
        return None
    if not (learn and judge and motions):
        raise InputError(
            "To judge sets by others, --motions, --learn and --judge are needed",
            value="only some of them",
            remedy="Give all three, for example --learn far_field --judge near_field",
        )
    from reliab.motions import load_motions

    suite = load_motions(*motions, sets=sets)
    return dict(zip(suite.names, suite.set_names, strict=True))


def _folds(
    dataset: "xr.Dataset",
    scheme: str,
    leave_out: str | None,
    sets: dict[str, str] | None,
    learn: list[str] | None,
    judge: list[str] | None,
) -> "tuple[list[Fold], str]":
    import numpy as np

    from reliab.validation.cross_validation import folds_of, leave_structures_out, transfer

    events = dataset["event"].values
    folds, name = [], scheme
    if sets is not None and learn and judge:
        of_motions = np.array([sets[motion] for motion in dataset["motion"].values.tolist()])
        folds = list(transfer(of_motions, events, learned=learn, judged=judge))
        name = f"learned from {', '.join(learn)}, judged on {', '.join(judge)}"
    else:
        folds = folds_of(scheme, events)
    if leave_out is None:
        return folds, name
    if leave_out not in {"f", "xi"}:
        raise InputError("What is left out is f or xi", value=leave_out, remedy="Choose one of these")
    values = dataset[leave_out].values.tolist()
    return list(leave_structures_out(folds, leave_out, values)), f"{name}, each {leave_out} left out"


def _candidates(
    method: list[str] | None, law: list[str] | None, threshold: float, metric: str, *, joint: bool
) -> "list[Candidate]":
    from reliab.criterion.laws import FITTED, OF_MANY_MOTIONS, known
    from reliab.criterion.methods import RECOMMENDED, method_of
    from reliab.validation.cross_validation import Derived, Printed

    printed = (threshold, metric) == (FIVE_PERCENT, "rms")
    laws = law or ["table", *(("guo_2017_15", "guo_2017_18") if printed else ())]
    found: list[Candidate] = []
    for name in laws:
        if name in OF_MANY_MOTIONS:
            found.append(Printed(name=name, law=OF_MANY_MOTIONS[name]))
            continue
        fitted = known(FITTED, name)
        for each in method or [RECOMMENDED]:
            label = each if name == "table" else f"{each}, {name}"
            found.append(Derived(name=label, method=method_of(each), joint=joint, law=fitted))
    return found


def _simulated(path: Path | None, dataset: "xr.Dataset", window: str) -> "xr.Dataset | None":
    """Results of the same structures, from which errors of tests are read."""
    if path is None:
        return None
    from reliab.shipped import or_shipped
    from reliab.sweep import open_results

    opened = open_results(or_shipped(path, "datasets", "results.nc"), window=window)
    return opened.sel(f=dataset["f"].values, xi=dataset["xi"].values, method="nearest")


def _content(found: "CrossValidation", *, simulated: bool) -> dict[str, Any]:
    counts = found.counts
    return {
        "scheme": found.scheme,
        "threshold": found.threshold,
        "metric": found.metric,
        "n_motions": int(counts.sizes["motion"]),
        "n_events": len(set(counts["event"].values.tolist())),
        "truth": "simulated" if simulated else "ellipse",
        "rows": _rows(found, ("f", "xi")),
        "by_frequency": _rows(found, ("xi",)),
        "by_damping_ratio": _rows(found, ("f",)),
    }


def _rows(found: "CrossValidation", over: tuple[str, ...]) -> list[dict[str, Any]]:
    """Rates with intervals and the confusion matrix, one row for each candidate and confidence."""
    rates = {name: getattr(found, name)(over) for name in _MEASURES}
    matrix = found.confusion((*over, "motion"))
    first = rates["containment"]["rate"]
    rows = []
    for at in first.to_series().dropna().index:
        place = dict(zip(first.dims, at if isinstance(at, tuple) else (at,), strict=True))
        row: dict[str, Any] = {str(name): value for name, value in place.items()}
        for name, each in rates.items():
            chosen = each.sel(place)
            row[name] = {end: _number(float(chosen[end])) for end in ("rate", "low", "high")}
        row["confusion"] = {str(name): int(values.sel(place)) for name, values in matrix.items()}
        rows.append(row)
    return rows


def _number(value: float) -> float | None:
    return value if value == value else None  # noqa: PLR0124 - NaN where nothing was accepted


def _show(content: dict[str, Any]) -> None:
    terminal = console()
    shown = table(
        f"{content['scheme'].replace('_', ' ')}: {content['n_motions']} motions of "
        f"{content['n_events']} earthquakes, {content['metric'].upper()} {content['threshold']:g}",
        _HEADINGS,
    )
    for row in content["rows"]:
        shown.add_row(
            row["candidate"], f"{row['confidence']:.0%}", *(_interval(row[name]) for name in _MEASURES)
        )
    terminal.print(shown)
    for row in content["rows"]:
        if row["candidate"].startswith("guo_"):
            rate = row["containment"]
            terminal.print(
                f"{row['candidate']} protects {rate['rate']:.1%} of the motions where it states "
                f"{row['confidence']:.0%}.",
                highlight=False,
            )
    if content["truth"] == "ellipse":
        terminal.print(
            "Note: whether a test is good is read off the motions' ellipses; --results knows their errors."
        )


def _interval(rate: dict[str, float | None]) -> str:
    if rate["rate"] is None:
        return "none"
    if rate["low"] is None or rate["high"] is None:
        return f"{rate['rate']:.1%}"
    return f"{rate['rate']:.1%} ({rate['low']:.1%} … {rate['high']:.1%})"
