"""`reliab assess TEST --structure FRAME.toml`: the verdict on a test of a partitioned frame."""

from pathlib import Path
from typing import Any

from reliab.cli.assess.demand import Demand
from reliab.cli.assess.judgement import Judge, Judgement
from reliab.cli.options import FIVE_PERCENT
from reliab.cli.output import console, table
from reliab.errors import InputError

_SAID_BY_THE_FILE = ("f", "xi", "alpha", "mass")
_NOT_FOR_FRAMES = {
    "motion": "The index of a frame's test is that of a criterion of the frame: give it with --criterion",
    "model": "The error of a frame's test is rebuilt for a linear specimen",
    "confidence": "The verdict rests on the test's own error; a criterion brings its confidence with it",
    "report": "No report is written on the test of a frame; --json FILE keeps the answer",
    "date": "No report is written on the test of a frame",
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
        return Judgement(content=content, show=lambda: _show(content))

    return judge


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
    terminal = console()
    terminal.print(shown)
    for reason in content["reasons"]:
        terminal.print(reason, markup=False, highlight=False)
    for remedy in content["would_decide"]:
        terminal.print(f"What would decide: {remedy}", markup=False, highlight=False)
    for warning in content["warnings"]:
        terminal.print(f"Warning: {warning}", style="yellow", markup=False, highlight=False)
