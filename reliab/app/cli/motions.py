"""`reliab motions`, `simulate` and `ellipses`: ground motions, their simulation, their boundaries."""

import itertools
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from reliab.app import questions
from reliab.app.cli.commands import Command, Group, Request, takes
from reliab.app.cli.output import say, show_rows, show_table
from reliab.core.significant_digits import counted
from reliab.core.vocabulary import ERROR_NAMES, Metric

if TYPE_CHECKING:
    from reliab.app.api.simulation import Boundaries, WrittenSuite
    from reliab.motions.faults import MotionFault


app = typer.Typer(cls=Group, no_args_is_help=True, help="Ground motions: list, check, import and synthesize.")


@app.command("list", cls=Command)
@takes(questions.MotionQuestion, questions.MOTION_SOURCES)
def list_motions(request: Request) -> None:
    """List motions with their events and measures of intensity."""
    from reliab.app.api.simulation import MotionList, list_motions as api_list_motions

    def show(result: MotionList) -> None:
        events = {row["event"] for row in result.rows}
        title = f"{counted(len(result.rows), 'motion')} from {counted(len(events), 'event')}"
        show_rows(title, result.table_columns, result.rows)
        for fault in result.faults:
            line = "" if fault.line is None else f", line {fault.line}"
            value = f"; found {fault.value}" if fault.value else ""
            place = f"{_path_within_sources(fault.file, request.sources)}{line}"
            say(f"Left out: {place}: {fault.rule}{value}. {fault.remedy}.", style="yellow", soft_wrap=True)
        _show_notes(result.skipped, request.sources)

    request.answer(api_list_motions, show)


@app.command("check", cls=Command)
@takes(questions.MotionQuestion, questions.MOTION_SOURCES)
def check(request: Request) -> None:
    """Read every record; report all faults (exit code 2), and note what deserves a look."""
    from reliab.app.api.simulation import MotionCheck, check_motions

    def show(result: MotionCheck) -> None:
        faults = [replace(fault, remedy=request.write_as_options(fault.remedy)) for fault in result.faults]
        _show_faults(faults, result.records, request.sources)
        _show_notes(result.notes, request.sources)

    if request.answer(check_motions, show).faults:
        raise typer.Exit(2)


@app.command("import", cls=Command)
@takes(questions.MotionImportQuestion, questions.MOTION_SOURCES, questions.NEW_SUITE)
def import_motions(request: Request) -> None:
    """Rewrite motions as a suite: one text format in m/s² and a catalogue."""
    from reliab.app.api.simulation import import_motions as api_import_motions

    request.answer(api_import_motions, _show_written)


@app.command("synthesize", cls=Command)
@takes(questions.SyntheticSuiteQuestion, questions.NEW_SUITE)
def synthesize(request: Request) -> None:
    """Write the synthetic suite, which needs no record."""
    from reliab.app.api.simulation import synthesize_motions

    request.answer(synthesize_motions, _show_written)


def _show_written(suite: "WrittenSuite") -> None:
    motions, events = counted(len(suite.motions), "motion"), counted(suite.events, "event")
    say(f"{motions} from {events} written to {suite.catalogue.parent}", soft_wrap=True)


def _show_faults(faults: "Sequence[MotionFault]", records: int, sources: Sequence[str]) -> None:
    if not faults:
        say(f"{counted(records, 'record')}, no faults.")
        return
    files = len({fault.file for fault in faults})
    rows = [
        (
            _path_within_sources(fault.file, sources),
            "" if fault.line is None else str(fault.line),
            *(fault.rule, fault.value, fault.remedy),
        )
        for fault in faults
    ]
    title = f"{counted(len(faults), 'fault')} in {counted(files, 'file')}"
    show_table(
        title, {"file": "left", "line": "right", **dict.fromkeys(("rule", "found", "remedy"), "left")}, rows
    )


def _show_notes(notes: "Sequence[MotionFault]", sources: Sequence[str]) -> None:
    for note in notes:
        text = f"Note: {_path_within_sources(note.file, sources)}: {note.value}. {note.remedy}."
        say(text, soft_wrap=True)


def _path_within_sources(file: str, sources: Sequence[str]) -> str:
    """Path of a file from the source that it was found in."""
    return next(
        (file[len(start) :] for source in sources if file.startswith(start := f"{Path(source)}/")), file
    )


@takes(questions.SimulationQuestion, questions.NEW_STORE)
def simulate(request: Request) -> None:
    """Simulate motions for all structures and actuators and store the results.

    With --model the structure and the effects are the model's, and gain, delay and the index (A, d) of the
    results are those of its actuator alone.
    """
    from reliab.app.api.simulation import Simulation, simulate_suite

    def show(simulation: Simulation) -> None:
        structures = counted(len(simulation.request.structures), "structure")
        say(f"{counted(simulation.motions, 'motion')} × {structures} stored in {simulation.store}")

    request.answer(simulate_suite, show)


_PAGE = 1000  # rows


@takes(questions.TracingQuestion)
def ellipses(request: Request) -> None:
    """Trace the boundary of equal error of each motion, for late and early actuators, as ellipses."""
    from reliab.app.api.simulation import trace_boundaries

    metric = request.metric or Metric.RMS
    request.answer(trace_boundaries, lambda ellipses: _show_boundaries(ellipses, metric))


def _show_boundaries(ellipses: "Boundaries", metric: str) -> None:
    """Print one row for each boundary, page by page: a single table of very many would fill the memory."""
    title = f"{len(ellipses)} boundaries of the {ERROR_NAMES[Metric(metric)]}"
    rows = ellipses.rows()
    while page := list(itertools.islice(rows, _PAGE)):
        show_rows(title, ellipses.table_columns, page)
        title = ""
    say(*(f"Note: {warning}" for warning in ellipses.warnings))
