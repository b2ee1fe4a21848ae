"""`reliab assess`: the verdict on a test, or what is tolerable before one."""

from collections.abc import Mapping
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import typer

from reliab.app.cli import options
from reliab.app.cli.completion import samples
from reliab.app.cli.demand import Demand, argument, flag, option, takes
from reliab.core.errors import InputError
from reliab.core.progress import silent

if TYPE_CHECKING:
    from reliab.assessment.assessment import Assessment
    from reliab.assessment.frame_assessment import CoupledAssessment, FrameAssessment
    from reliab.assessment.several import Assessments


@dataclass(frozen=True, kw_only=True)
class Answered(Demand):
    """Options of `reliab assess` about what becomes of the verdict."""

    design: bool = flag(
        "Before a test: print how much amplitude error and delay the rig may have, for each --f and "
        "--confidence; both may be given several times."
    )
    figure: Path | None = option(
        "FILE.svg|png|pdf",
        "With --design: chart of tolerable errors over f.",
        callback=options.written_as(".svg", ".png", ".pdf"),
    )
    corrected: Path | None = option(
        "FILE.csv|nc",
        "Write the response that a perfect actuator would have produced, with its band.",
        callback=options.written_as(".csv", ".nc"),
    )
    same_test: bool = flag(
        "The files are runs of one test with different delays or gains of the actuator: their "
        "responses are extrapolated to zero error, for which neither structure nor specimen needs to be "
        "known."
    )
    report: Path | None = option(
        "FILE.pdf",
        "Write a report of two pages, to be filed with the test.",
        callback=options.written_as(".pdf"),
    )
    out: Path | None = option(
        "FILE.csv",
        "Write the verdicts as a table, one row for each test.",
        callback=options.written_as(".csv"),
    )
    details: bool = flag("Print all results, not only the most important ones.")
    check: bool = flag("Exit with code 1 unless the test is reliable.")
    json_target: str | None = options.JSON_TARGET


@dataclass(frozen=True, kw_only=True)
class AssessDemand(options.JudgesTests, Answered, options.ReadsTests, options.Reported):
    """Options of `reliab assess`; those of the verdict are arguments of `reliab.assess`."""

    tests: list[Path] | None = argument(
        "[TEST]...",
        "File with command and measured displacement: text, MATLAB, HDF5, TDMS or NetCDF; or sample_test, "
        "which comes with reliab. Several files give a table.",
        default=None,
        autocompletion=samples,
    )

    belongs_to: ClassVar[Mapping[str, str]] = {
        "figure": "design",
        **dict.fromkeys(options.OF_REPORT, "report"),
    }


@takes(AssessDemand)
def assess(demand: AssessDemand) -> None:
    """Judge a real test by its error, computed from command and measured displacement."""
    if demand.design:
        _answer_design(demand)
    elif not _answer_tests(demand) and demand.check:
        raise typer.Exit(1)


def _answer_design(demand: AssessDemand) -> None:
    from reliab.app.api.assessment_files import draw_chart
    from reliab.app.api.design import design_test
    from reliab.app.cli.assess.shown_design import show_design
    from reliab.app.cli.output import write_json

    if "tests" in demand.given:
        raise InputError("A test's file has no effect together with `design`", remedy="Leave it out")
    if "structure" in demand.given:
        raise InputError(
            "Tolerable errors before a test are computed for single-degree-of-freedom structures, not for "
            "frames",
            value=f"`structure={demand.structure}`",
            remedy="Judge a trial test of the frame with `reliab assess TEST --structure FRAME`, or predict "
            "the next one from earlier tests of it with `reliab rig predict RIG --structure FRAME`",
        )
    design = demand.ask(design_test, "design", "figure", "json_target", why="together with `design`")
    if demand.figure is not None:
        draw_chart(design, demand.figure)
    if not write_json(design.to_dict(), demand.json_target):
        show_design(design)


def _answer_tests(demand: AssessDemand) -> bool:
    """Judge tests; write and print what is found; return whether all are reliable."""
    from reliab.app.api.arguments import unused
    from reliab.app.api.assessment import assess as api_assess
    from reliab.app.api.assessment_files import file_report
    from reliab.app.cli.output import progress_bar

    files = options.files_of(demand.tests, demand.out)
    several = len(files) != 1 or demand.test_name == "all"
    if demand.report is not None and several and files:
        raise unused("report", "together with several tests, since a report is of one test")
    if demand.corrected is not None and several and files:
        raise unused("corrected", "together with several tests, since the response is that of one test")
    if demand.same_test and not several:
        raise InputError("`same_test` needs two tests or more", remedy="Name every run of the test")
    with progress_bar("tests") if several else nullcontext(silent) as progress:
        verdicts: Any = demand.ask(
            api_assess,
            *("tests", "out", "corrected", "details", "check", "json_target", "report", "same_test"),
            *(options.OF_REPORT if demand.report is not None else ()),
            test=files[0] if len(files) == 1 else files,
            f=options.only_value(demand.f, "f"),
            confidence=options.only_value(demand.confidence, "confidence"),
            progress=progress,
        )
    if demand.same_test:
        return _write_same_test(verdicts, demand)
    if several:
        _write_several(verdicts, demand)
        return bool(verdicts.reliable)
    _write_one(verdicts, files[0], demand)
    if demand.report is not None:
        file_report(
            verdicts, demand.report, test=files[0], structure=demand.structure, setting=demand.setting
        )
    return bool(verdicts.reliable)


def _write_one(
    assessment: "Assessment | FrameAssessment | CoupledAssessment", test: Path, demand: AssessDemand
) -> None:
    from reliab.app.api.assessment_files import write_corrected, write_tests
    from reliab.app.cli.output import say, write_json

    content = assessment.to_dict()
    if demand.out is not None:
        write_tests([{"file": str(test), **content}], demand.out)
    note = None if demand.corrected is None else write_corrected(assessment, demand.corrected)
    if write_json(content, demand.json_target):
        return
    _show_one(assessment, content, details=demand.details)
    if note is not None:
        say(f"{demand.corrected}: {note}")


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


def _write_several(assessments: "Assessments", demand: AssessDemand) -> None:
    from reliab.app.api.assessment_files import write_tests
    from reliab.app.cli.assess.shown_test import show_several
    from reliab.app.cli.output import write_json

    contents = [
        {"file": file, **({"fault": demand.in_options(content["fault"])} if "fault" in content else content)}
        for file, content in assessments.to_dict().items()
    ]
    if demand.out is not None:
        write_tests(contents, demand.out)
    if not write_json(contents, demand.json_target):
        show_several(contents)
    if assessments.faults:
        raise InputError(
            "Every file must be a test that can be judged",
            value=f"{len(assessments.faults)} of {len(contents)} not judged: {', '.join(assessments.faults)}",
            remedy="Correct them as the reasons say, or leave them out; the other tests were judged",
        )


def _write_same_test(assessments: "Assessments", demand: AssessDemand) -> bool:
    from reliab.app.api.assessment_files import write_tests
    from reliab.app.cli.assess.shown_test import show_same_test
    from reliab.app.cli.output import write_json

    together = assessments.same_test()
    if demand.out is not None:
        write_tests([{"file": file, **found} for file, found in assessments.to_dict().items()], demand.out)
    if not write_json(together.to_dict(), demand.json_target):
        show_same_test(together.to_dict())
    return together.reliable
