"""`reliab validate`: whether criteria hold on motions that they have not seen."""

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Annotated, Any, TypedDict

from reliab.app import questions
from reliab.app.cli.commands import Asked, takes
from reliab.app.cli.output import console, progress_bar, say, table, write_json
from reliab.app.options import METHOD
from reliab.core.significant_digits import percent, significant

if TYPE_CHECKING:
    from rich.table import Table


class _Ways(TypedDict, total=False):
    calibration: Annotated[
        bool, METHOD.flag("Compare the stated probabilities with the shares of tests that are good.")
    ]
    case: Annotated[
        str | None, METHOD.further("MOTION", "Run the paper's four cases under this motion instead.")
    ]
    rebuilt_error: Annotated[
        bool, METHOD.flag("Judge simulated tests by their rebuilt error, by criteria, and by boundaries.")
    ]


@takes(
    questions.RebuiltErrors,
    questions.PaperCases,
    questions.Validation,
    _Ways,
    needs={"integrator": "case", "compensator": "case", "tests": "rebuilt_error"},
)
def validate(asked: Asked) -> None:
    """Test criteria on earthquakes from which they were not learned."""
    from reliab.app.api.simulated_verdicts import judge_paper_cases, validate_rebuilt_error
    from reliab.app.api.validation import calibrate_probabilities, validate_criteria

    if asked.rebuilt_error:
        _answer(asked, "rebuilt_error", validate_rebuilt_error, show_rebuilt_errors)
    elif asked.case is not None:
        _answer(asked, "case", judge_paper_cases, show_cases)
    elif asked.calibration:
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
    bar = {} if way == "case" else {"show": progress_bar}
    why = f"together with `{way}`" if way else ""
    content = asked.ask(service, *filter(None, ["json_target", way]), why=why, **bar).to_dict()
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


_JUDGES = {
    "judge": "left",
    "tests": "right",
    "bad tests accepted": "right",
    "good tests accepted": "right",
    "motions without a bad test accepted": "right",
    "stated / true error, 5 … 95 %": "right",
    "inside 90 % interval": "right",
}


def show_rebuilt_errors(content: dict[str, Any]) -> None:
    """Print tables of the judges."""
    terminal = console()
    asked = f"{content['metric'].upper()}^R {significant(content['threshold'])}"
    terminal.print(_judges(f"Linear specimens, sensor of 40 dB, {asked}", content["judges"], "judge"))
    rebuilt = [row for row in content["conditions"] if row["judge"] == content["judges"][0]["judge"]]
    named = [{**row, "label": _condition(row)} for row in rebuilt]
    terminal.print(_judges("The rebuilt error by sensor and by what is stated wrongly", named, "label"))
    specimens = [{**row, "label": f"{row['specimen']}: {row['judge']}"} for row in content["specimens"]]
    terminal.print(_judges("Nonlinear specimens", specimens, "label"))
    say(
        *(
            f"Specimen “{row['specimen']}” ({row['sensor']}): looks nonlinear in "
            f"{percent(row['looks_nonlinear'], decimals=0)} of {row['tests']} tests."
            for row in content["looks"]
        )
    )


def _condition(row: dict[str, Any]) -> str:
    return row["sensor"] if row["stated"] == "right" else f"{row['sensor']}, {row['stated']}"


def _judges(title: str, rows: list[dict[str, Any]], label: str) -> Any:  # noqa: ANN401 - of rich
    shown = table(title, _JUDGES)
    for row in rows:
        shown.add_row(
            row[label],
            str(row["tests"]),
            *(_rate(row, "bad"), _rate(row, "good")),
            percent(row["contained"], decimals=0),
            "" if row["ratio_50"] is None else f"{row['ratio_05']:.3f} … {row['ratio_95']:.3f}",
            "" if row["covered"] is None else percent(row["covered"], decimals=0),
        )
    return shown


def _rate(row: dict[str, Any], kind: str) -> str:
    rate = row[f"{kind}_accepted"]
    return "none tried" if rate is None else f"{percent(rate, decimals=1)} of {row[kind]}"


_CASES = (
    *("case", "f [Hz]", "ξ [-]", "A [-]", "d [ms]", "criterion", "index", "accepted"),
    *("probability", "RMS^R [%]", "error below"),
)


def show_cases(content: Mapping[str, Any]) -> None:
    """Print the verdicts."""
    shown = table(f"The paper's cases under {content['motion']}", dict.fromkeys(_CASES, "right"))
    for row in content["cases"]:
        shown.add_row(
            *(str(row["case"]), f"{row['f']:g}", f"{row['xi']:g}", f"{row['A']:.4f}", f"{row['d_ms']:.3f}"),
            *(row["criterion"], significant(row["index"]), "yes" if row["accepted"] else "no"),
            "" if row["probability"] is None else f"{row['probability']:.3f}",
            *(f"{100.0 * row['rms']:.2f}", "yes" if row["good"] else "no"),
        )
    console().print(shown)
    event = content["held_out"]
    motions = f"without {event}" if event else "from all shipped motions"
    say(
        "RMS^R is the RMS of measured minus exact displacement over the peak of the exact one, in the first "
        f"{content['window']} s of the record. Integrator: {content['integrator']}; compensator: "
        f"{content['compensator']}. The recommended criterion was learned {motions}."
    )
