"""Messages about a running test, a table that is kept up to date, and alarms."""

import json
from collections.abc import Iterator
from contextlib import AbstractContextManager, nullcontext
from typing import Any, TextIO

from rich.live import Live

from reliab.cli.monitor.followed_rows import Rows
from reliab.cli.monitor.sample_times import at_equal_steps, time_step
from reliab.cli.monitor.stated_test import StatedTest
from reliab.cli.output import console, table
from reliab.rebuilt_error import RebuiltError
from reliab.rebuilt_error.monitor import Monitor
from reliab.rebuilt_error.rebuild import DRAWS
from reliab.significant import significant
from reliab.vocabulary import Metric

_PERCENT = 100.0
_CRITICAL = 0.25  # share of the structure's damping ratio below which a warning is given


class Watch:
    """Prints messages, the table and the alarms of a running test.

    Parameters
    ----------
    stated : StatedTest
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
        self.alarms: list[str] = []
        self._raised: list[str] = []
        self._terminal = console()

    def follow(self, rows: Iterator[Rows], rate: float | None) -> None:
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
        step, rows = time_step(rows, rate)
        monitor = self.stated.monitor(step)
        between = max(round(self.every / step), 1)
        with self._view() as live:
            for part in at_equal_steps(rows, step):
                begin = 0
                while begin < part.command.size:
                    end = min(begin + between - monitor.samples % between, part.command.size)
                    monitor.feed(part.command[begin:end], part.measured[begin:end] / self.stated.scale.value)
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
            message["error"] = self._intervals(asked)
        self._write(message)
        if live is not None:
            live.update(self._table(monitor))
        elif asked is not None and not self.quiet:
            self._terminal.print(self._line(message), highlight=False)

    def _end(self, monitor: Monitor) -> None:
        kept = None if monitor.answerable else monitor.result
        asked = monitor.ask(draws=DRAWS) if kept is None else kept
        message = self._message(monitor, "end") | {"error": self._intervals(asked)}
        self._write(message)
        if not self.quiet:
            self._terminal.print(self._line(message), highlight=False)
            if kept is not None:
                self._terminal.print(
                    f"The test became too long for intervals: those shown are of its first "
                    f"{message['error']['until_s']:,.0f} s. The error itself was followed to the end.",
                    highlight=False,
                )
            for alarm in self.alarms:
                self._terminal.print(f"Alarm: {alarm}", style="red", highlight=False)

    def _message(self, monitor: Monitor, kind: str) -> dict[str, Any]:
        now = monitor.now
        damping = None if now.damping is None else now.damping.ratio
        if now.damping is not None and now.damping.unstable:
            self._alarm("unstable", f"the loop has gained energy since {now.time:.2f} s and may diverge")
        if monitor.exceeds(self.threshold, self.metric):
            self._alarm("error", f"the error has been above {self.threshold:.2%} since {now.time:.2f} s")
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

    def _intervals(self, asked: RebuiltError) -> dict[str, Any]:
        return {
            "rms": {"value": asked.rms.value, "low": asked.rms.low, "high": asked.rms.high},
            "mte": {"value": asked.mte.value, "low": asked.mte.low, "high": asked.mte.high},
            "until_s": (asked.error.size - 1) * asked.time_step,
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
            f"{significant(_PERCENT * self.threshold)}% with "
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
            shown.add_row(
                f"probability below {significant(_PERCENT * self.threshold)}%", f"{probability:.3f}"
            )
        damping = None if now.damping is None else now.damping.ratio
        shown.add_row("net damping ratio", "not settled" if damping is None else f"{damping:.2%}")
        for alarm in self.alarms:
            shown.add_row("ALARM", alarm)
        return shown
