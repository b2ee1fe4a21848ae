"""`reliab monitor`: the error of a test while it runs."""

import json
import sys
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

import typer

from reliab.cli.completion import samples
from reliab.cli.demand import Demand, argument, option, takes
from reliab.cli.options import (
    CHANNELS_FILE,
    COLUMN,
    EQUIPMENT_FILE,
    HELD_BY_FORCE,
    MASS_OF_STRUCTURE,
    METRIC_NAME,
    TAKEN_AS_EXACT,
)
from reliab.cli.output import say, write_json
from reliab.cli.printable import printable
from reliab.errors import InputError
from reliab.files import refuse_unwritable

_ABOVE_THRESHOLD = 1


@dataclass(frozen=True, kw_only=True)
class MonitorDemand(Demand):
    """Options of `reliab monitor`, arguments of `reliab.follow_test` and `reliab.export_monitor`."""

    source: str | None = argument(
        "FILE|-",
        "CSV file that is or will be written to, or - to read rows from standard input; or "
        "sample_test, which ships. None with --export.",
        default=None,
        autocompletion=samples,
    )
    f: str | None = option("HZ", "Natural frequency, 1 or with its standard deviation 1±0.01.")
    xi: str | None = option("RATIO", "Damping ratio, 0.02 for 2 %, or 0.02±0.002.")
    alpha: str = option("SHARE", "Share of the structure's stiffness in the laboratory.", default="1")
    scale: str | None = option(
        "RATIO",
        "Scale of the displacement sensor; 1±0.005 where it may be off by 0.5 %; by default as "
        "calibrated in --channels, else 1.",
    )
    feedback_lag: str = option(
        "MS", "Time by which the force is fed back late [ms]; not with --model.", default="0"
    )
    equipment: Path | None = EQUIPMENT_FILE
    exact: bool = TAKEN_AS_EXACT
    structure: Path | None = option(
        "FRAME.toml",
        "Frame with its specimen in the laboratory, which one actuator drives or several, in place "
        "of --f, --xi and --alpha.",
    )
    model: Path | None = option(
        "MODEL.toml", "Model of the test, whose specimen may be nonlinear, in place of --f, --xi and --alpha."
    )
    specimen: str | None = option(
        "linear|measured",
        "How the specimen is known: linear (default), or measured: learned while the test runs from "
        "its recorded force, which needs --mass or --structure.",
    )
    mass: str | None = MASS_OF_STRUCTURE
    force_channel: list[str] | None = HELD_BY_FORCE
    threshold: float = option("ERROR", "Largest error of a good test, 0.05 for 5 %.", default=0.05)
    metric: str = METRIC_NAME
    command: str | None = COLUMN
    measured: str | None = COLUMN
    time: str | None = COLUMN
    rate: float | None = option("HZ", "Sampling rate; by default read from the times.")
    units: str | None = option("m|mm|in...", "Unit of both displacements.")
    channels: Path | None = CHANNELS_FILE
    every: float = option("SECONDS", "Time of the test between two messages.", default=0.5)
    wait: float = option(
        "SECONDS",
        "Time without new rows after which the test counts as finished; longer than any pause of the test.",
        default=10.0,
    )
    start_within: float = option(
        "SECONDS",
        "Time within which the file must appear and have its first row; Ctrl-C ends the waiting.",
        default=600.0,
    )
    export: tuple[str, str] | None = option(
        "c DIR|fmu FILE|fmu3 FILE",
        "Write the monitor for the loop itself, as C sources or as an FMU of FMI 2.0 or 3.0; needs --rate.",
    )
    json_target: str | None = option(
        "FILE|-",
        "One JSON object in a line for each message; '-' prints only these to standard output.",
        name="--json",
    )


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
        say(f"Written to {written.path}: {', '.join(written.files)}")


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
        say(
            f"No new row came for {demand.wait:g} s: the test counts as finished. A new call reads the file "
            "from its beginning, without rows of a file that has been replaced since."
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
