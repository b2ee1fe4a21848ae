"""Messages about a running test, a table that is kept up to date, and alarms."""

import json
from collections.abc import Iterator
from contextlib import AbstractContextManager, nullcontext
from typing import Any, TextIO

from rich.live import Live

from reliab.assessment.rebuilt_error import DRAWS, ErrorSoFar, Monitor
from reliab.cli.monitor.sample_times import at_equal_steps, time_step
from reliab.cli.monitor.stated_test import StatedTest
from reliab.cli.output import console, table
from reliab.recordings import Rows
from reliab.significant import significant
from reliab.vocabulary import PERCENT, Metric

_GLANCE = 0.1  # s of the test between two looks at the alarms
_CRITICAL = 0.25  # share of the structure's damping ratio below which a warning is given


class Watch:
    """Prints messages, the table and the alarms of a running test.

    `threshold` [-]; `every` [s].
    `alarms`: Sentences of the alarms that were raised, by name.
    `above_threshold`: Whether the error of the whole test is above the threshold, once the test has ended.
    """

    def __init__(
        self,
        stated: StatedTest,
        threshold: float,
        metric: Metric,
        every: float,
        lines: TextIO | None,
        *,
        quiet: bool,
    ) -> None:
        self.stated, self.threshold, self.metric, self.every = stated, threshold, metric, every
        self.lines, self.quiet = lines, quiet
        self.alarms: dict[str, str] = {}
        self.above_threshold = False
        self._terminal = console()

    def follow(self, rows: Iterator[Rows], rate: float | None) -> None:
        """Follow rows to their end.

        `rate` [Hz].
        """
        step, rows = time_step(rows, rate)
        monitor = self.stated.monitor(step)
        between, glance = (max(round(seconds / step), 1) for seconds in (self.every, _GLANCE))
        with self._view() as live:
            for part in at_equal_steps(rows, step):
                begin = 0
                while begin < part.command.size:
                    to_next = min(count - monitor.samples % count for count in (between, glance))
                    end = min(begin + to_next, part.command.size)
                    monitor.feed(part.command[begin:end], part.measured[begin:end] / self.stated.scale.value)
                    if monitor.samples % glance == 0 or monitor.samples % between == 0:
                        self._look(monitor)
                    if monitor.samples % between == 0:
                        self._say(monitor, live)
                    begin = end
        self._end(monitor)

    def _view(self) -> AbstractContextManager[Live | None]:
        if self.quiet or not self._terminal.is_terminal:
            return nullcontext()
        return Live(console=self._terminal, refresh_per_second=8)

    def _say(self, monitor: Monitor, live: Live | None) -> None:
        asked = monitor.ask() if monitor.due else None
        message = self._message(monitor, "update")
        if asked is not None:
            message["error"] = self._intervals(asked, monitor)
        self._write(message)
        if live is not None:
            live.update(self._table(monitor))
        elif asked is not None and not self.quiet:
            self._print(self._line(message))

    def _look(self, monitor: Monitor) -> None:
        """Raise the alarms that are due, at once."""
        if monitor.gains_energy_since is not None:
            self._alarm("unstable", monitor, "the loop gains energy and may diverge")
        if monitor.exceeds(self.threshold, self.metric):
            self._alarm(
                "error",
                monitor,
                f"the error is above twice {self.threshold:.2%}; few tests end below that threshold then",
            )

    def _alarm(self, name: str, monitor: Monitor, sentence: str) -> None:
        if name in self.alarms:
            return
        self.alarms[name] = f"Alarm at {monitor.now.time:.2f} s: {sentence}"
        self._write(self._message(monitor, "alarm"))
        if not self.quiet:
            self._print(self.alarms[name], style="red")

    def _print(self, text: str, style: str | None = None) -> None:
        """Print a line at once, in a pipe too."""
        self._terminal.print(text, style=style, highlight=False)
        self._terminal.file.flush()

    def _end(self, monitor: Monitor) -> None:
        asked = monitor.ask(draws=DRAWS)
        self.above_threshold = asked.estimate(self.metric).value > self.threshold
        message = self._message(monitor, "end") | {"error": self._intervals(asked, monitor)}
        self._write(message | {"above_threshold": self.above_threshold})
        if not self.quiet:
            self._print(self._line(message))
            side = "above" if self.above_threshold else "not above"
            self._print(f"The error of the whole test is {side} {self.threshold:.2%}.")

    def _message(self, monitor: Monitor, kind: str) -> dict[str, Any]:
        now = monitor.now
        damping = None if now.damping is None else now.damping.ratio
        return {
            "kind": kind,
            "samples": now.samples,
            "time_s": now.time,
            "error_m": now.error,
            "rms": now.rms,
            "mte": now.mte,
            "net_damping_ratio": damping,
            "near_instability": damping is not None and damping < _CRITICAL * self.stated.xi.value,
            "alarms": list(self.alarms),
        }

    def _intervals(self, asked: ErrorSoFar, monitor: Monitor) -> dict[str, Any]:
        return {
            "rms": {"value": asked.rms.value, "low": asked.rms.low, "high": asked.rms.high},
            "mte": {"value": asked.mte.value, "low": asked.mte.low, "high": asked.mte.high},
            "until_s": monitor.now.time,
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
            f"{message['time_s']:8.2f} s  {self.metric.upper()} {error['value']:.2%} (90 %: "
            f"{error['low']:.2%} to {error['high']:.2%}), below "
            f"{significant(PERCENT * self.threshold)}% with "
            f"probability {message['error']['probability']:.3f}, net damping "
            + ("not settled" if damping is None else f"{damping:.2%}")
        )

    def _table(self, monitor: Monitor) -> Any:  # noqa: ANN401 - a table of Rich
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
            shown.add_row(f"probability below {significant(PERCENT * self.threshold)}%", f"{probability:.3f}")
        damping = None if now.damping is None else now.damping.ratio
        shown.add_row("net damping ratio", "not settled" if damping is None else f"{damping:.2%}")
        for alarm in self.alarms.values():
            shown.add_row("ALARM", alarm)
        return shown
