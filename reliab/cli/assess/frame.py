"""`reliab assess TEST --structure FRAME.toml`: the verdict on a test of a partitioned frame."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from reliab.cli.assess.demand import Demand
from reliab.cli.assess.filed_report import checksums, file_report
from reliab.cli.assess.judgement import Judge, Judgement
from reliab.cli.options import FIVE_PERCENT
from reliab.cli.output import console, table
from reliab.errors import InputError
from reliab.shipped import or_shipped

if TYPE_CHECKING:
    from reliab.validation.assessment.frame_assessment import FrameAssessment

_SAID_BY_THE_FILE = ("f", "xi", "alpha", "mass")
_NOT_FOR_FRAMES = {
    "motion": "The index of a frame's test is that of a criterion of the frame: give it with --criterion",
    "model": "The error of a frame's test is rebuilt for a linear specimen",
    "confidence": "The verdict rests on the test's own error; a criterion brings its confidence with it",
}


def judge_of_frames(demand: Demand, structure: Path) -> Judge:
    """Read what the tests of a frame share, and return what judges one of them.

    Parameters
    ----------
    demand : Demand
        What is asked.
    structure : pathlib.Path
        Description of the frame.

    Returns
    -------
    callable
        Takes the file of a test and returns its `Judgement`.

    Raises
    ------
    InputError
        If an option has no meaning beside a frame, or a shared file cannot be read.
    """
    _refuse_unused(demand)
    from reliab.loop.partition.frame_file import read_frame
    from reliab.validation.assessment.frame_summary import summarise_frame
    from reliab.validation.assessment.frame_test import assess_frame
    from reliab.vocabulary import Metric

    frame, criterion = read_frame(structure), demand.own_criterion

    def judge(test: Path) -> Judgement:
        assessment = assess_frame(
            demand.read_recording(test),
            frame,
            criterion=criterion,
            threshold=FIVE_PERCENT if demand.threshold is None else demand.threshold,
            metric=Metric.parse(demand.metric or "rms"),
            feedback_lag=demand.feedback_lag,
            scale=demand.scale,
        )
        content = summarise_frame(assessment)
        return Judgement(
            content=content,
            show=lambda: _show(content),
            write_report=lambda: _write_report(assessment, demand, test, structure),
        )

    return judge


def _write_report(assessment: "FrameAssessment", demand: Demand, test: Path, structure: Path) -> None:
    """Write the report, if it is asked for."""
    if demand.report is not None:
        from reliab.report.kinds.assessment import frame_assessment_report

        files = checksums({"file": or_shipped(test, "datasets", "test.csv"), "structure": structure})
        file_report(frame_assessment_report(assessment, provenance=files), demand.report, demand.setting)


def _refuse_unused(demand: Demand) -> None:
    """Refuse options that would not be used, and say why."""
    for name in _SAID_BY_THE_FILE:
        if getattr(demand, name):
            raise InputError(
                f"--{name} has no meaning beside --structure",
                remedy="Leave it out; the description of the frame says what the test is of",
            )
    for name, reason in _NOT_FOR_FRAMES.items():
        if getattr(demand, name):
            raise InputError(f"--{name} has no meaning beside --structure. {reason}", remedy="Leave it out")


def _show(content: dict[str, Any]) -> None:
    terminal = console()
    terminal.print(_quantities(content))
    terminal.print(_modes(content))
    for sentence in _sentences(content):
        terminal.print(sentence, markup=False, highlight=False)
    for warning in content["warnings"]:
        terminal.print(f"Warning: {warning}", style="yellow", markup=False, highlight=False)
    for note in content["notes"]:
        terminal.print(f"Note: {note}", markup=False, highlight=False)


def _quantities(content: dict[str, Any]) -> Any:  # noqa: ANN401 - Rich's table
    metric, threshold = content["metric"], content["threshold"]
    judged, margin = content["error"][metric], content["stability_margin"]
    critical = content["critical_delay_ms"]
    rows = {
        "verdict": content["verdict"].replace("_", " ").upper(),
        f"error, {metric}": f"{100 * judged['value']:.2f} %",
        "90 % interval": f"{100 * judged['low']:.2f} to {100 * judged['high']:.2f} %",
        f"probability below {100 * threshold:g} %": f"{content['probability']:.3f}",
        "A": f"{content['A']:.4f}",
        "d": f"{content['d_ms']:.3f} ms",
        "critical delay": "none" if critical is None else f"{critical:.3f} ms",
        "stability margin": "none" if margin is None else f"{margin:.3f}",
    }
    if content["by_index"] is not None:
        by_index = content["by_index"]
        index = "unknown" if by_index["index"] is None else f"{by_index['index']:.3g}"
        rows["index of the criterion"] = f"{index}: {by_index['verdict'].replace('_', ' ')}"
    shown = table(f"Test of {content['structure']}", {"": "left", "value": "left"})
    for name, value in rows.items():
        shown.add_row(name, value)
    return shown


def _modes(content: dict[str, Any]) -> Any:  # noqa: ANN401 - Rich's table
    headings = ("mode", "f, Hz", "damping ratio", "specimen's share", "A(f)", "d(f), ms")
    shown = table("Tracking at the modes of the structure", dict.fromkeys(headings, "right"))
    for place, mode in enumerate(content["modes"], start=1):
        shown.add_row(
            str(place),
            f"{mode['f_hz']:.3f}",
            f"{mode['xi']:.4f}",
            f"{mode['alpha']:.3f}",
            "unknown" if mode["A"] is None else f"{mode['A']:.4f}",
            "unknown" if mode["d_ms"] is None else f"{mode['d_ms']:.3f}",
        )
    return shown


def _sentences(content: dict[str, Any]) -> Iterator[str]:
    from reliab.validation.assessment.error_of_test import PART_NAMES

    yield from content["reasons"]
    yield from (f"What would decide: {remedy}" for remedy in content["would_decide"])
    resolved = content["over_frequency"]
    if resolved is not None:
        low, high = resolved["frequency_hz"][0], resolved["frequency_hz"][-1]
        yield (
            f"A and d over frequency are known from {low:.3g} to {high:.3g} Hz and account for an RMS^R of "
            f"{resolved['error']['rms']:.2%}; without them "
            f"{resolved['error']['remaining_rms']:.2%} would remain."
        )
    first = content["error"]["improve_first"]
    remaining = content["error"]["parts"][first]["remaining_rms"]
    yield f"Improve first: {PART_NAMES[first]}; without its part RMS^R would be {remaining:.2%}."
