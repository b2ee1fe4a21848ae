"""``reliab motions``: list, check, import and synthesize ground motions."""

from collections.abc import Sequence
from dataclasses import MISSING, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from reliab.app.cli.demand import Demand, argument, option, takes
from reliab.app.cli.options import JSON_TARGET, SETS
from reliab.app.cli.output import console, say, write_json
from reliab.app.cli.printable import printable
from reliab.core.significant_digits import counted, significant

if TYPE_CHECKING:
    from reliab.app.api.motions import WrittenSuite
    from reliab.motions.faults import Fault

app = typer.Typer(no_args_is_help=True, help="Ground motions: list, check, import and synthesize.")

OUT = option("FOLDER", "New or empty folder for the suite.", default=MISSING)


@dataclass(frozen=True, kw_only=True)
class MotionsDemand(Demand):
    """Options of `reliab motions list` and `check`, arguments of `reliab.app.api.list_motions`."""

    sources: list[str] = argument("SOURCE...", "Files, folders or a built-in suite (synthetic).")
    sets: list[str] | None = SETS
    time_step: float | None = option("SECONDS", "Time step of records that state none.")
    units: str | None = option("g|cm/s2|m/s2", "Unit of records that state none.")
    json_target: str | None = JSON_TARGET


@dataclass(frozen=True, kw_only=True)
class ImportDemand(MotionsDemand):
    """Options of `reliab motions import`, arguments of `reliab.app.api.import_motions`."""

    out: Path = OUT
    event: str | None = option("", "Earthquake to which all imported motions belong.")


@dataclass(frozen=True, kw_only=True)
class SynthesizeDemand(Demand):
    """Options of `reliab motions synthesize`, arguments of `reliab.app.api.synthesize_motions`."""

    out: Path = OUT
    count: int = option("", "Number of components.", default=100, min=2)
    seed: int | None = option("", "Seed of a suite other than the built-in one.", min=0)
    json_target: str | None = JSON_TARGET


@app.command("list")
@takes(MotionsDemand)
def list_motions(demand: MotionsDemand) -> None:
    """List motions with their events and measures of intensity."""
    from reliab.app.api.motions import list_motions as api_list_motions

    listed = demand.ask(api_list_motions, "json_target")
    content = listed.to_dict()
    if not write_json(content, demand.json_target):
        _show_motions(content["motions"])
        for fault in listed.faults:
            line = "" if fault.line is None else f", line {fault.line}"
            value = f"; found {fault.value}" if fault.value else ""
            text = (
                f"Left out: {_within(fault.file, demand.sources)}{line}: {fault.rule}{value}. {fault.remedy}."
            )
            say(demand.in_options(text), style="yellow", soft_wrap=True)
        _show_notes(listed.skipped, demand.sources)


@app.command("check")
@takes(MotionsDemand)
def check(demand: MotionsDemand) -> None:
    """Read every record; report all faults (exit code 2), and note what deserves a look."""
    from reliab.app.api.motions import check_motions

    checked = demand.ask(check_motions, "json_target")
    if not write_json(checked.to_dict(), demand.json_target):
        faults = [replace(fault, remedy=demand.in_options(fault.remedy)) for fault in checked.faults]
        _show_faults(faults, checked.records, demand.sources)
        _show_notes(checked.notes, demand.sources)
    if checked.faults:
        raise typer.Exit(2)


@app.command("import")
@takes(ImportDemand)
def import_motions(demand: ImportDemand) -> None:
    """Rewrite motions as a suite: one text format in m/s² and a catalogue."""
    from reliab.app.api.motions import import_motions as api_import_motions

    _say_written(demand.ask(api_import_motions, "json_target"), demand.json_target)


@app.command("synthesize")
@takes(SynthesizeDemand)
def synthesize(demand: SynthesizeDemand) -> None:
    """Write the synthetic suite, which needs no record."""
    from reliab.app.api.motions import synthesize_motions

    _say_written(demand.ask(synthesize_motions, "json_target"), demand.json_target)


def _say_written(written: "WrittenSuite", json_target: str | None) -> None:
    if not write_json(written.to_dict(), json_target):
        folder = written.catalogue.parent
        motions, events = counted(len(written.motions), "motion"), counted(written.events, "event")
        say(f"{motions} from {events} written to {folder}", soft_wrap=True)


def _show_motions(rows: list[dict[str, Any]]) -> None:
    from rich import box
    from rich.table import Table
    from rich.text import Text

    events = {row["event"] for row in rows}
    table = Table(
        title=f"{counted(len(rows), 'motion')} from {counted(len(events), 'event')}",
        box=box.SIMPLE,
        padding=(0, 1, 0, 0),
    )
    for heading in ("motion", "event", "set"):
        table.add_column(heading, overflow="fold", no_wrap=heading == "motion")
    for heading in ("dt [s]", "T [s]", "PGA [g]", "I_A [m/s]", "D5-95 [s]", "T_m [s]"):
        table.add_column(Text(heading), justify="right", no_wrap=True)
    for row in rows:
        table.add_row(
            *(Text(printable(row[label])) for label in ("motion", "event", "set")),
            f"{row['time_step']:.5g}",
            f"{row['duration']:.2f}",
            f"{row['pga_g']:.4f}",
            significant(row["arias_intensity"]),
            f"{row['significant_duration']:.2f}",
            f"{row['mean_period']:.3f}",
        )
    console().print(table)


def _show_faults(faults: "Sequence[Fault]", records: int, sources: Sequence[str]) -> None:
    if not faults:
        console().print(f"{counted(records, 'record')}, no faults.")
        return
    from rich.table import Table
    from rich.text import Text

    files = len({fault.file for fault in faults})
    table = Table(title=f"{counted(len(faults), 'fault')} in {counted(files, 'file')}", show_lines=True)
    for heading in ("file", "line", "rule", "found", "remedy"):
        right = heading == "line"
        table.add_column(
            heading, overflow="fold", no_wrap=heading == "file", justify="right" if right else "left"
        )
    for fault in faults:
        line = "" if fault.line is None else str(fault.line)
        cells = (_within(fault.file, sources), line, fault.rule, fault.value, fault.remedy)
        table.add_row(*(Text(printable(cell)) for cell in cells))
    console().print(table)


def _show_notes(notes: "Sequence[Fault]", sources: Sequence[str]) -> None:
    for note in notes:
        text = f"Note: {_within(note.file, sources)}: {note.value}. {note.remedy}."
        say(text, soft_wrap=True)


def _within(file: str, sources: Sequence[str]) -> str:
    """Path of a file from the source that it was found in."""
    return next(
        (file[len(start) :] for source in sources if file.startswith(start := f"{Path(source)}/")), file
    )
