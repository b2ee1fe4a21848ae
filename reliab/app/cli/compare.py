"""`reliab compare`: tests ranked by their errors, such as one with each compensator."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from reliab.app.cli import options
from reliab.app.cli.completion import samples
from reliab.app.cli.demand import argument, option, takes
from reliab.app.cli.output import console, progress_bar, say, table, write_json
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


@dataclass(frozen=True, kw_only=True)
class CompareDemand(options.JudgesTests, options.ReadsTests):
    """Options of `reliab compare`: those of a verdict, and where the ranking goes."""

    tests: list[Path] | None = argument(
        "TEST TEST...",
        "Tests of one structure and rig, such as one motion with each compensator.",
        default=None,
        autocompletion=samples,
    )
    figure: Path | None = option(
        "FILE.svg|png|pdf", "Chart of the ranked errors.", callback=options.written_as(".svg", ".png", ".pdf")
    )
    out: Path | None = option(
        "FILE.csv", "Write the ranking as a table.", callback=options.written_as(".csv")
    )
    json_target: str | None = options.JSON_TARGET


@takes(CompareDemand)
def compare(demand: CompareDemand) -> None:
    """Rank tests, the one whose error is probably smallest first, and say how certain their order is."""
    from reliab.app.api.assessment import assess
    from reliab.app.api.assessment_files import draw_chart, write_tests
    from reliab.app.api.comparison import compare_assessments

    files = options.files_of(demand.tests, demand.out)
    with progress_bar("tests") as progress:
        verdicts: Any = demand.ask(
            assess,
            *("tests", "out", "figure", "json_target"),
            test=files[0] if len(files) == 1 and demand.test_name == "all" else files,
            f=options.only_value(demand.f, "f"),
            confidence=options.only_value(demand.confidence, "confidence"),
            progress=progress,
        )
    comparison = compare_assessments(verdicts)
    if demand.out is not None:
        write_tests(comparison, demand.out)
    content = comparison.to_dict()
    content["faults"] = {file: demand.in_options(fault) for file, fault in content["faults"].items()}
    if not write_json(content, demand.json_target):
        _show(content)
    if demand.figure is not None:
        draw_chart(comparison, demand.figure)


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
