"""`reliab validate`: whether criteria hold on motions that they have not seen."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from reliab.cli.criterion import Ellipses
from reliab.cli.options import (
    FIVE_PERCENT,
    TWO_PERCENT,
    DampingRatios,
    FractionIfGiven,
    Frequencies,
    JsonTarget,
    MetricName,
    Motions,
    Results,
    Sets,
    WindowIfGiven,
)
from reliab.cli.output import progress_bar, write_json
from reliab.cli.sources import ellipse_dataset
from reliab.errors import InputError

if TYPE_CHECKING:
    import xarray as xr

    from reliab.cli.validation_choice import Asked
    from reliab.validation.cross_validation import Truth

_TRIALS = 512
Threshold = Annotated[
    float | None, typer.Option("--threshold", metavar="ERROR", help="Error, 0.05 for 5 %, the default.")
]
Scheme = Annotated[
    str | None,
    typer.Option(
        "--scheme",
        metavar="NAME",
        help="How earthquakes are divided: leave_one_event_out (default), k_fold or random_halves.",
    ),
]
LeaveOut = Annotated[
    str | None,
    typer.Option("--leave-out", metavar="f|xi", help="Also leave out each frequency or damping ratio."),
]
Learn = Annotated[
    list[str] | None,
    typer.Option(
        "--learn",
        metavar="SET...",
        help="Sets of --motions to learn from, or real_suite: the shipped results of 100 real motions.",
    ),
]
Judge = Annotated[
    list[str] | None,
    typer.Option(
        "--judge", metavar="SET...", help="Sets of --motions to judge; all of them with --learn real_suite."
    ),
]
Methods = Annotated[
    list[str] | None,
    typer.Option("--method", metavar="NAME...", help="Meanings of the confidence; dirichlet by default."),
]
Joint = Annotated[
    bool | None,
    typer.Option(
        "--joint/--each",
        help="Whether a and b hold together or each for itself; by default as the method means it.",
    ),
]
Laws = Annotated[
    list[str] | None,
    typer.Option("--law", metavar="NAME...", help="Fitted or printed laws; table and printed by default."),
]
Confidences = Annotated[
    list[float] | None, typer.Option("--confidence", metavar="SHARE...", help="Stated shares of the motions.")
]
Tests = Annotated[
    int | None,
    typer.Option(
        "--trials",
        min=1,
        help="Tests per structure, near the boundaries, 512 by default; with --rebuilt-error, tests of each "
        "kind of actuator and specimen, 6 by default.",
    ),
]
Calibration = Annotated[
    bool,
    typer.Option(
        "--calibration",
        help="Compare the probabilities that are stated for tests with how many of the tests are good.",
    ),
]
Case = Annotated[
    str | None,
    typer.Option("--case", metavar="MOTION", help="Run the paper's four cases under this motion instead."),
]
IntegratorName = Annotated[
    str | None,
    typer.Option(
        "--integrator",
        metavar="NAME",
        help="For --case: chen_ricles (the paper's), central_difference, operator_splitting or exact.",
    ),
]
CompensatorName = Annotated[
    str | None,
    typer.Option(
        "--compensator",
        metavar="NAME",
        help="For --case: inverse (the paper's), feedforward, polynomial_extrapolation or none.",
    ),
]
RebuiltError = Annotated[
    bool,
    typer.Option(
        "--rebuilt-error",
        help="Judge simulated tests by their rebuilt error, beside criteria and the own boundary.",
    ),
]
TestsFile = Annotated[
    Path | None,
    typer.Option(
        "--tests",
        metavar="FILE.csv",
        help="For --rebuilt-error: all tests and verdicts; an interrupted run goes on with it.",
    ),
]
_OF_REBUILT_ERROR = (
    *("motions", "sets", "f", "xi", "alpha", "threshold", "metric", "confidence", "trials", "tests"),
)


def validate(
    *,
    motions: Motions = None,
    sets: Sets = None,
    results: Results = None,
    ellipses: Ellipses = None,
    f: Frequencies = None,
    xi: DampingRatios = None,
    threshold: Threshold = None,
    metric: MetricName = "rms",
    window: WindowIfGiven = None,
    alpha: FractionIfGiven = None,
    scheme: Scheme = None,
    leave_out: LeaveOut = None,
    learn: Learn = None,
    judge: Judge = None,
    method: Methods = None,
    joint: Joint = None,
    law: Laws = None,
    confidence: Confidences = None,
    trials: Tests = None,
    calibration: Calibration = False,
    case: Case = None,
    integrator: IntegratorName = None,
    compensator: CompensatorName = None,
    rebuilt_error: RebuiltError = False,
    tests: TestsFile = None,
    json_target: JsonTarget = None,
) -> None:
    """Judge criteria on earthquakes that they were not learned from."""
    if rebuilt_error:
        from reliab.cli.rebuilt_error_mode import TRIALS, judge_by_rebuilt_error

        _refuse_beside("--rebuilt-error", locals(), _OF_REBUILT_ERROR)
        judge_by_rebuilt_error(
            motions,
            sets,
            frequencies=f or [1.0],
            damping_ratios=xi or [TWO_PERCENT],
            experimental_fraction=1.0 if alpha is None else alpha,
            threshold=FIVE_PERCENT if threshold is None else threshold,
            metric=metric,
            confidence=confidence,
            trials=trials or TRIALS,
            kept=tests,
            json_target=json_target,
        )
        return
    if case is not None:
        from reliab.cli.case_mode import judge_cases

        _refuse_beside("--case", locals(), ("motions", "sets", "integrator", "compensator"))
        judge_cases(
            motions,
            sets,
            case,
            integrator=integrator or "chen_ricles",
            compensator=compensator or "inverse",
            json_target=json_target,
        )
        return
    for option, value in (("--integrator", integrator), ("--compensator", compensator)):
        if value is not None:
            raise InputError(
                f"{option} is of the paper's cases", value=value, remedy="Give --case, or leave it out"
            )
    if tests is not None:
        raise InputError("--tests is of --rebuilt-error", value=tests, remedy="Give it too, or leave it out")
    from reliab.cli.validation_choice import Asked, candidates_of, folds_of, truth_of

    asked = Asked(
        scheme=scheme,
        leave_out=leave_out,
        learn=learn,
        judge=judge,
        method=method,
        joint=joint,
        law=law,
        confidence=confidence,
        threshold=FIVE_PERCENT if threshold is None else threshold,
        metric=metric,
    )
    _refuse_unused(asked, calibration=calibration)
    candidates = [] if calibration else candidates_of(asked)
    dataset = ellipse_dataset(
        motions=motions,
        sets=sets,
        results=results,
        ellipses=ellipses,
        f=f,
        xi=xi,
        threshold=[asked.threshold],
        metric=metric,
        window=window,
        alpha=alpha,
    )
    _require_structures(dataset, f, xi)
    truth = truth_of(dataset, motions, sets, results, ellipses)
    if calibration:
        _calibrate(dataset, asked, truth, trials or _TRIALS, json_target)
        return
    from reliab.cli.validation_answer import answer, show
    from reliab.validation.cross_validation import cross_validate

    folds, name, learn_from, recognised = folds_of(dataset, asked, motions, sets)
    with progress_bar("Cross-validating") as progress:
        validation = cross_validate(
            dataset,
            folds,
            candidates,
            scheme=name,
            confidences=asked.confidences,
            threshold=asked.threshold,
            metric=metric,
            truth=truth,
            trials=trials or _TRIALS,
            learn_from=learn_from,
            progress=progress,
        )
    content = answer(validation, dataset, recognised)
    if not write_json(content, json_target):
        show(content)


def _refuse_beside(option: str, values: dict[str, object], used: tuple[str, ...]) -> None:
    """Refuse options that another one leaves without effect."""
    from inspect import signature

    for name, parameter in signature(validate).parameters.items():
        gate = option.removeprefix("--").replace("-", "_")
        idle = name not in {*used, gate, "json_target"} and values[name] != parameter.default
        if idle:
            raise InputError(
                f"{option} takes {' and '.join(f'--{option_name}' for option_name in used)} alone",
                value=f"--{name.replace('_', '-')} beside it",
                remedy="Leave it out",
            )


def _require_structures(dataset: "xr.Dataset", f: list[float] | None, xi: list[float] | None) -> None:
    """Refuse to judge other structures than those that are asked for."""
    import math

    for name, wanted in (("f", f), ("xi", xi)):
        held = dataset[name].values.tolist()
        for value in wanted or []:
            if not any(math.isclose(value, stored, rel_tol=1e-9) for stored in held):
                raise InputError(
                    "Stored boundaries are judged at the structures that they hold",
                    value=f"--{name} {value:g}",
                    remedy=f"Choose among {', '.join(f'{stored:g}' for stored in held)}, or give --motions",
                )


def _refuse_unused(asked: "Asked", *, calibration: bool) -> None:
    """Refuse options that would have no effect on the answer."""
    divided = asked.learn is not None or asked.judge is not None
    idle = [("--scheme", asked.scheme is not None and divided, "--learn and --judge divide the motions")]
    if calibration:
        by_criteria = ("leave_out", "learn", "judge", "method", "joint", "law", "confidence")
        idle += [
            (
                f"--{name.replace('_', '-')}",
                getattr(asked, name) is not None,
                "--calibration judges no criteria",
            )
            for name in by_criteria
        ]
    for option, given, why in idle:
        if given:
            raise InputError(f"{option} has no effect here: {why}", value=option, remedy="Leave it out")


def _calibrate(
    dataset: "xr.Dataset", asked: "Asked", truth: "Truth", trials: int, json_target: str | None
) -> None:
    from reliab.cli.validation_answer import calibration_answer, show_calibration
    from reliab.cli.validation_choice import DEFAULT_SCHEME
    from reliab.validation.probability_calibration import probability_calibration

    scheme = asked.scheme or DEFAULT_SCHEME
    with progress_bar("Comparing probabilities") as progress:
        bins = probability_calibration(
            dataset,
            scheme=scheme,
            threshold=asked.threshold,
            metric=asked.metric,
            truth=truth,
            trials=trials,
            progress=progress,
        )
    content = calibration_answer(bins, scheme=scheme, truth=truth.name)
    if not write_json(content, json_target):
        show_calibration(content)
