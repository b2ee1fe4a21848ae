"""`reliab.assess` and `reliab.compare`: verdicts on tests, their order by error, and the files they leave."""

from collections.abc import Iterable, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack, overload

from reliab.app import questions
from reliab.app.api.arguments import (
    LINEAR,
    STRUCTURE_NAMES,
    choose_equipment,
    collect_stated_values,
    parse_filters,
    parse_threshold,
    refuse_stated,
    refuse_unused,
    require_known_specimen,
    require_sound,
    stated_quantities,
    structure_of,
    values_of_structure,
)
from reliab.app.api.channels import FileReading, Judge, Test, assess_each, find_test, is_test, name_of_test
from reliab.app.declaration import asks
from reliab.assessment.assess import AnyAssessment, assess as assess_recording
from reliab.assessment.assessment import Assessment
from reliab.assessment.budget.corrections import correct_recording, delays_of_filters
from reliab.assessment.judged_test import verdict_table
from reliab.core.files import refuse_unwritable, require_ending, written_whole
from reliab.core.plain_values import write_table
from reliab.core.progress import Progress, silent
from reliab.core.shipped import checksum_of
from reliab.core.stated_value import StatedValue
from reliab.core.vocabulary import Metric
from reliab.structures.structure import Structure

if TYPE_CHECKING:
    from reliab.app.api.design import Design
    from reliab.assessment.comparison import Comparison
    from reliab.assessment.frame_assessment import FrameAssessment
    from reliab.assessment.several import Assessments
    from reliab.report.document import Document
    from reliab.report.setting import ReportSetting
    from reliab.simulation.frames.frame_file import FrameUnderTest

_ALL_TESTS = "all"
_USUAL_VALUES = {
    "xi": StatedValue(0.02),
    **dict.fromkeys(("alpha", "scale"), StatedValue(1.0)),
    "feedback_lag": StatedValue(0.0),
}
"""Values that hold where nothing is stated."""
_DAMPING_WARNING = (
    "No damping ratio was stated; 0.02 was assumed, and the interval allows for any from 0.005 to 0.1."
)

_NOT_FOR_FRAMES = {
    "model": "The error of a frame's test is rebuilt for a linear specimen",
    "confidence": (
        "The verdict follows from the test's own error; the confidence belongs to the "
        "criterion, which states its own"
    ),
}


@overload
def assess(  # type: ignore[overload-overlap]  # a text is one file
    test: Test,
    structure: Structure | None = None,
    *,
    progress: Progress = ...,
    **options: Unpack[questions.AssessmentQuestion],
) -> Assessment: ...
@overload
def assess(  # type: ignore[overload-overlap]
    test: Test,
    structure: "FrameUnderTest | str | Path",
    *,
    progress: Progress = ...,
    **options: Unpack[questions.AssessmentQuestion],
) -> "FrameAssessment": ...
@overload
def assess(
    test: Iterable[Test],
    structure: "Structure | FrameUnderTest | str | Path | None" = None,
    *,
    progress: Progress = ...,
    **options: Unpack[questions.AssessmentQuestion],
) -> "Assessments": ...


@asks(questions.AssessmentQuestion)
def assess(
    test: "Test | Iterable[Test]",
    structure: "Structure | FrameUnderTest | str | Path | None" = None,
    *,
    progress: Progress = silent,
    **options: Unpack[questions.AssessmentQuestion],
) -> "AnyAssessment | Assessments":
    """Judge a test, or several, by the error computed from command and measured displacement.

    Parameters
    ----------
    test : str, pathlib.Path, pandas.DataFrame or Recording, or several of them
        The test, its file, a data frame with a history in each column, or the name of one that ships
        ("sample_test").
    structure : Structure, FrameUnderTest, str or pathlib.Path, optional
        The structure under test, in place of `f`, `xi` and `alpha`; or a frame with its part in the
        laboratory, which one actuator drives or several, or the file of one.

    Returns
    -------
    Assessment, FrameAssessment or Assessments
        Error of the test with its interval, verdict, index and what to improve first; of several tests those
        by file, with the reasons why some could not be judged.

    Raises
    ------
    InputError
        If a single test, or a file that several share, cannot be read or judged, the structure is stated
        twice, not at all, or not as that of the model, or an argument would have no effect.

    Notes
    -----
    What is not stated is taken from the model, else from the header of the test's file, else from the file
    of `channels`; skew, scale and hysteresis are taken off the recording. A number without a standard
    deviation is as uncertain as ordinary equipment makes it. Without a damping ratio, the interval allows for
    any from 0.005 to 0.1 that the recording does not exclude.

    A measured specimen is learned from its recorded force alone; f and ξ then describe the computer's part: a
    damping 2ξωm and a stiffness (1 − α)mω², or all of the `structure` of a frame but the specimen. If nothing
    is stated of the specimen and no force was recorded, yielding can keep a test from being reliable.

    Examples
    --------
    >>> verdict = assess("sample_test", f=1, xi=0.02)
    >>> str(verdict.verdict), round(verdict.error.rms.value, 3)
    ('reliable', 0.022)
    """
    judge = _make_judge(structure, {**options})
    reading = FileReading.from_question(options)
    if isinstance(test, str | Path) and reading.test_name == _ALL_TESTS:
        named_tests = ((name, channels, test) for name, channels in reading.split_by_test(test).items())
        return assess_each(named_tests, judge, progress)
    if is_test(test):
        return judge(reading, test)
    tests = ((name_of_test(test, place), reading, test) for place, test in enumerate(test))
    return assess_each(tests, judge, progress)


def _make_judge(
    structure: "Structure | FrameUnderTest | str | Path | None", question: Mapping[str, Any]
) -> Judge:
    """Read what tests share, and return what judges one of them."""
    numbers, model = stated_quantities(question), question["model"]
    filters = parse_filters(question["filter"] or ())
    if structure is not None:
        is_frame = not isinstance(structure, Structure)
        names = (*STRUCTURE_NAMES, "mass", "resolution") if is_frame else STRUCTURE_NAMES
        remedy = "Leave it out; the structure describes the test"
        refuse_stated(question, *names, reason="together with `structure`", remedy=remedy)
    if structure is None or isinstance(structure, Structure):
        frame, shared = None, _read_shared(question)
        shared["confidence"] = 0.95 if question["confidence"] is None else float(question["confidence"])
        values = values_of_structure(structure) | numbers
        values_of_model = values_of_structure(None if model is None else model.test.structure)
    else:
        frame, shared = _read_frame(structure, question)

    def judge(channels: FileReading, test: Test) -> AnyAssessment:
        recording = channels.read(test, several=frame is not None and frame.has_several)
        low_passes = channels.filters(filters, recording.stated)
        delays = delays_of_filters(low_passes)
        if frame is not None:
            stated = {**recording.stated, **numbers}
            require_sound(stated)
            corrected = correct_recording(recording, stated, low_passes)
            return assess_recording(corrected, frame, stated=stated | delays, **shared)
        stated = collect_stated_values(recording, values | delays, values_of_model)
        assumed = () if "xi" in stated else (_DAMPING_WARNING,)
        stated = _USUAL_VALUES | stated
        return assess_recording(
            correct_recording(recording, stated, low_passes),
            structure_of(stated),
            stated=stated,
            model=model,
            assumed=assumed,
            **shared,
        )

    return judge


def _read_frame(
    structure: "FrameUnderTest | str | Path", question: Mapping[str, Any]
) -> "tuple[FrameUnderTest, dict[str, Any]]":
    """Read a frame that is judged, and what it is judged by; refuse what its tests cannot answer."""
    from reliab.assessment.frame_test import require_answerable
    from reliab.simulation.frames.frame_file import read_structure

    for name, reason in _NOT_FOR_FRAMES.items():
        refuse_stated(question, name, reason=f"together with the `structure` of a frame. {reason}")
    shared = _read_shared(question)
    frame = read_structure(structure) if isinstance(structure, str | Path) else structure
    require_answerable(
        frame,
        measured_specimen=shared["measured_specimen"],
        criterion=question["criterion"] is not None,
        specimen=shared["measured_specimen"],
        force_channel=shared["force_channel"] is not None,
    )
    return frame, shared


def _read_shared(question: Mapping[str, Any]) -> dict[str, Any]:
    """Read what one mass and frames are judged by alike."""
    if question["criterion"] is not None:
        reason = "together with `criterion`, which states its own"
        refuse_stated(question, "threshold", "confidence", "metric", reason=reason)
    specimen = question["specimen"]
    is_measured = require_known_specimen(specimen, has_model=question["model"] is not None)
    if question["force_channel"] is not None and not is_measured:
        raise refuse_unused("force_channel", "unless the `specimen` is measured")
    return {
        **{name: question[name] for name in ("criterion", "motion", "force_channel")},
        "equipment": choose_equipment(question["equipment"], exact=question["exact"]),
        "measured_specimen": is_measured,
        "linear_specimen": specimen == LINEAR,
        "threshold": parse_threshold(question["threshold"]),
        "metric": Metric.parse(question["metric"] or Metric.RMS),
    }


def compare(
    tests: Iterable[Test],
    structure: "Structure | FrameUnderTest | str | None" = None,
    **options: Unpack[questions.AssessmentQuestion],
) -> "Comparison":
    """Rank tests of one structure and rig by their errors, such as one motion with each compensator.

    Parameters
    ----------
    tests : iterable of str, pathlib.Path, pandas.DataFrame or Recording
        The tests, at least two.
    structure : Structure, FrameUnderTest or str, optional
        The structure under test, as for :func:`reliab.assess`.
    **stated
        All other arguments of :func:`reliab.assess`; they hold for every test.

    Returns
    -------
    Comparison
        The smallest error first, each with its interval and its difference from the first.

    Raises
    ------
    InputError
        As :func:`reliab.assess`, or if fewer than two tests could be judged.

    Examples
    --------
    >>> import numpy as np
    >>> import pandas as pd
    >>> time, noise = np.arange(0.0, 30.0, 0.005), np.random.default_rng(0).normal(size=6000)
    >>> moved = lambda delay: 0.02 * np.sin(6.0 * (time - delay)) * np.sin(0.1 * time) ** 2
    >>> tests = [
    ...     pd.DataFrame({"time_s": time, "command_m": moved(0.0), "measured_m": moved(delay) + 1e-5 * noise})
    ...     for delay in (0.004, 0.001)
    ... ]
    >>> [test.file for test in compare(tests, f=1, xi=0.05).tests]
    ['data frame 2', 'data frame 1']
    """
    from reliab.assessment.comparison import rank_tests

    assessments = assess(tests, structure, **options)
    return rank_tests(assessments.judged, assessments.faults)


def file_report(
    assessment: "AnyAssessment",
    report: str | Path,
    *,
    test: str | Path,
    structure: str | Path | None = None,
    setting: "ReportSetting | None" = None,
) -> None:
    """Write the report that is filed with a test, with the checksums of the files from which it was made.

    `test`, `structure`: the test's file, and that of the frame where there is one; `setting`: paper, title,
    date (today by default), and name and logo of the laboratory.
    """
    require_ending(report, ".pdf")
    from reliab.report.pdf import write_pdf

    document = document_of_test(assessment, test=test, structure=structure)
    write_pdf(document, Path(report), date=datetime.now(tz=UTC).date(), setting=setting)


def document_of_test(
    assessment: "AnyAssessment",
    *,
    test: str | Path,
    structure: str | Path | None = None,
) -> "Document":
    """Make the document that :func:`file_report` sets as a PDF; arguments are the same."""
    from reliab.report.kinds.assessment.frame import frame_assessment_report
    from reliab.report.kinds.assessment.report import assessment_report

    files = {"file": find_test(test)}
    if structure is not None:
        files["structure"] = Path(structure)
    checksums: dict[str, object] = {}
    for name, path in files.items():
        checksums |= {name: path.name, f"{name}, SHA-256": checksum_of(path)}
    if isinstance(assessment, Assessment):
        return assessment_report(assessment, provenance=checksums)
    return frame_assessment_report(assessment, provenance=checksums)


def write_tests(tests: "Comparison | Iterable[Mapping[str, Any]]", out: str | Path) -> None:
    """Write the table of ranked tests or of verdicts, one row for each test.

    `tests`: what :func:`reliab.compare` answered; or what was found about each test, as `to_dict` of its
    assessment, with its `file`; or `file` and `fault`.
    """
    from reliab.assessment.comparison import Comparison

    rows = tests.to_dataframe() if isinstance(tests, Comparison) else verdict_table(tests)
    require_ending(out, ".csv")
    write_table(rows, out)


def draw_chart(answer: "Design | Comparison", figure: str | Path) -> None:
    """Draw the chart of tolerable errors over the frequency, or of ranked tests.

    `figure`: the file, which ends in .svg, .png or .pdf.
    """
    from reliab.app.api.design import Design
    from reliab.report.figures.measured_test import draw_ranked_tests, tolerable_errors_over_frequency
    from reliab.report.style import picture

    chart = (
        tolerable_errors_over_frequency(answer.chart)
        if isinstance(answer, Design)
        else draw_ranked_tests(answer)
    )
    require_ending(figure, ".svg", ".png", ".pdf")
    with refuse_unwritable("Cannot write the figure", where=figure), written_whole(figure) as file:
        file.write_bytes(picture(chart, Path(figure).suffix.lower()))


def write_corrected(assessment: "AnyAssessment", out: str | Path) -> str:
    """Write the response that a perfect actuator would have produced.

    `out`: the file: CSV, or NetCDF with the attributes of `reliab.assessment.corrected_response`. Returns how
    large the correction is, where it is no longer small, and what is not known.
    """
    require_ending(out, ".csv", ".nc")
    from reliab.assessment.corrected_response import correct_response

    response = correct_response(assessment)
    if Path(out).suffix.lower() == ".csv":
        write_table(response.to_dataframe(), out, index=True)
        return str(response.attrs["note"])
    rule = "Cannot write the file of the corrected response"
    with refuse_unwritable(rule, where=out), written_whole(out) as file:
        file.write_bytes(response.to_netcdf(engine="h5netcdf"))
    return str(response.attrs["note"])
