"""`reliab validate`: whether criteria hold on motions that they have not seen."""

from collections.abc import Callable
from typing import Annotated, Any, TypedDict

from reliab.app import questions
from reliab.app.cli.commands import Asked, takes
from reliab.app.cli.output import progress_bar, say, show_table, write_json
from reliab.app.options import METHOD
from reliab.core.significant_digits import percent


class _Ways(TypedDict, total=False):
    calibration: Annotated[
        bool, METHOD.flag("Compare the stated probabilities with the shares of tests that are good.")
    ]


@takes(questions.Validation, _Ways)
def validate(asked: Asked) -> None:
    """Test criteria on earthquakes that they have not seen."""
    from reliab.app.api.validation import calibrate_probabilities, validate_criteria

    if asked.calibration:
        _answer(asked, "calibration", calibrate_probabilities, show_probabilities)
    else:
        _answer(asked, "", validate_criteria, show_criteria)


def _answer(
    asked: Asked,
    way: str,
    service: Callable[..., Any],
    show: Callable[[dict[str, Any]], None],
) -> None:
    """Ask for a way of judging; write and print what it answers."""
    why = f"together with `{way}`" if way else ""
    names = [*filter(None, ["json_target", way])]
    content = asked.ask(service, *names, why=why, show=progress_bar).to_dict()
    if not write_json(content, asked.json_target):
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
    title = (
        f"{content['scheme'].replace('_', ' ')}: {content['n_motions']} motions of {content['n_events']} "
        f"earthquakes, {content['metric'].upper()} {content['threshold']:g} over "
        f"{_window(content['window'])}"
    )
    show_table(title, _RATES, map(_rates, content["rows"]))
    if content["rows_lead"]:
        title = "The same for actuators that are early (leads)"
        show_table(title, _RATES, map(_rates, content["rows_lead"]))
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
        say(_ELLIPSE_NOTE)


def _rates(row: dict[str, Any]) -> tuple[str, ...]:
    return (
        row["candidate"],
        percent(row["confidence"], decimals=0),
        *(_interval(row["containment"]), _share(row["containment_by_ellipse"]["rate"])),
        *(_interval(row[name]) for name in ("false_safe", "accepted_share")),
    )


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
    rows = [
        (percent(row["stated"], decimals=1), _interval({**row, "rate": row["observed"]}), str(row["tests"]))
        for row in content["bins"]
    ]
    show_table(title, _BINS, rows)
    if content["truth"] == "ellipse":
        say(_ELLIPSE_NOTE)
