"""What `reliab validate --rebuilt-error` prints: how often each judge of simulated tests is right."""

from typing import Any

from reliab.cli.output import console, say, table
from reliab.significant import percent, significant

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
    terminal.print(_table(f"Linear specimens, sensor of 40 dB, {asked}", content["judges"], "judge"))
    rebuilt = [row for row in content["conditions"] if row["judge"] == content["judges"][0]["judge"]]
    named = [{**row, "label": _condition(row)} for row in rebuilt]
    terminal.print(_table("The rebuilt error by sensor and by what is stated wrongly", named, "label"))
    specimens = [{**row, "label": f"{row['specimen']}: {row['judge']}"} for row in content["specimens"]]
    terminal.print(_table("Nonlinear specimens", specimens, "label"))
    say(
        *(
            f"Specimen “{row['specimen']}” ({row['sensor']}): looks nonlinear in "
            f"{percent(row['looks_nonlinear'], decimals=0)} of {row['tests']} tests."
            for row in content["looks"]
        )
    )


def _condition(row: dict[str, Any]) -> str:
    return row["sensor"] if row["stated"] == "right" else f"{row['sensor']}, {row['stated']}"


def _table(title: str, rows: list[dict[str, Any]], label: str) -> Any:  # noqa: ANN401 - of rich
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
