"""`reliab assess TEST --structure FRAME.toml`: the verdict on a test of a partitioned frame."""

from pathlib import Path
from typing import TYPE_CHECKING

from reliab.cli.assess.demand import Demand
from reliab.cli.options import FIVE_PERCENT
from reliab.cli.output import console, table, write_json
from reliab.errors import InputError
from reliab.stated_value import StatedValue

if TYPE_CHECKING:
    from reliab.validation.assessment.frame_test import FrameAssessment

_SAID_BY_THE_FILE = (
    *("f", "xi", "alpha", "scale", "mass", "motion", "window", "criterion", "model", "confidence"),
    *("report", "date"),
)


def judge_frame_test(demand: Demand, structure: Path) -> bool:
    """Judge a test of a frame; write and print what is found.

    Parameters
    ----------
    demand : Demand
        What is asked.
    structure : pathlib.Path
        Description of the frame.

    Returns
    -------
    bool
        Whether the test is reliable.

    Raises
    ------
    InputError
        If an option has no meaning beside a frame.
    """
    for name in _SAID_BY_THE_FILE:
        if getattr(demand, name):
            raise InputError(
                f"--{name} has no meaning beside --structure",
                remedy="Leave it out; the description of the frame says what the test is of",
            )
    from reliab.loop.partition.frame_file import read_frame
    from reliab.validation.assessment.frame_test import assess_frame
    from reliab.vocabulary import Metric

    lag = (demand.feedback_lag or StatedValue(0.0)).value
    frame = read_frame(structure)
    assessment = assess_frame(
        demand.read_recording(),
        frame,
        threshold=FIVE_PERCENT if demand.threshold is None else demand.threshold,
        metric=Metric.parse(demand.metric or "rms"),
        feedback_lag=1e-3 * lag,
    )
    content = assessment.to_dict()
    if not write_json(content, demand.json_target):
        _show(assessment)
    return bool(content["reliable"])


def _show(assessment: "FrameAssessment") -> None:
    judged = assessment.error.estimate(assessment.metric)
    rows = {
        "verdict": assessment.word.shout,
        f"error, {assessment.metric}": f"{100 * judged.value:.2f} %",
        "90 % interval": f"{100 * judged.low:.2f} to {100 * judged.high:.2f} %",
        f"probability below {100 * assessment.threshold:g} %": f"{assessment.probability:.3f}",
        "A": f"{assessment.tracking.amplitude:.4f}",
        "d": f"{1e3 * assessment.tracking.equivalent_delay:.3f} ms",
        "critical delay": f"{1e3 * assessment.critical_delay:.3f} ms",
        "stability margin": f"{assessment.stability_margin:.3f}",
    }
    shown = table(f"Test of {assessment.frame.name}", {"": "left", "value": "left"})
    for name, value in rows.items():
        shown.add_row(name, value)
    console().print(shown)
