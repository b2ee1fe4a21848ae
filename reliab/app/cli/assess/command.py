"""`reliab assess`, `design` and `extrapolate`: the verdict on a test, and what is tolerable before one."""

from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from reliab.app import options, outputs, questions
from reliab.app.cli.commands import Asked, takes
from reliab.app.cli.test_files import files_of
from reliab.app.options import OUTPUT
from reliab.core.errors import InputError
from reliab.core.progress import silent

if TYPE_CHECKING:
    from reliab.assessment.assessment import Assessment
    from reliab.assessment.frame_assessment import CoupledAssessment, FrameAssessment
    from reliab.assessment.several import Assessments

_USED = ("tests", "out", "check", "json_target")


class _OneTest(outputs.Tests, outputs.Check, outputs.Cover, total=False):
    details: Annotated[bool, OUTPUT.flag("Print all results, not only the most important ones.")]
    report: Annotated[
        Path | None,
        OUTPUT.option(
            "FILE.pdf", "Write a report of two pages, to be filed with the test.", endings=(".pdf",)
        ),
    ]
    corrected: Annotated[
        Path | None,
        OUTPUT.further(
            "FILE.csv|nc",
            "Write the response that a perfect actuator would have produced, with its band.",
            endings=(".csv", ".nc"),
        ),
    ]


class _Former(options.Frequencies, options.Confidences, total=False):
    """Ways of asking that have become commands of their own, and the lists that one of them needs."""

    design: Annotated[bool, OUTPUT.further_flag("The same as `reliab design`.")]
    same_test: Annotated[bool, OUTPUT.further_flag("The same as `reliab extrapolate`.")]


@takes(
    questions.StatedOfTest,
    _OneTest,
    outputs.Chart,
    _Former,
    needs={"figure": "design", **dict.fromkeys(outputs.Cover.__annotations__, "report")},
    further=("figure", "confidence"),
)
def assess(asked: Asked) -> None:
    """Judge a test by its error, from command and measured displacement."""
    if asked.design:
        _answer_design(asked)
        return
    judge = _answer_same_test if asked.same_test else _answer_tests
    if not judge(asked) and asked.check:
        raise typer.Exit(1)


@takes(questions.Design, outputs.Chart)
def design(asked: Asked) -> None:
    """Print how much amplitude error and delay are tolerable, before a test."""
    _answer_design(asked)


@takes(questions.StatedOfTest, outputs.Tests, outputs.Check)
def extrapolate(asked: Asked) -> None:
    """Extrapolate runs of one test with different delays or gains to zero error.

    The extrapolation itself uses neither structure nor specimen.
    """
    if not _answer_same_test(asked) and asked.check:
        raise typer.Exit(1)


def _answer_design(asked: Asked) -> None:
    from reliab.app.api.assessment_files import draw_chart
    from reliab.app.api.design import design_test
    from reliab.app.cli.assess.shown_design import show_design
    from reliab.app.cli.output import write_json

    if "tests" in asked.given:
        raise InputError("`design` is for the time before a test", remedy="Leave the file out, or `design`")
    if "structure" in asked.given:
        raise InputError(
            "A design is for structures of one mass, not for frames",
            value=f"`structure={asked.structure}`",
            remedy="Judge a trial test of the frame with `reliab assess TEST --structure FRAME`, or predict "
            "the next one from earlier tests of it with `reliab rig predict RIG --structure FRAME`",
        )
    found = asked.ask(design_test, "design", "figure", "json_target", why="together with `design`")
    if asked.figure is not None:
        draw_chart(found, asked.figure)
    if not write_json(found.to_dict(), asked.json_target):
        show_design(found)


def _verdicts(asked: Asked, files: Sequence[Path], *uses: str) -> Any:  # noqa: ANN401 - of one test or several
    """Judge tests."""
    from reliab.app.api.assessment import assess as api_assess
    from reliab.app.cli.output import progress_bar

    several = len(files) != 1 or asked.test_name == "all"
    with progress_bar("tests") if several else nullcontext(silent) as progress:
        return asked.ask(
            api_assess,
            *_USED,
            *uses,
            test=files[0] if len(files) == 1 else files,
            f=_only_value(asked.f, "f"),
            confidence=_only_value(asked.confidence, "confidence"),
            progress=progress,
        )


def _only_value(values: Any, name: str) -> Any:  # noqa: ANN401 - of many types
    """Take the value of an option that may be repeated for a design, but not for a test."""
    if not isinstance(values, list):
        return values
    if len(values) > 1:
        raise InputError(
            f"A test has one `{name}`", value=len(values), remedy="Give several with `design` only"
        )
    return values[0] if values else None


def _answer_tests(asked: Asked) -> bool:
    """Judge tests; write and print what is found; return whether all are reliable."""
    from reliab.app.api.arguments import unused
    from reliab.app.api.assessment_files import file_report

    files = files_of(asked.tests, asked.out)
    several = len(files) != 1 or asked.test_name == "all"
    if asked.report is not None and several and files:
        raise unused("report", "together with several tests, since a report is of one test")
    if asked.corrected is not None and several and files:
        raise unused("corrected", "together with several tests, since the response is that of one test")
    cover = outputs.Cover.__annotations__ if asked.report is not None else ()
    verdicts = _verdicts(asked, files, "corrected", "details", "report", *cover)
    if several:
        _write_several(verdicts, asked)
        return bool(verdicts.reliable)
    _write_one(verdicts, files[0], asked)
    if asked.report is not None:
        file_report(verdicts, asked.report, test=files[0], structure=asked.structure, setting=asked.setting())
    return bool(verdicts.reliable)


def _answer_same_test(asked: Asked) -> bool:
    """Extrapolate runs of one test; write and print what is found; return whether it is reliable."""
    from reliab.app.api.assessment_files import write_tests
    from reliab.app.cli.assess.shown_test import show_same_test
    from reliab.app.cli.output import write_json

    files = files_of(asked.tests, asked.out)
    if len(files) == 1 and asked.test_name != "all":
        raise InputError("`same_test` needs two tests or more", remedy="Name every run of the test")
    runs = _verdicts(asked, files, "details", "same_test")
    together = runs.same_test()
    if asked.out is not None:
        write_tests([{"file": file, **found} for file, found in runs.to_dict().items()], asked.out)
    if not write_json(together.to_dict(), asked.json_target):
        show_same_test(together.to_dict())
    return bool(together.reliable)


def _write_one(
    assessment: "Assessment | FrameAssessment | CoupledAssessment", test: Path, asked: Asked
) -> None:
    from reliab.app.api.assessment_files import write_corrected, write_tests
    from reliab.app.cli.output import say, write_json

    content = assessment.to_dict()
    if asked.out is not None:
        write_tests([{"file": str(test), **content}], asked.out)
    note = None if asked.corrected is None else write_corrected(assessment, asked.corrected)
    if write_json(content, asked.json_target):
        return
    _show_one(assessment, content, details=asked.details)
    if note is not None:
        say(f"{asked.corrected}: {note}")


def _show_one(
    assessment: "Assessment | FrameAssessment | CoupledAssessment",
    content: dict[str, Any],
    *,
    details: bool,
) -> None:
    from reliab.app.cli.assess.shown_briefly import show_briefly
    from reliab.assessment.assessment import Assessment

    show_briefly(content, without_details=not details)
    if not isinstance(assessment, Assessment):
        from reliab.app.cli.assess.shown_frame import show_frame

        show_frame(content, details=details)
    elif details:
        from reliab.app.cli.assess.shown_test import show_assessment

        show_assessment(assessment, content)


def _write_several(assessments: "Assessments", asked: Asked) -> None:
    from reliab.app.api.assessment_files import write_tests
    from reliab.app.cli.assess.shown_test import show_several
    from reliab.app.cli.output import write_json

    contents = [
        {"file": file, **({"fault": asked.in_options(content["fault"])} if "fault" in content else content)}
        for file, content in assessments.to_dict().items()
    ]
    if asked.out is not None:
        write_tests(contents, asked.out)
    if not write_json(contents, asked.json_target):
        show_several(contents)
    if assessments.faults:
        raise InputError(
            f"{len(assessments.faults)} of {len(contents)} files could not be judged: "
            f"{', '.join(assessments.faults)}",
            remedy="Correct them as stated above, or leave them out; the other tests were judged",
        )
