"""`reliab monitor`: the error of a test while it runs."""

from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import TextIO

import typer

from reliab.cli.monitor.options import (
    Alpha,
    Column,
    DampingRatio,
    Every,
    FeedbackLag,
    Frequency,
    JsonTarget,
    Rate,
    Scale,
    Source,
    StartWithin,
    Threshold,
    Units,
    Wait,
)
from reliab.cli.options import MetricName
from reliab.cli.output import console
from reliab.errors import InputError
from reliab.shipped import or_shipped

_ABOVE_THRESHOLD = 1


def monitor(
    source: Source,
    *,
    f: Frequency = None,
    xi: DampingRatio = None,
    alpha: Alpha = "1",
    scale: Scale = "1",
    feedback_lag: FeedbackLag = "0",
    threshold: Threshold = 0.05,
    metric: MetricName = "rms",
    command: Column = None,
    measured: Column = None,
    time: Column = None,
    rate: Rate = None,
    units: Units = None,
    every: Every = 0.5,
    wait: Wait = 10.0,
    start_within: StartWithin = 600.0,
    json_target: JsonTarget = None,
) -> None:
    """Follow the error of a test while it runs; exit with code 1 when that of the whole test is too large.

    Alarms are printed as soon as they are raised, and do not change the exit code. The alarm of a loop that
    may diverge is made for one false alarm in a hundred stable tests at most, and grants what play explains.
    The alarm of the error is raised when its interval is above twice the threshold and the peak of the
    response has not doubled for 12 s. A test may last as long as you like: its memory stays below 1 GB.
    """
    from reliab.cli.monitor.followed_rows import chunks_of_text, rows_of
    from reliab.cli.monitor.stated_test import StatedTest
    from reliab.cli.monitor.watch import Watch
    from reliab.recordings import Part
    from reliab.vocabulary import Metric

    if f is None:
        raise InputError("A test needs --f, the structure's natural frequency", remedy="Give it in hertz")
    if xi is None:
        raise InputError(
            "A test needs --xi, the structure's damping ratio", remedy="Give 0.02 for 2 %, or 0.02±0.002"
        )
    positive = {"--threshold": threshold, "--every": every, "--wait": wait, "--start-within": start_within}
    for option, number in (positive if rate is None else positive | {"--rate": rate}).items():
        if not 0.0 < number < float("inf"):
            raise InputError(f"{option} must be positive", value=number)
    stated = StatedTest.parse(f=f, xi=xi, alpha=alpha, scale=scale, feedback_lag=feedback_lag)
    columns = {Part.COMMAND: command, Part.MEASURED: measured, Part.TIME: time}
    declared = {part: name for part, name in columns.items() if name is not None}
    source = source if source == "-" else str(or_shipped(Path(source), "datasets", "test.csv"))
    rows = rows_of(
        chunks_of_text(source, wait, start_within),
        name="standard input" if source == "-" else Path(source).name,
        declared=declared,
        units=units,
    )
    with _opened(json_target) as lines:
        watch = Watch(stated, threshold, Metric.parse(metric), every, lines, quiet=json_target == "-")
        watch.follow(rows, rate)
    if source != "-" and json_target != "-":
        console().print(
            f"No new row came for {wait:g} s: the test counts as finished. A new call reads the file from "
            "its beginning; rows of a file that was replaced are known only to the call that saw them.",
            highlight=False,
        )
    if watch.above_threshold:
        raise typer.Exit(_ABOVE_THRESHOLD)


def _opened(target: str | None) -> AbstractContextManager[TextIO | None]:
    if target is None:
        return nullcontext()
    if target == "-":
        return nullcontext(typer.get_text_stream("stdout"))
    try:
        return Path(target).open("w", encoding="utf-8")
    except OSError as error:
        raise InputError(
            "The JSON file must be writable", value=error.strerror, remedy="Name another", where=target
        ) from error
