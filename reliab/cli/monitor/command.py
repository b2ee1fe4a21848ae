"""`reliab monitor`: the error of a test while it runs."""

import json
import sys
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, TextIO

import typer

from reliab.cli.completion import samples
from reliab.cli.demand import Demand, takes
from reliab.cli.options import (
    ChannelsFile,
    Column,
    EquipmentFile,
    HeldByForce,
    MassOfStructure,
    MetricName,
    TakenAsExact,
)
from reliab.cli.output import console, write_json
from reliab.cli.printable import printable
from reliab.errors import InputError
from reliab.files import refuse_unwritable

_ABOVE_THRESHOLD = 1


@dataclass(frozen=True, kw_only=True)
class MonitorDemand(Demand):
    """Options of `reliab monitor`, arguments of `reliab.follow_test` and `reliab.export_monitor`."""

    source: Annotated[
        str | None,
        typer.Argument(
            metavar="FILE|-",
            autocompletion=samples,
            help="CSV file that is or will be written to, or - to read rows from standard input; or "
            "sample_test, which ships. None with --export.",
        ),
    ] = None
    f: Annotated[
        str | None,
        typer.Option("--f", metavar="HZ", help="Natural frequency, 1 or with its standard deviation 1±0.01."),
    ] = None
    xi: Annotated[
        str | None, typer.Option("--xi", metavar="RATIO", help="Damping ratio, 0.02 for 2 %, or 0.02±0.002.")
    ] = None
    alpha: Annotated[
        str,
        typer.Option(
            "--alpha", metavar="SHARE", help="Share of the structure's stiffness in the laboratory."
        ),
    ] = "1"
    scale: Annotated[
        str | None,
        typer.Option(
            "--scale",
            metavar="RATIO",
            help="Scale of the displacement sensor; 1±0.005 where it may be off by 0.5 %; by default as "
            "calibrated in --channels, else 1.",
        ),
    ] = None
    feedback_lag: Annotated[
        str,
        typer.Option(
            "--feedback-lag",
            metavar="MS",
            help="Time by which the force is fed back late [ms]; not with --model.",
        ),
    ] = "0"
    equipment: EquipmentFile = None
    exact: TakenAsExact = False
    structure: Annotated[
        Path | None,
        typer.Option(
            "--structure",
            metavar="FRAME.toml",
            help="Frame with its specimen in the laboratory, which one actuator drives or several, in place "
            "of --f, --xi and --alpha.",
        ),
    ] = None
    model: Annotated[
        Path | None,
        typer.Option(
            "--model",
            metavar="MODEL.toml",
            help="Model of the test, whose specimen may be nonlinear, in place of --f, --xi and --alpha.",
        ),
    ] = None
    specimen: Annotated[
        str | None,
        typer.Option(
            "--specimen",
            metavar="linear|measured",
            help="How the specimen is known: linear (default), or measured: learned while the test runs from "
            "its recorded force, which needs --mass or --structure.",
        ),
    ] = None
    mass: MassOfStructure = None
    force_channel: HeldByForce = None
    threshold: Annotated[
        float,
        typer.Option("--threshold", metavar="ERROR", help="Largest error of a good test, 0.05 for 5 %."),
    ] = 0.05
    metric: MetricName = "rms"
    command: Column = None
    measured: Column = None
    time: Column = None
    rate: Annotated[
        float | None,
        typer.Option("--rate", metavar="HZ", help="Sampling rate; by default read from the times."),
    ] = None
    units: Annotated[
        str | None, typer.Option("--units", metavar="m|mm|in...", help="Unit of both displacements.")
    ] = None
    channels: ChannelsFile = None
    every: Annotated[
        float, typer.Option("--every", metavar="SECONDS", help="Time of the test between two messages.")
    ] = 0.5
    wait: Annotated[
        float,
        typer.Option(
            "--wait",
            metavar="SECONDS",
            help="Time without new rows after which the test counts as finished; longer than any pause of "
            "the test.",
        ),
    ] = 10.0
    start_within: Annotated[
        float,
        typer.Option(
            "--start-within",
            metavar="SECONDS",
            help="Time within which the file must appear and have its first row; Ctrl-C ends the waiting.",
        ),
    ] = 600.0
    export: Annotated[
        tuple[str, str] | None,
        typer.Option(
            "--export",
            metavar="c DIR|fmu FILE|fmu3 FILE",
            help="Write the monitor for the loop itself, as C sources or as an FMU of FMI 2.0 or 3.0; "
            "needs --rate.",
        ),
    ] = None
    json_target: Annotated[
        str | None,
        typer.Option(
            "--json",
            metavar="FILE|-",
            help="One JSON object in a line for each message; '-' prints only these to standard output.",
        ),
    ] = None


@takes(MonitorDemand)
def monitor(demand: MonitorDemand) -> None:
    """Follow the error of a test while it runs; exit with code 1 when that of the whole test is too large.

    Alarms are printed as soon as they are raised, and do not change the exit code. The alarm of a loop that
    may diverge is raised in at most one of a hundred stable tests, and not for energy that play explains.
    The alarm of the error is raised when its interval is above twice the threshold and the peak of the
    response has not doubled for 12 s. A test may last as long as you like: its memory stays below 1 GB; but
    with --model, a measured specimen or several actuators it is held whole, and may last about an hour. What
    --export writes has no such limit. A measured specimen is learned anew whenever the test has grown by a
    fourth; until its
    force is predicted to 10 % on parts of the test that were held out, no error is stated, and where that is
    so at the end the exit code is 0.
    """
    if demand.export is not None:
        _export(demand)
    else:
        _follow(demand)


def _export(demand: MonitorDemand) -> None:
    from reliab.api import export_monitor

    written = demand.ask(export_monitor, "json_target", why="beside `export`")
    if demand.json_target is not None:
        write_json(written.to_dict(), demand.json_target)
    if demand.json_target != "-":
        console().print(f"Written to {written.path}: {', '.join(written.files)}", highlight=False)


def _follow(demand: MonitorDemand) -> None:
    from reliab.api import follow_test
    from reliab.cli.monitor.shown import Screen

    if demand.source is None:
        raise InputError("A test that is followed needs its file", remedy="Name it, or - for standard input")
    messages = demand.ask(
        follow_test, "json_target", say=lambda text: typer.echo(printable(text), file=sys.stderr)
    )
    quiet = demand.json_target == "-"
    screen = Screen(metric=demand.metric, threshold=demand.threshold, quiet=quiet)
    above = False
    with _opened(demand.json_target) as lines, screen:
        for message in messages:
            if lines is not None:
                lines.write(json.dumps(message.to_dict(), allow_nan=False) + "\n")
                lines.flush()
            screen.show(message)
            above = message.to_dict().get("above_threshold") or False
    if demand.source != "-" and not quiet:
        console().print(
            f"No new row came for {demand.wait:g} s: the test counts as finished. A new call reads the file "
            "from its beginning, without rows of a file that has been replaced since.",
            highlight=False,
        )
    if above:
        raise typer.Exit(_ABOVE_THRESHOLD)


def _opened(target: str | None) -> AbstractContextManager[TextIO | None]:
    if target is None:
        return nullcontext()
    if target == "-":
        return nullcontext(typer.get_text_stream("stdout"))
    with refuse_unwritable("The JSON file must be writable", where=target):
        return Path(target).open("w", encoding="utf-8")
