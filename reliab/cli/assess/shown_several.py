"""What `reliab assess` prints about several tests: a table, and below it why a test is not reliable."""

from pathlib import Path
from typing import Any

from reliab.cli.output import console, table
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
        for sentence in _sentences(content):
            terminal.print(f"{content['file']}: {sentence}", highlight=False, markup=False)


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
