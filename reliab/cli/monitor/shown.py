"""What `reliab monitor` prints: lines, alarms at once, and on a terminal a table that is kept up to date."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Self

from rich.live import Live

from reliab.cli.output import console, table
from reliab.significant import percent, percent_with_interval
from reliab.vocabulary import Metric

if TYPE_CHECKING:
    from reliab.api import Message

_NO_MOTION = "No displacement moves enough for the noise of its sensors."


class Screen:
    """Shows messages of a running test; `threshold` [-]."""

    def __init__(self, *, metric: str, threshold: float, quiet: bool) -> None:
        self._metric, self._threshold, self._quiet = Metric.parse(metric), threshold, quiet
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
            if content["above_threshold"] is None:
                self._print(_still_learning(content) if "specimen" in content else _NO_MOTION)
                limit = percent(self._threshold, decimals=2)
                self._print(f"Whether the error of the whole test is above {limit} is undecided.")
                return
            self._print(_line(content, self._metric, self._threshold))
            side = "above" if content["above_threshold"] else "not above"
            self._print(f"The error of the whole test is {side} {percent(self._threshold, decimals=2)}.")
        elif self._live is not None:
            self._live.update(_table(message, self._metric, self._threshold))
        elif "error" in content:
            self._print(_line(content, self._metric, self._threshold))
        elif content.get("specimen", {}).get("until_s") == content["time_s"]:
            self._print(_still_learning(content))

    def _print(self, text: str, style: str | None = None) -> None:
        """Print a line at once, in a pipe too."""
        self._terminal.print(text, style=style, highlight=False)
        self._terminal.file.flush()


def _still_learning(message: Mapping[str, Any]) -> str:
    """Say that the specimen is not learned yet, and how far that is."""
    missed = message["specimen"]["held_out"]
    far = "nothing was learned" if missed is None else f"{percent(missed, decimals=0)} of its force is missed"
    return f"{message['time_s']:8.2f} s  still learning the specimen: {far} on parts that were held out"


def _line(message: Mapping[str, Any], metric: Metric, threshold: float) -> str:
    error = message["error"][metric]
    damping, deviation = message["net_damping_ratio"], message["net_damping_deviation"]
    return (
        f"{message['time_s']:8.2f} s  {metric.upper()}{_governing(message)} "
        f"{percent(error['value'], decimals=2)} (90 %: "
        f"{percent(error['low'], decimals=2)} to {percent(error['high'], decimals=2)}), below "
        f"{percent(threshold)} with "
        f"probability {message['error']['probability']:.3f}, net damping "
        + ("not settled" if damping is None else _with_deviation(damping, deviation))
        + (", near instability" if message["near_instability"] else "")
    )


def _with_deviation(damping: float, deviation: float) -> str:
    """Net damping with its standard error."""
    return f"{100.0 * damping:.2f} ± {percent(deviation, decimals=2)}"


def _governing(message: Mapping[str, Any]) -> str:
    """Name the displacement of several with the largest error."""
    return f" of {message['governing']}" if "governing" in message else ""


def _table(message: "Message", metric: Metric, threshold: float) -> Any:  # noqa: ANN401 - a table of Rich
    now, result = message.monitor.now, message.monitor.result
    shown = table(
        f"{now.time:.2f} s of the test, {now.samples} samples", {"quantity": "left", "value": "right"}
    )
    if now.error is None or now.rms is None or now.mte is None:
        shown.add_row("specimen", "still learning")
    else:
        if "governing" in message.to_dict():
            shown.add_row("displacement with the largest error", message.to_dict()["governing"])
        shown.add_row("error now, mm", f"{1e3 * now.error:.3f}")
        shown.add_row("RMS^R so far, with noise", percent(now.rms, decimals=2))
        shown.add_row("MTE^R so far, with noise", percent(now.mte, decimals=2))
    if result is not None:
        error = result.estimate(metric)
        shown.add_row(
            f"{metric.upper()} with its 90 % interval",
            percent_with_interval(error.value, error.low, error.high),
        )
        probability = result.probability(threshold, metric)
        shown.add_row(f"probability below {percent(threshold)}", f"{probability:.3f}")
    shown.add_row(
        "net damping ratio",
        "not settled" if now.damping is None else _with_deviation(now.damping.ratio, now.damping.deviation),
    )
    for alarm in message.alarms.values():
        shown.add_row("ALARM", alarm)
    return shown
