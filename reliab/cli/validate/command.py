"""`reliab validate`: whether criteria hold on motions that they have not seen."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from reliab.cli.completion import laws, methods
from reliab.cli.demand import Demand, flag, option, takes
from reliab.cli.options import (
    DAMPING_RATIOS,
    ELLIPSES,
    FRACTIONS,
    FREQUENCIES,
    JSON_TARGET,
    METRIC_NAME,
    MOTIONS,
    RESULTS,
    SETS,
    WINDOW_IF_GIVEN,
)
from reliab.cli.output import progress_bar, write_json


@dataclass(frozen=True, kw_only=True)
class ValidateDemand(Demand):
    """Options of `reliab validate`; each way of judging is a function that takes some of them."""

    motions: list[str] | None = MOTIONS
    sets: list[str] | None = SETS
    results: Path | None = RESULTS
    ellipses: Path | None = ELLIPSES
    f: list[float] | None = FREQUENCIES
    xi: list[float] | None = DAMPING_RATIOS
    threshold: float | None = option("ERROR", "Error, 0.05 for 5 %, the default.")
    metric: str = METRIC_NAME
    window: str | None = WINDOW_IF_GIVEN
    alpha: list[float] | None = FRACTIONS
    scheme: str | None = option(
        "NAME",
        "How motions are divided: leave_one_event_out (default), k_fold or random_halves of "
        "earthquakes; region, magnitude or length: each class of them left out.",
    )
    leave_out: str | None = option("f|xi", "Also leave out each frequency or damping ratio in turn.")
    learn: list[str] | None = option(
        "SET...", "Sets of --motions to learn from, or real_suite: the shipped results of 100 real motions."
    )
    judge: list[str] | None = option(
        "SET...", "Sets of --motions to judge; all of them with --learn real_suite."
    )
    method: list[str] | None = option(
        "NAME...",
        "What the confidence means, one or several methods; dirichlet by default.",
        autocompletion=methods,
    )
    joint: bool | None = option(
        "",
        "Whether the confidence holds for a and b together or for each of them separately; by "
        "default as the method defines it.",
        name="--joint/--each",
    )
    law: list[str] | None = option(
        "NAME...", "Fitted or printed laws; table and printed by default.", autocompletion=laws
    )
    confidence: list[float] | None = option("SHARE...", "Stated shares of the motions.")
    trials: int | None = option(
        "",
        "Tests per structure, near the boundaries, 512 by default; with --rebuilt-error, tests of "
        "each kind of actuator and specimen, 6 by default.",
        min=1,
    )
    calibration: bool = flag("Compare the stated probabilities with the shares of tests that are good.")
    case: str | None = option("MOTION", "Run the paper's four cases under this motion instead.")
    integrator: str | None = option(
        "NAME", "For --case: chen_ricles (the paper's), central_difference, operator_splitting or exact."
    )
    compensator: str | None = option(
        "NAME", "For --case: inverse (the paper's), feedforward, polynomial_extrapolation or none."
    )
    rebuilt_error: bool = flag(
        "Judge simulated tests by their rebuilt error, by criteria, and by the boundary of the test's motion."
    )
    tests: Path | None = option(
        "FILE.csv",
        "For --rebuilt-error: file of all tests and verdicts, from which an interrupted run resumes.",
    )
    json_target: str | None = JSON_TARGET

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
