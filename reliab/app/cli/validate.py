"""`reliab validate`: whether criteria hold on motions that they have not seen."""

from typing import Any

from reliab.app import questions
from reliab.app.cli.commands import Request, takes
from reliab.app.cli.output import say, show_rows
from reliab.app.declaration import single
from reliab.app.options import METHOD
from reliab.core.significant_digits import percent
from reliab.core.vocabulary import ERROR_NAMES, Metric

_CALIBRATION = single(
    "calibration",
    bool,
    METHOD.flag(),
    "Compare the stated probabilities with the shares of tests that are good.",
)


@takes(questions.ValidationQuestion, _CALIBRATION)
def validate(request: Request) -> None:
    """Test criteria on earthquakes that they have not seen."""
    from reliab.app.api.validation import calibrate_probabilities, validate_criteria

    if request.calibration:
        request.answer(
            calibrate_probabilities,
            lambda result: show_probabilities(result.to_dict()),
            "calibration",
            reason="together with `calibration`",
        )
    else:
        request.answer(validate_criteria, lambda result: show_criteria(result.to_dict()))


_ELLIPSE_NOTE = (
    "Note: without --motions or --results no simulated errors are known; the motions' own ellipses "
    "decide what is contained and which tests are good."
)


def show_criteria(content: dict[str, Any]) -> None:
    """Print the rates of criteria."""
    from reliab.app.api.validation import Validation

    title = (
        f"{content['scheme'].replace('_', ' ')}: {content['n_motions']} motions of {content['n_events']} "
        f"earthquakes, {ERROR_NAMES[Metric(content['metric'])]} {content['threshold']:g} over "
        f"{_window(content['window'])}"
    )
    show_rows(title, Validation.table_columns, content["rows"])
    if content["rows_lead"]:
        title = "The same for actuators that are early (leads)"
        show_rows(title, Validation.table_columns, content["rows_lead"])
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


def _window(label: str) -> str:
    lengths = {
        "record": "whole records",
        "arias": "5-95 % of the Arias intensity",
        "unknown": "an unknown window",
    }
    return lengths.get(label, f"the first {label} s")


def show_probabilities(content: dict[str, Any]) -> None:
    """Print how many tests are good for which probability."""
    from reliab.app.api.validation import ProbabilityCalibration

    title = f"Probabilities of tests, {content['scheme'].replace('_', ' ')}"
    show_rows(title, ProbabilityCalibration.table_columns, content["bins"])
    if content["truth"] == "ellipse":
        say(_ELLIPSE_NOTE)
