"""What `reliab assess` prints about several tests: a table, and below it why a test is not reliable."""

from pathlib import Path
from typing import Any

from reliab.cli.output import console, say, table
from reliab.significant import percent
from reliab.vocabulary import PERCENT

_COLUMNS = {
    "test": "left",
    "verdict": "left",
    "error": "right",
    "90 % interval": "right",
    "probability": "right",
    "A": "right",
    "d, ms": "right",
}


def show_several(contents: list[dict[str, Any]]) -> None:
    """Print the verdicts of tests."""
    judged = [content for content in contents if "fault" not in content]
    asked = f", {judged[0]['metric'].upper()} against {percent(judged[0]['threshold'])}" if judged else ""
    shown = table(f"Verdicts on {len(contents)} tests{asked}", _COLUMNS)
    for content in contents:
        shown.add_row(*_row(content))
    terminal = console()
    terminal.print(shown)
    for content in contents:
        say(*(f"{content['file']}: {sentence}" for sentence in _sentences(content)))


def show_same_test(content: dict[str, Any]) -> None:
    """Print the verdicts on runs of one test."""
    from reliab.assessment import probability_text

    asked = f"{content['metric'].upper()} against {percent(content['threshold'])}"
    columns = {"run": "left", "verdict": "left", "gain": "right", "d, ms": "right"}
    columns |= dict.fromkeys(("alone", "all runs", "90 % interval", "probability"), "right")
    shown = table(f"{len(content['runs'])} runs of one test, {asked}", columns)
    for run in content["runs"]:
        ends = (percent(run["error"][end], decimals=2) for end in ("low", "high"))
        shown.add_row(
            run["file"],
            run["verdict"].replace("_", " "),
            f"{run['gain']:.3f}",
            f"{run['d_ms']:.2f}",
            *(percent(run[way]["value"], decimals=2) for way in ("alone", "error")),
            " to ".join(ends),
            probability_text(run["probability"]),
        )
    terminal = console()
    terminal.print(shown)
    say(*content["warnings"])


def _row(content: dict[str, Any]) -> list[str]:
    if "fault" in content:
        return [content["file"], "not judged", *[""] * (len(_COLUMNS) - 2)]
    from reliab.assessment import probability_text

    error = content["error"][content["metric"]]
    return [
        content["file"],
        content["verdict"].replace("_", " "),
        percent(error["value"], decimals=2),
        f"{PERCENT * error['low']:.2f} … {percent(error['high'], decimals=2)}",
        probability_text(content["probability"]),
        f"{content['A']:.5f}",
        f"{content['d_ms']:.4f}",
    ]


def _sentences(content: dict[str, Any]) -> list[str]:
    """Say below the table why a test is not reliable or not judged."""
    if "fault" in content:
        return [content["fault"].removeprefix(f"{Path(content['file']).name}: ")]
    warnings = [f"Warning: {warning}" for warning in content["warnings"]]
    return warnings if content["reliable"] else [*content["reasons"], *warnings]
