"""`reliab monitor`: the error of a test while it runs."""

import json
from collections.abc import Iterator
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TextIO

import typer

from reliab.cli.options import FIVE_PERCENT, MetricName
from reliab.cli.output import console, table
from reliab.errors import InputError
from reliab.stated_value import StatedValue

if TYPE_CHECKING:
    from rich.live import Live

    from reliab.cli.followed_rows import Rows
    from reliab.rebuilt_error import RebuiltError
    from reliab.rebuilt_error.monitor import Monitor
    from reliab.vocabulary import Metric

_ALARM = 1
_ROWS_FOR_STEP = 64
_GAP = 0.6  # of a step that a sample may come late or early after the one before
_WHOLE_RATE = 1e-4  # relative distance up to which a rate is a whole number of hertz
_MILLISECONDS = 1e-3
_PERCENT = 100.0
_CRITICAL = 0.25  # share of the structure's damping ratio below which a warning is given

Source = Annotated[
    str, typer.Argument(metavar="FILE|-", help="Growing CSV, or - for rows on standard input.")
]
Frequency = Annotated[
    str | None,
    typer.Option("--f", metavar="HZ", help="Natural frequency, 1 or with its standard deviation 1±0.01."),
]
DampingRatio = Annotated[
    str | None, typer.Option("--xi", metavar="RATIO", help="Damping ratio, 0.02 for 2 %, or 0.02±0.002.")
]
Alpha = Annotated[
    str, typer.Option("--alpha", metavar="SHARE", help="Share of the stiffness in the laboratory.")
]
Scale = Annotated[
    str,
    typer.Option(
        "--scale",
        metavar="RATIO",
        help="Scale of the displacement sensor; 1±0.005 where it may be off by 0.5 %.",
    ),
]
FeedbackLag = Annotated[
    str,
    typer.Option("--feedback-lag", metavar="MS", help="Time by which the force is fed back late [ms]."),
]
Threshold = Annotated[
    float, typer.Option("--threshold", metavar="ERROR", help="Error that raises the alarm, 0.05 for 5 %.")
]
Column = Annotated[str | None, typer.Option(metavar="NAME", help="Name of the column, if not recognised.")]
Rate = Annotated[
    float | None, typer.Option("--rate", metavar="HZ", help="Sampling rate; by default read from the times.")
]
Units = Annotated[
    str | None, typer.Option("--units", metavar="m|mm|in...", help="Unit of both displacements.")
]
Every = Annotated[
    float, typer.Option("--every", metavar="SECONDS", help="Time of the test between two messages.")
]
Wait = Annotated[
    float,
    typer.Option(
        "--wait",
        metavar="SECONDS",
        help="A file that has not grown for so long is a finished test; longer than any pause of yours.",
    ),
]
JsonTarget = Annotated[
    str | None,
    typer.Option(
        "--json",
        metavar="FILE|-",
        help="One JSON object in a line for each message; '-' prints only these to standard output.",
    ),
]


def monitor(
    source: Source,
    *,
    f: Frequency = None,
    xi: DampingRatio = None,
    alpha: Alpha = "1",
    scale: Scale = "1",
    feedback_lag: FeedbackLag = "0",
    threshold: Threshold = FIVE_PERCENT,
    metric: MetricName = "rms",
    command: Column = None,
    measured: Column = None,
    time: Column = None,
    rate: Rate = None,
    units: Units = None,
    every: Every = 0.5,
    wait: Wait = 10.0,
    json_target: JsonTarget = None,
) -> None:
    """Follow the error of a test while it runs; exit with code 1 when an alarm was raised."""
    from reliab.cli.followed_rows import chunks_of_text, rows_of
    from reliab.validation.assessment.recognition import Part
    from reliab.vocabulary import Metric

    if f is None:
        raise InputError("A test needs --f, the structure's natural frequency", remedy="Give it in hertz")
    if xi is None:
        raise InputError(
            "A test needs --xi, the structure's damping ratio", remedy="Give 0.02 for 2 %, or 0.02±0.002"
        )
    for option, number in (("--threshold", threshold), ("--every", every), ("--wait", wait)):
        if not 0.0 < number < float("inf"):
            raise InputError(f"{option} must be positive", value=number)
    if rate is not None and not 0.0 < rate < float("inf"):
        raise InputError("--rate must be positive", value=rate)
    if metric not in list(Metric):
        raise InputError("The metric must be rms or mte", value=metric)
    stated = _Stated(
        f=StatedValue.parse(f, "value of --f"),
        xi=StatedValue.parse(xi, "value of --xi"),
        alpha=StatedValue.parse(alpha, "value of --alpha"),
        scale=StatedValue.parse(scale, "value of --scale"),
        feedback_lag=StatedValue.parse(feedback_lag, "value of --feedback-lag"),
    )
    if not stated.scale.value > 0.0:
        raise InputError("The sensor's scale must be positive", value=stated.scale.value)
    columns = {Part.COMMAND: command, Part.MEASURED: measured, Part.TIME: time}
    declared = {part: name for part, name in columns.items() if name is not None}
    rows = rows_of(
        chunks_of_text(source, wait),
        name="standard input" if source == "-" else Path(source).name,
        declared=declared,
        units=units,
    )
    with _opened(json_target) as lines:
        watch = Watch(stated, threshold, Metric(metric), every, lines, quiet=json_target == "-")
        watch.follow(rows, rate)
    if watch.alarms:
        raise typer.Exit(_ALARM)


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


@dataclass(frozen=True, kw_only=True)
class _Stated:
    """What is stated of the test."""

    f: StatedValue
    xi: StatedValue
    alpha: StatedValue
    scale: StatedValue
    feedback_lag: StatedValue

    def monitor(self, step: float) -> "Monitor":
        from reliab.loop.structure import Structure
        from reliab.rebuilt_error import Tolerances
        from reliab.rebuilt_error.monitor import Monitor

        structure = Structure(
            frequency=self.f.value, damping_ratio=self.xi.value, experimental_fraction=self.alpha.value
        )
        tolerances = Tolerances(
            frequency=self.f.deviation / self.f.value,
            damping_ratio=self.xi.deviation / self.xi.value,
            experimental_fraction=self.alpha.deviation / self.alpha.value,
            sensor_scale=self.scale.deviation / self.scale.value,
            feedback_lag=self.feedback_lag.deviation * _MILLISECONDS,
        )
        return Monitor(
            structure, step, feedback_lag=self.feedback_lag.value * _MILLISECONDS, tolerances=tolerances
        )


class Watch:
    """What is said of a running test, and when.

    Parameters
    ----------
    stated : _Stated
        What is stated of the test.
    threshold : float
        Error that raises the alarm [-].
    metric : Metric
        Which error.
    every : float
        Time of the test between two messages [s].
    lines : file or None
        Where JSON lines go.
    quiet : bool
        Whether nothing else may be printed.
    """

    def __init__(
        self,
        stated: _Stated,
        threshold: float,
        metric: "Metric",
        every: float,
        lines: TextIO | None,
        *,
        quiet: bool,
    ) -> None:
        self.stated, self.threshold, self.metric, self.every = stated, threshold, metric, every
        self.lines, self.quiet = lines, quiet
        self.alarms: list[str] = []
        self._raised: list[str] = []
        self._terminal = console()

    def follow(self, rows: Iterator["Rows"], rate: float | None) -> None:
        """Follow rows to their end.

        Parameters
        ----------
        rows : iterator of Rows
            Rows as they come.
        rate : float or None
            Sampling rate [Hz] as stated.

        Raises
        ------
        InputError
            If times do not follow at equal steps, or the test is too short.
        """
        step, rows = _time_step(rows, rate)
        monitor = self.stated.monitor(step)
        between = max(round(self.every / step), 1)
        with self._view() as live:
            for part in _equal_steps(rows, step):
                begin = 0
                while begin < part.command.size:
                    end = min(begin + between - monitor.samples % between, part.command.size)
                    monitor.feed(part.command[begin:end], part.measured[begin:end] / self.stated.scale.value)
                    if monitor.samples % between == 0:
                        self._say(monitor, live)
                    begin = end
        self._end(monitor)

    def _view(self) -> "AbstractContextManager[Live | None]":
        if self.quiet or not self._terminal.is_terminal:
            return nullcontext()
        from rich.live import Live

        return Live(console=self._terminal, refresh_per_second=8)

    def _say(self, monitor: "Monitor", live: "Live | None") -> None:
        asked = monitor.ask() if monitor.due else None
        message = self._message(monitor, "update")
        if asked is not None:
            message["error"] = self._intervals(asked)
        self._write(message)
        if live is not None:
            live.update(self._table(monitor))
        elif asked is not None and not self.quiet:
            self._terminal.print(self._line(message), highlight=False)

    def _end(self, monitor: "Monitor") -> None:
        from reliab.rebuilt_error.rebuild import DRAWS

        asked = monitor.ask(draws=DRAWS)
        message = self._message(monitor, "end") | {"error": self._intervals(asked)}
        self._write(message)
        if not self.quiet:
            self._terminal.print(self._line(message), highlight=False)
            for alarm in self.alarms:
                self._terminal.print(f"Alarm: {alarm}", style="red", highlight=False)

    def _message(self, monitor: "Monitor", kind: str) -> dict[str, Any]:
        now = monitor.now
        damping = now.damping_ratio
        if damping is not None and damping < 0.0:
            self._alarm("unstable", f"the loop gains energy since {now.time:.2f} s, and will diverge")
        if monitor.exceeds(self.threshold, self.metric):
            self._alarm("error", f"the error is above {self.threshold:.2%} since {now.time:.2f} s")
        return {
            "kind": kind,
            "samples": now.samples,
            "time_s": now.time,
            "error_m": now.error,
            "rms": now.rms,
            "mte": now.mte,
            "net_damping_ratio": damping,
            "near_instability": damping is not None and damping < _CRITICAL * self.stated.xi.value,
            "alarms": list(self._raised),
        }

    def _alarm(self, name: str, sentence: str) -> None:
        if name not in self._raised:
            self._raised.append(name)
            self.alarms.append(sentence)

    def _intervals(self, asked: "RebuiltError") -> dict[str, Any]:
        return {
            "rms": {"value": asked.rms.value, "low": asked.rms.low, "high": asked.rms.high},
            "mte": {"value": asked.mte.value, "low": asked.mte.low, "high": asked.mte.high},
            "metric": str(self.metric),
            "threshold": self.threshold,
            "probability": asked.probability(self.threshold, self.metric),
        }

    def _write(self, message: dict[str, Any]) -> None:
        if self.lines is not None:
            self.lines.write(json.dumps(message, allow_nan=False) + "\n")
            self.lines.flush()

    def _line(self, message: dict[str, Any]) -> str:
        error = message["error"][str(self.metric)]
        damping = message["net_damping_ratio"]
        return (
            f"{message['time_s']:8.2f} s  {self.metric.upper()} {error['value']:.2%} "
            f"(90 %: {error['low']:.2%} to {error['high']:.2%}), below "
            f"{_PERCENT * self.threshold:.3g}% with probability "
            f"{message['error']['probability']:.3f}, net damping "
            + ("not settled" if damping is None else f"{damping:.2%}")
        )

    def _table(self, monitor: "Monitor") -> Any:  # noqa: ANN401 - a table of Rich
        now, result = monitor.now, monitor.result
        shown = table(
            f"{now.time:.2f} s of the test, {now.samples} samples", {"quantity": "left", "value": "right"}
        )
        shown.add_row("error now, mm", f"{1e3 * now.error:.3f}")
        shown.add_row("RMS^R so far, with noise", f"{now.rms:.2%}")
        shown.add_row("MTE^R so far, with noise", f"{now.mte:.2%}")
        if result is not None:
            error = result.estimate(self.metric)
            shown.add_row(
                f"{self.metric.upper()} with its 90 % interval",
                f"{error.value:.2%} ({error.low:.2%} to {error.high:.2%})",
            )
            probability = result.probability(self.threshold, self.metric)
            shown.add_row(f"probability below {_PERCENT * self.threshold:.3g}%", f"{probability:.3f}")
        damping = now.damping_ratio
        shown.add_row("net damping ratio", "not settled" if damping is None else f"{damping:.2%}")
        for alarm in self.alarms:
            shown.add_row("ALARM", alarm)
        return shown


def _time_step(rows: Iterator["Rows"], rate: float | None) -> tuple[float, Iterator["Rows"]]:
    """Step between samples, from the rate or the first times; and all rows again."""
    if rate is not None:
        return 1.0 / rate, rows
    import numpy as np

    first: list[Rows] = []
    count = 0
    for part in rows:
        first.append(part)
        count += part.command.size
        if count > _ROWS_FOR_STEP:
            break
    if any(part.time is None for part in first):
        raise InputError(
            "A test that is followed needs times or a sampling rate",
            remedy="Add a column time, or give the sampling rate with --rate",
        )
    if count <= _ROWS_FOR_STEP:
        raise InputError(
            f"A test that is followed needs more than {_ROWS_FOR_STEP} rows",
            value=count,
            remedy="Wait until the test runs, or wait longer with --wait",
        )
    times = np.concatenate([part.time for part in first if part.time is not None])
    step = float(times[-1] - times[0]) / (times.size - 1)
    if not step > 0.0:
        raise InputError("Times must grow", value=f"{times[-1]:g} s after {times[0]:g} s")
    whole = round(1.0 / step)
    if whole > 0 and abs(whole * step - 1.0) < _WHOLE_RATE:
        step = 1.0 / whole
    return step, chain(first, rows)


def _equal_steps(rows: Iterator["Rows"], step: float) -> Iterator["Rows"]:
    """Rows whose times, where there are any, follow at equal steps.

    Each time may be off the equal steps from the first by what times are rounded to, a step at most.
    """
    import numpy as np

    begin: float | None = None
    count, drift = 0, 0.0
    for part in rows:
        if part.time is not None:
            begin = float(part.time[0]) if begin is None else begin
            due = begin + step * np.arange(count, count + part.time.size)
            # what a clock may drift from the nominal rate counts as no gap; a missing sample does
            late = part.time - due
            gap = np.flatnonzero(
                np.abs(np.diff(late, prepend=late[0] if count == 0 else drift)) > _GAP * step
            )
            if gap.size:
                row = int(gap[0])
                raise InputError(
                    f"Samples must follow each other at equal steps, here of {step:.6g} s",
                    value=f"{part.time[row]:.10g} s for sample {count + row + 1}",
                    remedy="A test with missing samples cannot be followed; assess it in pieces afterwards",
                )
            drift = float(late[-1])
        count += part.command.size
        yield part
