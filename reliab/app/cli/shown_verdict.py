"""What `reliab assess` prints first about a test: verdict, error, what to improve, in twelve lines."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from reliab.app.cli.output import console, say, show_table
from reliab.core.significant_digits import counted, percent, percent_with_interval, significant
from reliab.core.vocabulary import PERCENT, Metric

if TYPE_CHECKING:
    from reliab.assessment.assessment import Assessment
    from reliab.assessment.frame_assessment import CoupledAssessment, FrameAssessment


_COLUMNS = {
    "test": "left",
    "verdict": "left",
    "error": "right",
    "90 % interval": "right",
    "probability": "right",
    "A": "right",
    "d, ms": "right",
}


def show_details(
    assessment: "Assessment | FrameAssessment | CoupledAssessment", channels: list[dict[str, Any]]
) -> None:
    """Print what the report of a test says, below the verdict, and the `channels` that were recognised."""
    from reliab.assessment.assessment import Assessment
    from reliab.assessment.frame_assessment import CoupledAssessment
    from reliab.report.kinds.assessment.frame import frame_assessment_report, modes_table
    from reliab.report.kinds.assessment.report import assessment_report
    from reliab.report.terminal import print_blocks, print_document

    if isinstance(assessment, Assessment):
        notes = tuple(_by_index(assessment))
        print_document(assessment_report(assessment, provenance={}, notes=notes), console())
    else:
        print_document(frame_assessment_report(assessment, provenance={}), console())
    if isinstance(assessment, CoupledAssessment):
        print_blocks((modes_table(assessment),), console())
    if channels:
        read = (f"{channel['channel']} = {_column(channel)}" for channel in channels)
        say(f"Channels: {'; '.join(read)}.")


def _column(channel: dict[str, Any]) -> str:
    unit = channel["unit"] or "no unit"
    return f"{channel['column']!r} ({unit}; {channel['reason']})"


def _by_index(assessment: "Assessment") -> Iterator[str]:
    """Say what follows from A and d alone."""
    from reliab.assessment.verdict import probability_text

    if assessment.index_probability is not None:
        basis = "its own ground motion" if assessment.placement is not None else "comparable ground motions"
        yield (
            f"By A and d, the error stays below the threshold under {basis} with probability "
            f"{probability_text(assessment.index_probability)}."
        )
    yield from assessment.verdict_by_index.would_decide


def show_several(contents: list[dict[str, Any]]) -> None:
    """Print the verdicts of tests."""
    judged = [content for content in contents if "fault" not in content]
    asked = f", {judged[0]['metric'].upper()} against {percent(judged[0]['threshold'])}" if judged else ""
    title = f"Verdicts on {counted(len(contents), 'test')}{asked}"
    show_table(title, _COLUMNS, map(_row, contents))
    for content in contents:
        say(*(f"{content['file']}: {sentence}" for sentence in _why(content)))


def show_same_test(content: dict[str, Any]) -> None:
    """Print the verdicts on runs of one test."""
    from reliab.assessment.verdict import probability_text

    asked = f"{content['metric'].upper()} against {percent(content['threshold'])}"
    columns = {"run": "left", "verdict": "left", "gain": "right", "d, ms": "right"}
    columns |= dict.fromkeys(("alone", "all runs", "90 % interval", "probability"), "right")
    rows = [
        (
            run["file"],
            run["verdict"].replace("_", " "),
            f"{run['gain']:.3f}",
            f"{run['d_ms']:.2f}",
            *(percent(run[way]["value"], decimals=2) for way in ("alone", "error")),
            " to ".join(percent(run["error"][end], decimals=2) for end in ("low", "high")),
            probability_text(run["probability"]),
        )
        for run in content["runs"]
    ]
    show_table(f"{len(content['runs'])} runs of one test, {asked}", columns, rows)
    say(*content["warnings"])


def _row(content: dict[str, Any]) -> list[str]:
    if "fault" in content:
        return [content["file"], "not judged", *[""] * (len(_COLUMNS) - 2)]
    from reliab.assessment.verdict import probability_text

    error = content["error"][content["metric"]]
    return [
        content["file"],
        content["verdict"].replace("_", " "),
        percent(error["value"], decimals=2),
        f"{PERCENT * error['low']:.2f} … {percent(error['high'], decimals=2)}",
        probability_text(content["probability"]),
        f"{content['A']:.5f}",
        f"{content['d_ms']:.4f}",
    ]


def _why(content: dict[str, Any]) -> list[str]:
    """Say below the table why a test is not reliable or not judged."""
    if "fault" in content:
        return [content["fault"].removeprefix(f"{Path(content['file']).name}: ")]
    warnings = [f"Warning: {warning}" for warning in content["warnings"]]
    return warnings if content["reliable"] else [*content["reasons"], *warnings]


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
    from reliab.assessment.verdict import ERROR_NAMES, Word, error_in_words

    word, metric, error = Word(content["verdict"]).shout, content["metric"], content["error"]
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


def _actions(content: dict[str, Any]) -> Iterator[str]:
    """Say what to do next."""
    from reliab.assessment.verdict import next_steps

    narrowing = content["error"].get("would_decide", ())
    yield from _improve(content["error"])
    yield from (f"To narrow the interval: {remedy[:1].lower()}{remedy[1:]}" for remedy in narrowing)
    yield from next_steps(content["would_decide"], narrowing)


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
    judged = f"By the criterion for A and d: {by_index['verdict'].replace('_', ' ')}"
    return f"{tracked}. {judged}. {by_index['reasons'][-1]}"


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


def show_degrees(content: dict[str, Any]) -> None:
    """Print the errors of several displacements."""
    headings = {"degree of freedom": "left", "RMS^R": "right", "MTE^R": "right", "below": "right"}
    degrees = content["error"].get("degrees_of_freedom", {})
    if degrees:
        rows = [_degree(name, degree) for name, degree in degrees.items()]
        show_table(f"Error of {content['structure']}, with 90 % intervals", headings, rows)


def _degree(name: str, degree: dict[str, Any]) -> tuple[str, ...]:
    if not degree["judged"]:
        return (name, "not judged", "", "")
    sizes = (
        percent_with_interval(*(degree[metric][end] for end in ("value", "low", "high")))
        for metric in ("rms", "mte")
    )
    return (name, *sizes, significant(degree["probability"], 2))
