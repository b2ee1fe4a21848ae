"""What `reliab assess` prints first about a test: verdict, error, what to improve, in ten lines."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from reliab.app.cli.output import console, say, say_briefly, show_rows, show_table
from reliab.core.significant_digits import counted, percent, percent_with_interval, significant
from reliab.core.vocabulary import ERROR_NAMES, Metric

if TYPE_CHECKING:
    from reliab.assessment.assess import AnyAssessment
    from reliab.assessment.assessment import Assessment
    from reliab.assessment.same_test import SameTest


def show_details(assessment: "AnyAssessment", channels: list[dict[str, Any]]) -> None:
    """Print what the report of a test says, below the verdict, and the `channels` that were recognised."""
    from reliab.assessment.assessment import Assessment
    from reliab.assessment.frame_assessment import CoupledAssessment
    from reliab.report.kinds.assessment.frame import frame_assessment_report, modes_table
    from reliab.report.kinds.assessment.report import assessment_report
    from reliab.report.terminal import print_blocks, print_document

    if isinstance(assessment, Assessment):
        notes = tuple(_describe_index_verdict(assessment))
        print_document(assessment_report(assessment, provenance={}, notes=notes), console())
    else:
        print_document(frame_assessment_report(assessment, provenance={}), console())
    if isinstance(assessment, CoupledAssessment):
        print_blocks((modes_table(assessment),), console())
    if channels:
        columns = (
            f"{item['channel']} = {item['column']!r} ({item['unit'] or 'no unit'}; {item['reason']})"
            for item in channels
        )
        say(f"Channels: {'; '.join(columns)}.")


def _describe_index_verdict(assessment: "Assessment") -> Iterator[str]:
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
    from reliab.assessment.several import Assessments

    assessed = [content for content in contents if "fault" not in content]
    request = (
        f", {ERROR_NAMES[Metric(assessed[0]['metric'])]} against {percent(assessed[0]['threshold'])}"
        if assessed
        else ""
    )
    title = f"Verdicts on {counted(len(contents), 'test')}{request}"
    show_rows(title, Assessments.table_columns, contents)
    for content in contents:
        say(*(f"{content['file']}: {sentence}" for sentence in _explain_verdict(content)))


def show_same_test(runs: "SameTest") -> None:
    """Print the verdicts on runs of one test."""
    request = f"{ERROR_NAMES[runs.metric]} against {percent(runs.threshold)}"
    title = f"{len(runs.runs)} runs of one test, {request}"
    show_rows(title, runs.table_columns, runs.plain_rows())
    say(*runs.sentences)


def _explain_verdict(content: dict[str, Any]) -> list[str]:
    """Say below the table why a test is not reliable or not judged."""
    if "fault" in content:
        return [content["fault"].removeprefix(f"{Path(content['file']).name}: ")]
    warnings = [f"Warning: {warning}" for warning in content["warnings"]]
    return warnings if content["reliable"] else [*content["reasons"], *warnings]


_STYLES = {"reliable": "bold green", "undecided": "bold yellow", "not_reliable": "bold red"}


def show_briefly(content: dict[str, Any], *, omits_details: bool) -> None:
    """Print verdict, error, doubts and remedies; where no details follow, what fits, the remedies last."""
    from reliab.assessment import brief

    headline, style = brief.headline(content), _STYLES[content["verdict"]]
    findings, actions = list(brief.findings(content)), list(brief.actions(content))
    if not omits_details:
        say(headline, style=style)
        say(*findings, *actions)
        return
    warnings = [warning for warning in content["warnings"] if warning not in content["reasons"]]
    further = [*map("Warning: {}".format, warnings), *_channels(content["recording"]["channels"])]

    def hidden(shown: int) -> str:
        shown_warnings = max(shown - len(findings), 0)
        return _hidden(max(len(warnings) - shown_warnings, 0), len(content["notes"]))

    say_briefly(headline, [*findings, *further], actions, hidden=hidden, style=style)


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
    headings = {"degree of freedom": "left", "RMS error": "right", "largest error": "right", "below": "right"}
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
