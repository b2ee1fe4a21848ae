"""`reliab assess`, `compare` and `extrapolate`: the verdict on a test or several, and what is printed."""

from collections.abc import Iterator, Sequence
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypedDict

import typer

from reliab.app import options, questions
from reliab.app.api.arguments import refuse_stated
from reliab.app.cli.commands import Request, files_of, takes
from reliab.app.cli.output import console, progress_bar, say, say_briefly, show_rows, show_table, write_json
from reliab.app.declaration import group
from reliab.app.options import OUTPUT
from reliab.core.errors import InputError
from reliab.core.progress import silent
from reliab.core.significant_digits import counted, percent, percent_with_interval, significant
from reliab.core.vocabulary import ERROR_NAMES, Metric

if TYPE_CHECKING:
    from reliab.assessment.assess import AnyAssessment
    from reliab.assessment.assessment import Assessment
    from reliab.assessment.several import Assessments

_COMMON_OPTIONS = ("tests", "out", "check")


@group
class _OneTest(TypedDict, total=False):
    """What is written of one test.

    report: Write a report of two pages, to be filed with the test.
    corrected: Write the response that a perfect actuator would have produced, with its band.
    """

    report: Annotated[Path | None, OUTPUT.option("FILE.pdf", endings=(".pdf",))]
    corrected: Annotated[Path | None, OUTPUT.advanced("FILE.csv|nc", endings=(".csv", ".nc"))]


@takes(
    questions.AssessmentQuestion,
    options.Tests,
    options.CHECK,
    options.Cover,
    options.DETAILS,
    _OneTest,
    needs=dict.fromkeys(options.Cover.__annotations__, "report"),
)
def assess(request: Request) -> None:
    """Judge a test by its error, from command and measured displacement."""
    files = files_of(request.tests, request.out)
    has_several = len(files) != 1 or request.test_name == "all"
    if has_several and files:
        for name, content in (("report", "a report is of"), ("corrected", "the response is that of")):
            reason = f"together with several tests, since {content} one test"
            refuse_stated({name: getattr(request, name)}, name, reason=reason)
    cover = options.Cover.__annotations__ if request.report is not None else ()
    if request.report is not None:
        request.setting()  # refused before the test is judged, not after it
    verdicts = _verdicts(request, files, "corrected", "details", "report", *cover)
    if has_several:
        _write_several(verdicts, request)
    else:
        _write_one(verdicts, files[0], request)
    if request.check and not verdicts.reliable:
        raise typer.Exit(1)


@takes(questions.AssessmentQuestion, options.Tests, options.CHECK)
def extrapolate(request: Request) -> None:
    """Extrapolate runs of one test with different delays or gains to zero error.

    The extrapolation itself uses neither structure nor specimen.
    """
    from reliab.app.api.assessment import write_tests

    files = files_of(request.tests, request.out)
    if len(files) == 1 and request.test_name != "all":
        raise InputError("`reliab extrapolate` needs two tests or more", remedy="Name every run of the test")
    runs = _verdicts(request, files)
    extrapolation = runs.same_test()
    if request.out is not None:
        write_tests([{"file": file, **content} for file, content in runs.to_dict().items()], request.out)
    if not write_json(extrapolation.to_dict(), request.json_target):
        verdict = f"{ERROR_NAMES[extrapolation.metric]} against {percent(extrapolation.threshold)}"
        title = f"{len(extrapolation.runs)} runs of one test, {verdict}"
        show_rows(title, extrapolation.table_columns, extrapolation.plain_rows())
        say(*extrapolation.sentences)
    if request.check and not extrapolation.reliable:
        raise typer.Exit(1)


def _verdicts(request: Request, files: Sequence[Path], *uses: str) -> Any:  # noqa: ANN401 - of one test or several
    """Judge tests."""
    from reliab.app.api.assessment import assess as api_assess

    has_several = len(files) != 1 or request.test_name == "all"
    with progress_bar("tests") if has_several else nullcontext(silent) as progress:
        return request.ask(
            api_assess,
            *_COMMON_OPTIONS,
            *uses,
            test=files[0] if len(files) == 1 else files,
            progress=progress,
        )


def _write_one(assessment: "AnyAssessment", test: Path, request: Request) -> None:
    from reliab.app.api.assessment import file_report, write_corrected, write_tests

    content = assessment.to_dict()
    if request.out is not None:
        write_tests([{"file": str(test), **content}], request.out)
    note = None if request.corrected is None else write_corrected(assessment, request.corrected)
    if not write_json(content, request.json_target):
        show_briefly(content, omits_details=not request.details)
        if request.details:
            show_details(assessment, content["recording"]["channels"])
        else:
            show_degrees(content)
        if note is not None:
            say(f"{request.corrected}: {note}")
    if request.report is not None:
        setting = request.setting()
        file_report(assessment, request.report, test=test, structure=request.structure, setting=setting)


def _write_several(assessments: "Assessments", request: Request) -> None:
    from reliab.app.api.assessment import write_tests

    contents = [
        {
            "file": file,
            **({"fault": request.write_as_options(content["fault"])} if "fault" in content else content),
        }
        for file, content in assessments.to_dict().items()
    ]
    if request.out is not None:
        write_tests(contents, request.out)
    if not write_json(contents, request.json_target):
        show_several(contents)
    if assessments.faults:
        raise InputError(
            f"{len(assessments.faults)} of {len(contents)} files could not be judged: "
            f"{', '.join(assessments.faults)}",
            remedy="Correct them as stated above, or leave them out; the other tests were judged",
        )


@takes(questions.AssessmentQuestion, options.Tests, options.CHART, options.DETAILS)
def compare(request: Request) -> None:
    """Rank tests by error and say how certain the ranking is.

    The tests are of one structure and rig, such as one motion with each compensator.
    """
    from reliab.app.api.assessment import assess, draw_chart, write_tests
    from reliab.assessment.comparison import rank_tests
    from reliab.report.kinds.comparison import comparison_report, next_step
    from reliab.report.prose import words_of
    from reliab.report.terminal import print_blocks

    files = files_of(request.tests, request.out)
    with progress_bar("tests") as progress:
        verdicts: Any = request.ask(
            assess,
            *("tests", "out", "figure", "details"),
            test=files[0] if len(files) == 1 and request.test_name == "all" else files,
            progress=progress,
        )
    comparison = rank_tests(verdicts.judged, verdicts.faults)
    if request.out is not None:
        write_tests(comparison, request.out)
    content = comparison.to_dict()
    content["faults"] = {file: request.write_as_options(fault) for file, fault in content["faults"].items()}
    if not write_json(content, request.json_target):
        document = comparison_report(replace(comparison, faults=content["faults"]), has_figure=False)
        say(words_of(document.verdict), style="bold")
        table, limits = document.blocks
        print_blocks((table, limits) if request.details else (table,), console())
        if not request.details:
            say(*(f"{file}: {fault}" for file, fault in content["faults"].items()))
            say(f"{counted(len(comparison.notes) + 1, 'note')} on the ranking: run with --details.")
        say(f"Next step: {next_step(comparison)}")
    if request.figure is not None:
        draw_chart(comparison, request.figure)


def show_details(assessment: "AnyAssessment", channels: list[dict[str, Any]]) -> None:
    """Print what the report of a test says, below the verdict, and the `channels` that were recognised."""
    from reliab.assessment.assessment import Assessment
    from reliab.report.kinds.assessment.frame import frame_assessment_report
    from reliab.report.kinds.assessment.report import assessment_report
    from reliab.report.terminal import print_document

    if isinstance(assessment, Assessment):
        notes = tuple(_describe_index_verdict(assessment))
        print_document(assessment_report(assessment, provenance={}, notes=notes), console())
    else:
        print_document(frame_assessment_report(assessment, provenance={}), console())
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
