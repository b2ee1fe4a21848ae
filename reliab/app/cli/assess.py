"""`reliab assess`, `design` and `extrapolate`: the verdict on a test, and what is tolerable before one."""

from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from reliab.app import options, questions
from reliab.app.cli.commands import Request, files_of, takes
from reliab.app.cli.output import progress_bar, say, say_population, show_rows, write_json
from reliab.app.declaration import group
from reliab.app.options import OUTPUT
from reliab.core.errors import InputError
from reliab.core.progress import silent
from reliab.core.significant_digits import percent
from reliab.core.vocabulary import MILLI

if TYPE_CHECKING:
    from reliab.app.api.design import Design
    from reliab.assessment.assess import AnyAssessment
    from reliab.assessment.design import TolerableErrors
    from reliab.assessment.several import Assessments

_COMMON_OPTIONS = ("tests", "out", "check")


@group
class _OneTest(options.Tests, options.Check, options.Cover, options.Details, total=False):
    """Tests to judge, or what is written.

    report: Write a report of two pages, to be filed with the test.
    corrected: Write the response that a perfect actuator would have produced, with its band.
    """

    report: Annotated[Path | None, OUTPUT.option("FILE.pdf", endings=(".pdf",))]
    corrected: Annotated[Path | None, OUTPUT.advanced("FILE.csv|nc", endings=(".csv", ".nc"))]


@takes(
    questions.AssessmentQuestion,
    _OneTest,
    needs=dict.fromkeys(options.Cover.__annotations__, "report"),
)
def assess(request: Request) -> None:
    """Judge a test by its error, from command and measured displacement."""
    from reliab.app.api.arguments import refuse_stated

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


@takes(questions.DesignQuestion, options.Chart, options.Details)
def design(request: Request) -> None:
    """Print how much amplitude error and delay are tolerable, before a test."""
    from reliab.app.api.assessment_files import draw_chart
    from reliab.app.api.design import design_test

    result = request.answer(
        design_test,
        lambda design: show_design(design, details=request.details, chosen=request.confidence is not None),
        "figure",
        "details",
    )
    if request.figure is not None:
        draw_chart(result, request.figure)


@takes(questions.AssessmentQuestion, options.Tests, options.Check)
def extrapolate(request: Request) -> None:
    """Extrapolate runs of one test with different delays or gains to zero error.

    The extrapolation itself uses neither structure nor specimen.
    """
    from reliab.app.api.assessment_files import write_tests
    from reliab.app.cli.shown_verdict import show_same_test

    files = files_of(request.tests, request.out)
    if len(files) == 1 and request.test_name != "all":
        raise InputError("`reliab extrapolate` needs two tests or more", remedy="Name every run of the test")
    runs = _verdicts(request, files)
    extrapolation = runs.same_test()
    if request.out is not None:
        write_tests([{"file": file, **content} for file, content in runs.to_dict().items()], request.out)
    if not write_json(extrapolation.to_dict(), request.json_target):
        show_same_test(extrapolation)
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
    from reliab.app.api.assessment_files import file_report, write_corrected, write_tests
    from reliab.app.cli.shown_verdict import show_briefly, show_degrees, show_details

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
    from reliab.app.api.assessment_files import write_tests
    from reliab.app.cli.shown_verdict import show_several

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


_NINETY_FIVE = 0.95
_BAR = 40


def show_design(design: "Design", *, details: bool, chosen: bool = False) -> None:
    """Print tolerable errors at 95 % or the `chosen` confidences; with `details` all of them, and a chart."""
    from reliab.app.api.design import Design
    from reliab.app.cli.criterion import limits_in_words

    rows = design.tolerances if details or chosen else _at_ninety_five(design.tolerances)
    first = rows[0]
    say(limits_in_words(first.to_dict()), style="bold")
    share = "" if first.experimental_fraction == 1.0 else f" and α = {first.experimental_fraction:g}"
    title = f"Tolerable errors at ξ = {first.damping_ratio:g}{share}, error {percent(first.threshold)}"
    show_rows(title if details else "", Design.table_columns, (row.to_dict() for row in rows))
    say_population(((row.promise, row.population) for row in rows), first.position)
    if any(tolerance.outside_validity for tolerance in rows):
        say("Note: the criterion does not cover *; these limits are scaled from the nearest structure.")
    if details:
        _show_chart(design.chart)
    else:
        say("Other confidences and frequencies: run with --details.")
    structure = f"--f {first.frequency:g} --xi {first.damping_ratio:g}"
    say(f"Next step: judge a test with `reliab assess TEST {structure}`, of a frame with --structure FRAME.")


def _at_ninety_five(tolerances: "Sequence[TolerableErrors]") -> "list[TolerableErrors]":
    """Select the confidence nearest to 95 %."""
    confidence = min((one.confidence for one in tolerances), key=lambda value: abs(value - _NINETY_FIVE))
    return [one for one in tolerances if one.confidence == confidence]


def _show_chart(chart: "Sequence[TolerableErrors]") -> None:
    """Bars of the tolerable delay over the frequency at one confidence, the longest being the widest."""
    from reliab.app.api.design import Design

    points = _at_ninety_five(chart)
    promise, longest = points[0].promise, max(MILLI * point.delay for point in points)
    share = "no share promised" if promise is None else f"at {percent(promise, decimals=0)}"
    columns = {name: Design.table_columns[name] for name in ("f [Hz]", "|A − 1| alone", "d alone [ms]")} | {
        "d": ("delay_limit_ms", lambda late: "█" * max(round(_BAR * late / longest), 1), "left")
    }
    show_rows(f"Over the frequency, {share}", columns, (point.to_dict() for point in points))
