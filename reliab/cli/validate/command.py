"""`reliab validate`: whether criteria hold on motions that they have not seen."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, ClassVar

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
    Motions,
    Results,
    Sets,
    WindowIfGiven,
)
from reliab.cli.output import progress_bar, write_json


@dataclass(frozen=True, kw_only=True)
class ValidateDemand(Demand):
    """Options of `reliab validate`; each way of judging is a function that takes some of them."""

    motions: Motions = None
    sets: Sets = None
    results: Results = None
    ellipses: Ellipses = None
    f: Frequencies = None
    xi: DampingRatios = None
    threshold: Annotated[
        float | None, typer.Option("--threshold", metavar="ERROR", help="Error, 0.05 for 5 %, the default.")
    ] = None
    metric: MetricName = "rms"
    window: WindowIfGiven = None
    alpha: Fractions = None
    scheme: Annotated[
        str | None,
        typer.Option(
            "--scheme",
            metavar="NAME",
            help="How motions are divided: leave_one_event_out (default), k_fold or random_halves of "
            "earthquakes; region, magnitude or length: each class of them left out.",
        ),
    ] = None
    leave_out: Annotated[
        str | None,
        typer.Option(
            "--leave-out", metavar="f|xi", help="Also leave out each frequency or damping ratio in turn."
        ),
    ] = None
    learn: Annotated[
        list[str] | None,
        typer.Option(
            "--learn",
            metavar="SET...",
            help="Sets of --motions to learn from, or real_suite: the shipped results of 100 real motions.",
        ),
    ] = None
    judge: Annotated[
        list[str] | None,
        typer.Option(
            "--judge",
            metavar="SET...",
            help="Sets of --motions to judge; all of them with --learn real_suite.",
        ),
    ] = None
    method: Annotated[
        list[str] | None,
        typer.Option(
            "--method",
            autocompletion=methods,
            metavar="NAME...",
            help="What the confidence means, one or several methods; dirichlet by default.",
        ),
    ] = None
    joint: Annotated[
        bool | None,
        typer.Option(
            "--joint/--each",
            help="Whether the confidence holds for a and b together or for each of them separately; by "
            "default as the method defines it.",
        ),
    ] = None
    law: Annotated[
        list[str] | None,
        typer.Option(
            "--law",
            autocompletion=laws,
            metavar="NAME...",
            help="Fitted or printed laws; table and printed by default.",
        ),
    ] = None
    confidence: Annotated[
        list[float] | None,
        typer.Option("--confidence", metavar="SHARE...", help="Stated shares of the motions."),
    ] = None
    trials: Annotated[
        int | None,
        typer.Option(
            "--trials",
            min=1,
            help="Tests per structure, near the boundaries, 512 by default; with --rebuilt-error, tests of "
            "each kind of actuator and specimen, 6 by default.",
        ),
    ] = None
    calibration: Annotated[
        bool,
        typer.Option(
            "--calibration",
            help="Compare the stated probabilities with the shares of tests that are good.",
        ),
    ] = False
    case: Annotated[
        str | None,
        typer.Option(
            "--case", metavar="MOTION", help="Run the paper's four cases under this motion instead."
        ),
    ] = None
    integrator: Annotated[
        str | None,
        typer.Option(
            "--integrator",
            metavar="NAME",
            help="For --case: chen_ricles (the paper's), central_difference, operator_splitting or exact.",
        ),
    ] = None
    compensator: Annotated[
        str | None,
        typer.Option(
            "--compensator",
            metavar="NAME",
            help="For --case: inverse (the paper's), feedforward, polynomial_extrapolation or none.",
        ),
    ] = None
    rebuilt_error: Annotated[
        bool,
        typer.Option(
            "--rebuilt-error",
            help="Judge simulated tests by their rebuilt error, by criteria, and by the boundary of the "
            "test's motion.",
        ),
    ] = False
    tests: Annotated[
        Path | None,
        typer.Option(
            "--tests",
            metavar="FILE.csv",
            help="For --rebuilt-error: file of all tests and verdicts, from which an interrupted run "
            "resumes.",
        ),
    ] = None
    json_target: JsonTarget = None

    belongs_to: ClassVar[Mapping[str, str]] = {
        "integrator": "case",
        "compensator": "case",
        "tests": "rebuilt_error",
    }


@takes(ValidateDemand)
def validate(demand: ValidateDemand) -> None:
    """Judge criteria on earthquakes that they were not learned from."""
    from reliab import api
    from reliab.cli.validate.shown_cases import show_cases
    from reliab.cli.validate.shown_rates import show_criteria, show_probabilities
    from reliab.cli.validate.shown_rebuilt_errors import show_rebuilt_errors

    if demand.rebuilt_error:
        _answer(demand, "rebuilt_error", api.validate_rebuilt_error, show_rebuilt_errors)
    elif demand.case is not None:
        _answer(demand, "case", api.judge_paper_cases, show_cases)
    elif demand.calibration:
        _answer(demand, "calibration", api.calibrate_probabilities, show_probabilities)
    else:
        _answer(demand, "", api.validate_criteria, show_criteria)


def _answer(
    demand: ValidateDemand,
    way: str,
    service: Callable[..., Any],
    show: Callable[[dict[str, Any]], None],
) -> None:
    """Ask for a way of judging; write and print what it answers."""
    bar = {} if way == "case" else {"show": progress_bar}
    why = f"beside `{way}`" if way else ""
    content = demand.ask(service, *filter(None, ["json_target", way]), why=why, **bar).to_dict()
    if not write_json(content, demand.json_target):
        show(content)
