"""`reliab compare`: tests ranked by their errors, such as one with each compensator."""

from typing import Any

from reliab.app import outputs, questions
from reliab.app.cli.commands import Asked, takes
from reliab.app.cli.output import console, progress_bar, say, table, write_json
from reliab.app.cli.test_files import files_of
from reliab.core.significant_digits import percent, significant
from reliab.core.vocabulary import PERCENT

_COLUMNS = {
    "": "right",
    "test": "left",
    "error": "right",
    "90 % interval": "right",
    "more than the first (90 % interval)": "right",
    "probability of that": "right",
    "A": "right",
    "d, ms": "right",
    "verdict": "left",
}


@takes(questions.StatedOfTest, outputs.Tests, outputs.Chart)
def compare(asked: Asked) -> None:
    """Rank tests by error and say how certain the ranking is.

    The tests are of one structure and rig, such as one motion with each compensator.
    """
    from reliab.app.api.assessment import assess
    from reliab.app.api.assessment_files import draw_chart, write_tests
    from reliab.app.api.comparison import compare_assessments

    files = files_of(asked.tests, asked.out)
    with progress_bar("tests") as progress:
        verdicts: Any = asked.ask(
            assess,
            *("tests", "out", "figure", "json_target"),
            test=files[0] if len(files) == 1 and asked.test_name == "all" else files,
            progress=progress,
        )
    comparison = compare_assessments(verdicts)
    if asked.out is not None:
        write_tests(comparison, asked.out)
    content = comparison.to_dict()
    content["faults"] = {file: asked.in_options(fault) for file, fault in content["faults"].items()}
    if not write_json(content, asked.json_target):
        _show(content)
    if asked.figure is not None:
        draw_chart(comparison, asked.figure)


def _show(content: dict[str, Any]) -> None:
    """Print the ranking, and below it what limits it."""
    asked = f"{content['metric'].upper()}, threshold {percent(content['threshold'])}"
    shown = table(f"{len(content['tests'])} tests by {asked}", _COLUMNS)
    for test in content["tests"]:
        shown.add_row(*_row(test, content["metric"]))
    terminal = console()
    terminal.print(shown)
    faults = (f"{file}: {why}" for file, why in content["faults"].items())
    say(*(content["assumed"], *content["notes"], *faults))


def _row(test: dict[str, Any], metric: str) -> list[str]:
    error, difference = test[metric], test["difference"]
    return [
        str(test["rank"]),
        test["file"],
        percent(error["value"], decimals=2),
        _interval(error),
        _interval(difference) if difference else "",
        significant(test["probability_larger"], 3) if difference else "",
        f"{test['A']:.4f}",
        f"{test['d_ms']:.3f}",
        test["verdict"].replace("_", " "),
    ]


def _interval(estimate: dict[str, float]) -> str:
    return f"{PERCENT * estimate['low']:.2f} … {percent(estimate['high'], decimals=2)}"
