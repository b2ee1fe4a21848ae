"""The tests of a rig on the terminal."""

from collections.abc import Mapping
from typing import Any

from reliab.cli.output import console, say, table
from reliab.significant import percent, significant

_LAST = 40
_HEADINGS = {
    "test": "left",
    "SHA-256": "left",
    "date": "left",
    "event": "left",
    "A": "right",
    "d [ms]": "right",
    "remainder": "right",
    "error": "right",
    "verdict": "left",
    "change": "left",
}


def show_added(content: Mapping[str, Any]) -> None:
    """Say what became of the files."""
    _show_rows(f"Tests added to {content['rig']}: {len(content['added'])}", content["added"])
    _say(f"Tests in the rig: {content['tests']}.")
    if content["present"]:
        _say(f"There already: {', '.join(content['present'])}.")
    for file, fault in content["faults"].items():
        _say(f"Not judged: {file}: {fault}")


def show_list(content: Mapping[str, Any]) -> None:
    """Print the last tests; JSON and the exported table hold all."""
    rows = content["tests"]
    last = rows[-_LAST:]
    title = f"Tests of {content['rig']}: {len(rows)}"
    _show_rows(title if len(last) == len(rows) else f"{title}, the last {len(last)}", last)
    for file, fault in content["faults"].items():
        _say(f"Left out: {file}: {fault}")


def show_test(content: Mapping[str, Any]) -> None:
    """Print a test with what was stated and found."""
    test = content["test"]
    _show_rows(test["name"], [test])
    stated = ", ".join(f"{name} {text}" for name, text in content["terms"].items())
    _say(f"Stated: {stated or 'nothing'}.")
    for reason in content["assessment"].get("reasons", []):
        _say(reason)
    _say(f"Record: {content['record']}")


def _show_rows(title: str, rows: list[dict[str, Any]]) -> None:
    from rich.text import Text

    if not rows:
        _say(f"{title}.")
        return
    shown_rows = table(title, _HEADINGS)
    for row in rows:
        error = "" if row["rms"] is None else percent(row["rms"])
        cells = (
            *(row["name"], row["sha256"][:8], row["date"][:10], row["event"]),
            *(f"{row['A']:.4f}", f"{row['d_ms']:.2f}", significant(row["remainder"]), error),
            *(row["verdict"].replace("_", " "), row.get("change") or ""),
        )
        shown_rows.add_row(*(Text(cell) for cell in cells))
    console().print(shown_rows)


def _say(text: str) -> None:
    say(text, soft_wrap=True)
