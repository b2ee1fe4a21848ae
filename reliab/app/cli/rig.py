"""`reliab rig`: the tests of a rig come, are listed, shown and removed; what they teach is asked."""

from collections.abc import Mapping
from dataclasses import MISSING, dataclass
from pathlib import Path
from typing import Any, ClassVar

import typer

from reliab.app.cli import options
from reliab.app.cli.demand import Demand, argument, option, takes
from reliab.app.cli.output import console, progress_bar, say, table, write_json, write_line
from reliab.core.errors import InputError
from reliab.core.significant_digits import percent, significant

app = typer.Typer(
    no_args_is_help=True, help="A laboratory's memory: keep a rig's tests, predict the next, notice drift."
)

RIG = argument("RIG", "Folder of the rig.")


@dataclass(frozen=True, kw_only=True)
class AddDemand(options.ReadsTests):
    """Options of `reliab rig add`, arguments of `reliab.add_to_rig`."""

    rig: Path = argument("RIG", "Folder of the rig, made where there is none.")
    tests: list[Path] = argument("FILE...", "Tests, in any format that `reliab assess` reads.")
    f: str | None = option("HZ", "Natural frequency, 1 or 1±0.01.")
    xi: str | None = options.STATED_DAMPING_RATIO
    alpha: str | None = options.STATED_SHARE
    scale: str | None = options.SENSOR_SCALE
    feedback_lag: str | None = options.FEEDBACK_LAG
    mass: str | None = options.MASS_OF_STRUCTURE
    skew: str | None = options.CHANNEL_SKEW
    equipment: Path | None = options.EQUIPMENT_FILE
    exact: bool = options.TAKEN_AS_EXACT
    criterion: Path | None = options.CRITERION_FILE
    structure: Path | None = options.STRUCTURE_FILE
    threshold: float | None = options.ERROR_THRESHOLD
    date: str | None = option("DATE", "When they were performed, 2026-03-01 or with a time.")
    event: str | None = option("TEXT", "Earthquake of their ground motion.")
    specimen: str | None = option("TEXT", "Specimen that was tested.")
    note: str | None = option("TEXT", "Further remarks.")
    covariate: list[str] | None = option(
        "NAME=NUMBER...", "Quantities on which the rig may depend, such as current=0.4."
    )
    json_target: str | None = options.JSON_TARGET

    idle_beside: ClassVar[Mapping[str, Any]] = {"structure": ("f", "xi", "alpha", "mass")}


@dataclass(frozen=True, kw_only=True)
class ListDemand(Demand):
    """Options of `reliab rig list`, arguments of `reliab.list_rig`."""

    rig: Path = RIG
    json_target: str | None = options.JSON_TARGET


@dataclass(frozen=True, kw_only=True)
class ShowDemand(Demand):
    """Options of `reliab rig show`, arguments of `reliab.show_rig_test`."""

    rig: Path = RIG
    test: str = argument("TEST", "Name of the test, or first digits of its checksum.")
    json_target: str | None = options.JSON_TARGET


@dataclass(frozen=True, kw_only=True)
class RemoveDemand(Demand):
    """Options of `reliab rig remove`, arguments of `reliab.remove_from_rig`."""

    rig: Path = RIG
    tests: list[str] = argument("TEST...", "Names, or first digits of checksums.")
    json_target: str | None = options.JSON_TARGET


@dataclass(frozen=True, kw_only=True)
class ExportDemand(Demand):
    """Options of `reliab rig export`, arguments of `reliab.export_rig`."""

    rig: Path = RIG
    out: Path = option("FILE.csv", "The table as CSV.", default=MISSING, callback=options.written_as(".csv"))
    json_target: str | None = options.JSON_TARGET


@app.command("add")
@takes(AddDemand)
def add(demand: AddDemand) -> None:
    """Judge tests and keep them: record, verdict and indices."""
    from reliab.app.api.rigs import add_to_rig

    with progress_bar("tests") as progress:
        outcome = demand.ask(add_to_rig, "json_target", show=progress)
    content = outcome.to_dict()
    content["faults"] = {file: demand.in_options(fault) for file, fault in content["faults"].items()}
    if not write_json(content, demand.json_target):
        show_added(content)
    if outcome.faults:
        raise InputError(
            "Every file must be a test that can be judged",
            value=f"{len(outcome.faults)} not judged: {', '.join(outcome.faults)}",
            remedy="Correct them as the reasons say, or leave them out; the other tests are in the rig",
        )


@app.command("list")
@takes(ListDemand)
def list_tests(demand: ListDemand) -> None:
    """List the tests of a rig, and where it has changed."""
    from reliab.app.api.rigs import list_rig

    listed = demand.ask(list_rig, "json_target")
    content = listed.to_dict()
    if not write_json(content, demand.json_target):
        show_list(content)


@app.command("show")
@takes(ShowDemand)
def show(demand: ShowDemand) -> None:
    """Show all that is kept of a test."""
    from reliab.app.api.rigs import show_rig_test

    content = demand.ask(show_rig_test, "json_target")
    if not write_json(content, demand.json_target):
        show_test(content)


@app.command("remove")
@takes(RemoveDemand)
def remove(demand: RemoveDemand) -> None:
    """Remove tests from a rig."""
    from reliab.app.api.rigs import remove_from_rig

    removed = demand.ask(remove_from_rig, "json_target")
    if not write_json({"removed": list(removed)}, demand.json_target):
        write_line(f"Removed: {', '.join(removed)}.")


@app.command("export")
@takes(ExportDemand)
def export(demand: ExportDemand) -> None:
    """Write the table of a rig's tests as CSV."""
    from reliab.app.api.rigs import export_rig

    tests = demand.ask(export_rig, "json_target")
    if not write_json({"out": str(demand.out), "tests": tests}, demand.json_target):
        write_line(f"{tests} tests written to {demand.out}")


@dataclass(frozen=True, kw_only=True)
class OfNextTest(Demand):
    """Options about the structure of the next test, and the error that it may have."""

    f: str | None = option("HZ", "Natural frequency.")
    xi: str | None = option("RATIO", "Damping ratio, 0.02 by default.")
    alpha: str | None = option("SHARE", "Share of the stiffness in the laboratory, 1 by default.")
    threshold: float | None = options.ERROR_THRESHOLD


@dataclass(frozen=True, kw_only=True)
class PredictDemand(OfNextTest):
    """Options of `reliab rig predict`, arguments of `reliab.predict_rig`."""

    rig: Path = RIG
    structure: Path | None = options.STRUCTURE_FILE
    motion: Path | None = option(
        "FILE", "Ground motion of the next test, simulated with actuators drawn from the posterior."
    )
    suite: str | None = option(
        "NAME", "Suite of which the next motion may be any: real_suite, synthetic, or a folder."
    )
    date: str | None = option("DATE", "Date of the next test; after the last test by default.")
    specimen: str | None = option("TEXT", "Specimen of the next test; by default that of the last test.")
    covariate: list[str] | None = option(
        "NAME=NUMBER...", "Quantities of the next test that all tests have, such as peak_mm=40."
    )
    json_target: str | None = options.JSON_TARGET


@app.command("predict")
@takes(PredictDemand)
def predict(demand: PredictDemand) -> None:
    """Predict the next test: A, d and error with their intervals, and the probability that it is good."""
    from reliab.app.api.rig_answers import predict_rig

    content = demand.ask(predict_rig, "json_target").to_dict()
    if not write_json(content, demand.json_target):
        show_prediction(content)


@dataclass(frozen=True, kw_only=True)
class RigReportDemand(options.Reported):
    """Options of `reliab rig report`, arguments of `reliab.report_rig`."""

    rig: Path = RIG
    out: Path = option("FILE.pdf", "The report.", default=MISSING, callback=options.written_as(".pdf"))
    f: str | None = option("HZ", "Natural frequency; by default that of the last test.")
    xi: str | None = option("RATIO", "Damping ratio; by default that of the last test.")
    alpha: str | None = option(
        "SHARE", "Share of the stiffness in the laboratory; by default that of the last test."
    )
    threshold: float | None = option(
        "ERROR", "Largest acceptable error of the whole test; by default that of the last test."
    )
    json_target: str | None = options.JSON_TARGET


@app.command("report")
@takes(RigReportDemand)
def report(demand: RigReportDemand) -> None:
    """Write two pages on what the rig does and what to expect of its next test, and an appendix."""
    from reliab.app.api.rig_answers import report_rig

    written = demand.ask(report_rig, *options.OF_REPORT, "json_target", setting=demand.setting)
    if not write_json({"report": str(written)}, demand.json_target):
        write_line(f"Report: {written}")


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
        _say(f"Already in the rig: {', '.join(content['present'])}.")
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


def show_prediction(content: Mapping[str, Any]) -> None:
    """Print what is predicted of the next test."""
    from_what = f"{content['tests']} tests of {content['earthquakes']} earthquakes"
    rows = table(
        f"The next test of {content['rig']}, from {from_what}",
        {"": "left", "5 %": "right", "median": "right", "95 %": "right"},
    )
    ends = ("low", "median", "high")
    rows.add_row("A", *(f"{content['A'][end]:.4f}" for end in ends))
    rows.add_row("d [ms]", *(f"{content['d_ms'][end]:.2f}" for end in ends))
    rows.add_row("remainder", *(percent(content["remainder"][end]) for end in ends))
    rows.add_row("error RMS^R", *(percent(content["rms"][end]) for end in ends))
    console().print(rows)
    shares = ", ".join(f"{name} {percent(share, 2)}" for name, share in content["drivers"].items())
    _say(
        f"Probability {content['probability']:.2f} that the error stays below "
        f"{percent(content['threshold'])}. "
        f"Contributions to its square: {shares}."
    )
    _say(f"By {content['basis']}.")
    scores = ", ".join(
        f"{name} {'unknown' if score is None else significant(score)}"
        for name, score in content["log_scores"].items()
    )
    _say(f"Log scores on earthquakes left out: {scores}. Best: {content['better']}.")
    worst = max(item["r_hat"] for item in content["sampling"].values())
    least = min(item["effective_size"] for item in content["sampling"].values())
    _say(f"Posterior of the variances: R-hat at most {worst:.3f}, at least {least:.0f} independent draws.")
    for note in content["notes"]:
        _say(f"Note: {note}")


def _say(text: str) -> None:
    say(text, soft_wrap=True)
