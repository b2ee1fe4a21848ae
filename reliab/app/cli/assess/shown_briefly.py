"""What `reliab assess` prints first about a test: verdict, error, what to improve, in twelve lines."""

from collections.abc import Iterator
from typing import Any

from reliab.app.cli.output import console, say, table
from reliab.core.significant_digits import counted, percent, percent_with_interval, significant
from reliab.core.vocabulary import Metric

_STYLES = {"reliable": "bold green", "undecided": "bold yellow", "not_reliable": "bold red"}
_LINES = 12
_LARGEST = 3  # entries of the budget


def show_briefly(content: dict[str, Any], *, without_details: bool) -> None:
    """Print verdict, error, doubts and remedies; warnings as far as they fit where no details follow."""
    say(_headline(content), style=_STYLES[content["verdict"]])
    found, actions = list(_findings(content)), list(_actions(content))
    if without_details:
        further = [warning for warning in content["warnings"] if warning not in content["reasons"]]
        more = [*map("Warning: {}".format, further), *_channels(content["recording"]["channels"])]
        room = _LINES - 2 - sum(map(_lines, [*found, *actions]))
        while more and sum(map(_lines, more)) > room:
            more.pop()
        found += [*more, _hidden(max(len(further) - len(more), 0), len(content["notes"]))]
    say(*found, *actions)


def _lines(sentence: str) -> int:
    """Lines of the terminal that a sentence takes."""
    from rich.text import Text

    terminal = console()
    return len(Text(sentence).wrap(terminal, terminal.width))


def _headline(content: dict[str, Any]) -> str:
    from reliab.assessment.rebuilt_error.spread import Estimate
    from reliab.assessment.verdict import ERROR_NAMES, error_in_words

    word, metric, error = content["verdict"].replace("_", " ").upper(), content["metric"], content["error"]
    if error[metric]["value"] is None:
        return f"{word}: {content['reasons'][-1]}"
    name, size = (
        f"{ERROR_NAMES[metric]}{_of_governing(error)}",
        Estimate(**{end: error[metric][end] for end in ("value", "low", "high")}),
    )
    return f"{word}: {error_in_words(name, size, content['threshold'], content['probability'])}"


def _of_governing(error: dict[str, Any]) -> str:
    """Of several displacements the one with the largest error, to follow a name."""
    return f" of {error['governing']}" if "governing" in error else ""


def _findings(content: dict[str, Any]) -> Iterator[str]:
    """Say how large the error is, what its interval comes from, and how the actuator tracked."""
    yield from content["reasons"][:-1]  # the last one says the size, as the headline does
    if content["error"][content["metric"]]["value"] is not None:
        yield f"Errors with 90 % intervals: {_error(content, 'rms')}; {_error(content, 'mte')}."
    yield from _widest(content)
    yield _tracking(content)


def _actions(content: dict[str, Any]) -> Iterator[str]:
    """Say what to do next."""
    from reliab.assessment.verdict import next_steps

    narrowing = content["error"].get("would_decide", ())
    yield from _improve(content["error"])
    yield from (f"To narrow the interval: {remedy[:1].lower()}{remedy[1:]}" for remedy in narrowing)
    yield from next_steps(content["would_decide"], narrowing)


def _error(content: dict[str, Any], metric: str) -> str:
    from reliab.assessment.verdict import ERROR_NAMES

    size = percent_with_interval(*(content["error"][metric][key] for key in ("value", "low", "high")))
    return f"{ERROR_NAMES[Metric(metric)]} {size}"


def _improve(error: dict[str, Any]) -> Iterator[str]:
    from reliab.assessment.error_of_test import CANCELLING, part_in_words

    first = error["improve_first"]
    if first is None and error["parts"]:
        yield CANCELLING
    elif first is not None:
        remaining = percent(error["parts"][first]["remaining_rms"], decimals=2)
        yield (
            f"Improve first: {part_in_words(first)}; without it RMS^R{_of_governing(error)} would be "
            f"{remaining}."
        )


def _widest(content: dict[str, Any]) -> Iterator[str]:
    """Largest contributions to the uncertainty of the error."""
    budget = content.get("budget", [])
    if budget:
        entries = (
            f"{item['quantity']} ±{percent(item['contribution'], decimals=2)}" for item in budget[:_LARGEST]
        )
        yield f"Largest contributions to the interval: {', '.join(entries)}."


def budget_table(content: dict[str, Any]) -> Any:  # noqa: ANN401 - Rich's table
    """Tabulate what is not known exactly, the largest contribution to the interval first."""
    shown = table(
        "Uncertain quantities, and the standard deviation of the error that each causes alone",
        {"quantity": "left", "std. deviation": "right", "source": "left", "effect on the error": "right"},
    )
    for item in content["budget"]:
        size = "" if item["size"] is None else f"{significant(item['size'], 2)} {item['unit']}"
        shown.add_row(item["quantity"], size, item["source"], percent(item["contribution"], decimals=2))
    return shown


def _tracking(content: dict[str, Any]) -> str:
    actuators = [{"name": "", **actuator} for actuator in content.get("actuators", [content])]
    each = (
        f"{'actuator ' if one['name'] else ''}{one['name']} A = {one['A']:.4f}, d = "
        f"{significant(one['d_ms'])} ms".lstrip()
        for one in actuators
    )
    tracked = f"Tracking: {'; '.join(each)}"
    by_index = content.get("by_index")
    if by_index is None or by_index["index"] is None:
        return f"{tracked}."
    return f"{tracked}. {index_in_words(by_index)}"


def index_in_words(by_index: dict[str, Any]) -> str:
    """Say what the criterion for A and d says of a test, and why."""
    return f"By the criterion for A and d: {by_index['verdict'].replace('_', ' ')}. {by_index['reasons'][-1]}"


def _channels(channels: list[dict[str, Any]]) -> Iterator[str]:
    if channels:
        read = (
            f"{channel['channel']} = {channel['column']!r} ({channel['unit'] or 'no unit'})"
            for channel in channels
        )
        yield f"Channels: {', '.join(read)}."


def _hidden(warnings: int, notes: int) -> str:
    counts = [
        counted(count, word) for count, word in ((warnings, "further warning"), (notes, "note")) if count
    ]
    return f"{' and '.join(counts) or 'All results'}: run with --details."


def show_remarks(content: dict[str, Any]) -> None:
    """Print warnings, the columns that were recognised, each with its unit and the reason, and notes."""
    say(*(f"Warning: {warning}" for warning in content["warnings"]), style="yellow")
    if channels := content["recording"]["channels"]:
        read = (f"{channel['channel']} = {_column(channel)}" for channel in channels)
        say(f"Channels: {'; '.join(read)}.")
    say(*(f"Note: {note}" for note in content["notes"]))


def _column(channel: dict[str, Any]) -> str:
    unit = channel["unit"] or "no unit"
    return f"{channel['column']!r} ({unit}; {channel['reason']})"
