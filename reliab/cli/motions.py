"""``reliab motions``: list, check, import and synthesize ground motions."""

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from reliab.cli.options import JsonTarget, Sets
from reliab.cli.output import console, write_json
from reliab.cli.printable import printable
from reliab.significant import significant

if TYPE_CHECKING:
    from reliab.motions import Fault, MotionSuite

app = typer.Typer(no_args_is_help=True, help="Ground motions: list, check, import and synthesize.")

Sources = Annotated[
    list[str], typer.Argument(metavar="SOURCE...", help="Files, folders or a built-in suite (synthetic).")
]
TimeStep = Annotated[
    float | None, typer.Option("--time-step", metavar="SECONDS", help="Step, where files state none.")
]
Units = Annotated[
    str | None, typer.Option("--units", metavar="g|cm/s2|m/s2", help="Units, where files state none.")
]
Out = Annotated[Path, typer.Option("--out", metavar="FOLDER", help="New or empty folder for the suite.")]


@app.command("list")
def list_motions(
    sources: Sources,
    sets: Sets = None,
    time_step: TimeStep = None,
    units: Units = None,
    json_target: JsonTarget = None,
) -> None:
    """List motions with their events and measures of intensity."""
    from reliab.motions import load_motions

    rows = _describe(load_motions(*sources, sets=sets, time_step=time_step, units=units))
    if write_json({"motions": rows}, json_target):
        return
    _show_motions(rows)


def _show_motions(rows: list[dict[str, Any]]) -> None:
    from rich import box
    from rich.table import Table
    from rich.text import Text

    events = {row["event"] for row in rows}
    table = Table(
        title=f"{len(rows)} motions from {len(events)} events", box=box.SIMPLE, padding=(0, 1, 0, 0)
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


@app.command("check")
def check(
    sources: Sources,
    sets: Sets = None,
    time_step: TimeStep = None,
    units: Units = None,
    json_target: JsonTarget = None,
) -> None:
    """Read every record; report all faults (exit code 2), and note what deserves a look."""
    from reliab.motions import inspect

    inspections = [inspect(source, sets=sets, time_step=time_step, units=units) for source in sources]
    faults = [fault for inspection in inspections for fault in inspection.faults]
    notes = [note for inspection in inspections for note in inspection.notes]
    records = sum(inspection.records for inspection in inspections)
    content = {
        "records": records,
        "faults": [asdict(fault) for fault in faults],
        "notes": [asdict(note) for note in notes],
    }
    if not write_json(content, json_target):
        _show_faults(faults, records, sources)
        _show_notes(notes, sources)
    if faults:
        raise typer.Exit(2)


@app.command("import")
def import_motions(
    sources: Sources,
    out: Out,
    sets: Sets = None,
    time_step: TimeStep = None,
    units: Units = None,
    event: Annotated[
        str | None, typer.Option("--event", help="The one earthquake of all imported motions.")
    ] = None,
    json_target: JsonTarget = None,
) -> None:
    """Rewrite motions as a suite: one text format in m/s² and a catalogue."""
    from reliab.motions import load_motions, write_suite

    suite = load_motions(*sources, sets=sets, time_step=time_step, units=units)
    events = {event} if event is not None else set(suite.events)
    _report_written(write_suite(suite, out, event=event), suite.names, len(events), json_target)


@app.command("synthesize")
def synthesize(
    out: Out,
    count: Annotated[int, typer.Option("--count", min=2, help="Number of components.")] = 100,
    seed: Annotated[
        int | None, typer.Option("--seed", min=0, help="Another suite than the built-in.")
    ] = None,
    json_target: JsonTarget = None,
) -> None:
    """Write the synthetic suite, which needs no record."""
    from reliab.motions import write_suite
    from reliab.motions.synthetic import synthetic_suite

    suite = synthetic_suite(count=count) if seed is None else synthetic_suite(count=count, seed=seed)
    _report_written(write_suite(suite, out), suite.names, len(set(suite.events)), json_target)


def _describe(suite: "MotionSuite") -> list[dict[str, Any]]:
    from reliab.motions import measure
    from reliab.vocabulary import STANDARD_GRAVITY

    rows = []
    for motion in suite:
        intensity = measure(motion)
        rows.append(
            {
                "motion": motion.name,
                "event": motion.event,
                "set": motion.set_name,
                "time_step": motion.time_step,
                "samples": motion.acceleration.size,
                "duration": motion.duration,
                "pga_g": intensity.peak_acceleration / STANDARD_GRAVITY,
                "arias_intensity": intensity.arias_intensity,
                "significant_duration": intensity.significant_duration,
                "mean_period": intensity.mean_period,
                "checksum": motion.checksum,
            }
        )
    return rows


def _show_faults(faults: "list[Fault]", records: int, sources: list[str]) -> None:
    if not faults:
        console().print(f"{records} records, no faults.")
        return
    from rich.table import Table
    from rich.text import Text

    files = len({fault.file for fault in faults})
    table = Table(title=f"{len(faults)} faults in {files} files", show_lines=True)
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


def _show_notes(notes: "list[Fault]", sources: list[str]) -> None:
    for note in notes:
        text = f"Note: {_within(note.file, sources)}: {note.value}. {note.remedy}."
        console().print(text, markup=False, highlight=False, soft_wrap=True)


def _within(file: str, sources: list[str]) -> str:
    """Path of a file from the source that it was found in."""
    return next(
        (file[len(start) :] for source in sources if file.startswith(start := f"{Path(source)}/")), file
    )


def _report_written(catalogue: Path, names: tuple[str, ...], events: int, json_target: str | None) -> None:
    written = {"catalogue": str(catalogue), "motions": list(names), "events": events}
    if not write_json(written, json_target):
        text = f"{len(names)} motions from {events} events written to {catalogue.parent}"
        console().print(text, markup=False, highlight=False, soft_wrap=True)
