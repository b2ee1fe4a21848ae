"""`reliab validate`: whether criteria hold on motions that they have not seen."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from reliab.app.cli import options
from reliab.app.cli.completion import laws, methods
from reliab.app.cli.demand import Demand, flag, option, takes
from reliab.app.cli.output import console, progress_bar, say, table, write_json
from reliab.core.significant_digits import percent

if TYPE_CHECKING:
    from rich.table import Table


@dataclass(frozen=True, kw_only=True)
class ValidateDemand(Demand):
    """Options of `reliab validate`; each way of judging is a function that takes some of them."""

    motions: list[str] | None = options.MOTIONS
    sets: list[str] | None = options.SETS
    results: Path | None = options.RESULTS
    ellipses: Path | None = options.ELLIPSES
    f: list[float] | None = options.FREQUENCIES
    xi: list[float] | None = options.DAMPING_RATIOS
    threshold: float | None = option(
        "ERROR", "Largest acceptable error of the whole test, 0.05 (5 %) by default."
    )
    metric: str = options.METRIC_NAME
    window: str | None = options.WINDOW_IF_GIVEN
    alpha: list[float] | None = options.FRACTIONS
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
    confidence: list[float] | None = option("SHARE...", "Shares of the motions that the criteria state.")
    trials: int | None = option(
        "",
        "Tests per structure, near the boundaries, 512 by default.",
        min=1,
    )
    calibration: bool = flag("Compare the stated probabilities with the shares of tests that are good.")
    json_target: str | None = options.JSON_TARGET


@takes(ValidateDemand)
def validate(demand: ValidateDemand) -> None:
    """Test criteria on earthquakes from which they were not learned."""
    from reliab.app.api.validation import calibrate_probabilities, validate_criteria

    if demand.calibration:
        _answer(demand, "calibration", calibrate_probabilities, show_probabilities)
    else:
        _answer(demand, "", validate_criteria, show_criteria)


def _answer(
    demand: ValidateDemand,
    way: str,
    service: Callable[..., Any],
    show: Callable[[dict[str, Any]], None],
) -> None:
    """Ask for a way of judging; write and print what it answers."""
    why = f"together with `{way}`" if way else ""
    content = demand.ask(service, *filter(None, ["json_target", way]), why=why, show=progress_bar).to_dict()
    if not write_json(content, demand.json_target):
        show(content)


_RATES = {
    "criterion": "left",
    "stated": "right",
    "contained (95 % interval)": "right",
    "by ellipses": "right",
    "false-safe": "right",
    "good tests accepted": "right",
}
_BINS = {
    "stated probability": "right",
    "good tests (95 % interval)": "right",
    "tests": "right",
}
_ELLIPSE_NOTE = (
    "Note: without --motions or --results no simulated errors are known; the motions' own ellipses "
    "decide what is contained and which tests are good."
)


def show_criteria(content: dict[str, Any]) -> None:
    """Print the rates of criteria."""
    terminal = console()
    title = (
        f"{content['scheme'].replace('_', ' ')}: {content['n_motions']} motions of {content['n_events']} "
        f"earthquakes, {content['metric'].upper()} {content['threshold']:g} over "
        f"{_window(content['window'])}"
    )
    terminal.print(_rates(title, content["rows"]))
    if content["rows_lead"]:
        terminal.print(_rates("The same for actuators that are early (leads)", content["rows_lead"]))
    say(f"Judged on {content['judged_on']}:")
    say(*[*content["outside"], *content["sentences"]])
    if content["n_of_learned_earthquakes"]:
        say(
            f"{content['n_of_learned_earthquakes']} of the motions are of earthquakes that the suite holds; "
            "each was judged by what was learned from the other earthquakes."
        )
    say(
        *(
            f"{missing['candidate']} at {percent(missing['confidence'], decimals=0)} is not judged: "
            "there are too few motions or earthquakes for it."
            for missing in content["not_carried"]
        )
    )
    if content["unresolved"]:
        say(
            f"Not judged, because a criterion reaches beyond the stored results: {content['unresolved']} "
            "times."
        )
    if content["truth"] == "ellipse":
        terminal.print(_ELLIPSE_NOTE)


def _rates(title: str, rows: list[dict[str, Any]]) -> "Table":
    shown = table(title, _RATES)
    for row in rows:
        shown.add_row(
            row["candidate"],
            percent(row["confidence"], decimals=0),
            *(_interval(row["containment"]), _share(row["containment_by_ellipse"]["rate"])),
            *(_interval(row[name]) for name in ("false_safe", "accepted_share")),
        )
    return shown


def _window(label: str) -> str:
    lengths = {
        "record": "whole records",
        "arias": "5-95 % of the Arias intensity",
        "unknown": "an unknown window",
    }
    return lengths.get(label, f"the first {label} s")


def _share(value: float | None) -> str:
    return "none" if value is None else percent(value, decimals=1)


def _interval(rate: dict[str, float | None]) -> str:
    """Write a rate with its interval.

    `rate` [-].
    """
    value, low, high = rate["rate"], rate["low"], rate["high"]
    if value is None:
        return "none"
    if low is None or high is None:
        return percent(value, decimals=1)
    return f"{percent(value, decimals=1)} ({percent(low, decimals=1)} … {percent(high, decimals=1)})"


def show_probabilities(content: dict[str, Any]) -> None:
    """Print how many tests are good for which probability."""
    title = f"Probabilities of tests, {content['scheme'].replace('_', ' ')}"
    shown = table(title, _BINS)
    for row in content["bins"]:
        rate = {"rate": row["observed"], "low": row["low"], "high": row["high"]}
        shown.add_row(percent(row["stated"], decimals=1), _interval(rate), str(row["tests"]))
    console().print(shown)
    if content["truth"] == "ellipse":
        console().print(_ELLIPSE_NOTE)
