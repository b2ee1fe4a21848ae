"""`reliab monitor`: the error of a test while it runs, and the verdict on it at the end."""

import json
import sys
from collections.abc import Mapping
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Self, TextIO, TypedDict

import typer

from reliab.app import declaration, options, questions
from reliab.app.api.arguments import STATED_BY_MODEL, parse_threshold
from reliab.app.cli.commands import Request, takes
from reliab.app.cli.output import console, say, write_json
from reliab.app.declaration import argument, group
from reliab.app.options import OUTPUT
from reliab.core.encodings import printable
from reliab.core.errors import InputError
from reliab.core.files import refuse_unwritable
from reliab.core.significant_digits import decimals_of_uncertainty, percent, percent_with_interval
from reliab.core.vocabulary import ERROR_NAMES, PERCENT, Metric

if TYPE_CHECKING:
    from reliab.app.api.followed_test import Message

_DECIMALS = 2  # at most, of the net damping ratio in per cent
_NO = 1  # exit code where the answer is no


@group
class _MonitorArguments(TypedDict, total=False):
    """Tests to judge, or what is written.

    source: CSV file to which the test is or will be written, or - to read rows from standard input; or
        sample_test, which comes with reliab. No file with --export.
    export: Write the monitor for the loop, as C or as an FMU of FMI 2.0 or 3.0; needs `rate`.
    """

    source: Annotated[str | None, argument("FILE|-", default=None, completion=declaration.samples)]
    export: Annotated[tuple[str, str] | None, OUTPUT.advanced("c DIR|fmu FILE|fmu3 FILE")]


@takes(
    questions.MonitorQuestion,
    options.CHECK,
    _MonitorArguments,
    idle_beside=dict.fromkeys(STATED_BY_MODEL, "model"),
)
def monitor(request: Request) -> None:
    """Follow the error of a test while it runs, and judge the whole test at its end.

    Alarms appear immediately and do not change the exit code. At the end the exit code is 1 if the test is
    not reliable, with --check also if it is undecided. --json writes one object per line.
    """
    if request.export is not None:
        _export(request)
    else:
        _follow(request)


def _export(request: Request) -> None:
    from reliab.app.api.monitor import export_monitor

    result = request.ask(export_monitor, reason="together with `export`")
    if request.json_target is not None:
        write_json(result.to_dict(), request.json_target)
    if request.json_target != "-":
        say(f"Written to {result.path}: {', '.join(result.files)}")


def _follow(request: Request) -> None:
    from reliab.app.api.monitor import follow_test

    if request.source is None:
        raise InputError("No file to follow", remedy="Name it, or - for standard input")
    messages = request.ask(
        follow_test, "check", say=lambda text: typer.echo(printable(text), file=sys.stderr)
    )
    quiet = request.json_target == "-"
    screen = Screen(
        metric=request.metric or Metric.RMS,
        threshold=parse_threshold(request.threshold),
        quiet=quiet,
        end="" if request.source == "-" else f"No new rows for {request.wait:g} s: test considered finished.",
    )
    verdict = ""
    with _open_log(request.json_target) as lines, screen:
        for message in messages:
            if lines is not None:
                lines.write(json.dumps(message.to_dict(), allow_nan=False) + "\n")
                lines.flush()
            screen.show(message)
            verdict = message.to_dict().get("verdict", verdict)
    if verdict == "not_reliable" or (request.check and verdict != "reliable"):
        raise typer.Exit(_NO)


def _open_log(target: str | None) -> AbstractContextManager[TextIO | None]:
    if target is None:
        return nullcontext()
    if target == "-":
        return nullcontext(typer.get_text_stream("stdout"))
    with refuse_unwritable("Cannot write the JSON file", where=target):
        return Path(target).open("w", encoding="utf-8")


_NO_MOTION = "No displacement stands out of the noise of its sensors."


class Screen:
    """Shows messages of a running test; `threshold` [-], `end`: why it ended."""

    def __init__(self, *, metric: str, threshold: float, quiet: bool, end: str = "") -> None:
        from rich.live import Live

        self._metric, self._threshold, self._quiet = Metric.parse(metric), threshold, quiet
        self._end = end
        self._terminal = console()
        is_live = not quiet and self._terminal.is_terminal
        self._live = Live(console=self._terminal, refresh_per_second=8) if is_live else None

    def __enter__(self) -> Self:
        if self._live is not None:
            self._live.start()
        return self

    def __exit__(self, *_error: object) -> None:
        self._stop()

    def _stop(self) -> None:
        if self._live is not None:
            self._live.stop()

    def show(self, message: "Message") -> None:
        """Show a message."""
        if self._quiet:
            return
        content = message.to_dict()
        if message.kind == "alarm":
            self._print(list(message.alarms.values())[-1], style="red")
        elif message.kind == "end":
            self._stop()
            self._show_end(message)
        elif self._live is not None:
            self._live.update(_table(message, self._metric, self._threshold))
        elif "error" in content:
            self._print(_line(content, self._metric, self._threshold))
        elif content.get("specimen", {}).get("until_s") == content["time_s"]:
            self._print(_still_learning(content))

    def _show_end(self, message: "Message") -> None:
        """Show the verdict on the whole test, as `reliab assess` does where it judged it."""
        from reliab.app.cli.assess import show_briefly
        from reliab.assessment.verdict import Word

        content = message.to_dict()
        if "error" in content:
            self._print(_line(content, self._metric, self._threshold))
        if self._end:
            self._print(self._end)
        if message.assessment is not None:
            show_briefly(message.assessment.to_dict(), omits_details=False)
            self._print("Warnings and all results: `reliab assess` with the same options and --details.")
            return
        if "error" not in content:
            self._print(_still_learning(content) if "specimen" in content else _NO_MOTION)
        self._print(f"{Word(content['verdict']).shout}: {' '.join(content['reasons'])}")

    def _print(self, text: str, style: str | None = None) -> None:
        """Print a line at once, in a pipe too."""
        self._terminal.print(text, style=style, highlight=False)
        self._terminal.file.flush()


def _still_learning(message: Mapping[str, Any]) -> str:
    """Say that the specimen is not learned yet, and how far that is."""
    unexplained = message["specimen"]["held_out"]
    far = (
        "nothing was learned"
        if unexplained is None
        else f"{percent(unexplained, decimals=0)} of its force is not predicted on held-out parts"
    )
    return f"{message['time_s']:8.2f} s  still learning the specimen: {far}"


def _line(message: Mapping[str, Any], metric: Metric, threshold: float) -> str:
    from reliab.assessment.verdict import probability_text

    error = message["error"][metric]
    damping, deviation = message["net_damping_ratio"], message["net_damping_deviation"]
    displacement = f" of {message['governing']}" if "governing" in message else ""
    return (
        f"{message['time_s']:8.2f} s  {ERROR_NAMES[metric]}{displacement} "
        f"{percent_with_interval(error['value'], error['low'], error['high'])}, probability below "
        f"{percent(threshold)}: {probability_text(message['error']['probability'])}, net damping "
        + ("not settled" if damping is None else _write_with_deviation(damping, deviation))
        + (", near instability" if message["near_instability"] else "")
    )


def _write_with_deviation(damping: float, deviation: float) -> str:
    """Net damping with its standard error."""
    decimals = min(decimals_of_uncertainty(PERCENT * deviation), _DECIMALS)
    return f"{PERCENT * damping:.{decimals}f} ± {percent(deviation, decimals=decimals)}"


def _table(message: "Message", metric: Metric, threshold: float) -> Any:  # noqa: ANN401 - for Rich
    from rich.console import Group

    from reliab.report.document import text_table
    from reliab.report.terminal import rich_table

    now, result = message.monitor.now, message.monitor.result
    values: dict[str, str] = {}
    if now.error is None or now.rms is None or now.mte is None:
        values["specimen"] = "still learning"
    else:
        if "governing" in message.to_dict():
            values["displacement with the largest error"] = message.to_dict()["governing"]
        values["error now, mm"] = f"{1e3 * now.error:.3f}"
        values["RMS error so far, with noise"] = percent(now.rms, 2)
        values["largest error so far, with noise"] = percent(now.mte, 2)
    if result is not None:
        error = result.estimate(metric)
        size = percent_with_interval(error.value, error.low, error.high)
        values[f"{ERROR_NAMES[metric]} with its 90 % interval"] = size
        probability = result.probability(threshold, metric)
        values[f"probability below {percent(threshold)}"] = f"{probability:.3f}"
    values["net damping ratio"] = (
        "not settled"
        if now.damping is None
        else _write_with_deviation(now.damping.ratio, now.damping.deviation)
    )
    rows = [*values.items(), *(("ALARM", alarm) for alarm in message.alarms.values())]
    title = f"{now.time:.2f} s of the test, {now.samples} samples"
    return Group(title, rich_table(text_table(rows, {"quantity": "left", "value": "left"}, caption=title)))
