"""What a rig's tests answer: the next test predicted, and a report."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, Unpack

import numpy as np

from reliab.app import questions
from reliab.app.api.arguments import (
    STRUCTURE,
    parse_threshold,
    refuse_stated,
    refuse_unused,
    stated_quantities,
    structure_of,
)
from reliab.app.api.rigs import parse_covariates
from reliab.app.declaration import asks
from reliab.assessment.default_criterion import ellipses_of_motions
from reliab.assessment.judged_test import plot_errors
from reliab.assessment.rebuilt_error.spread import Estimate
from reliab.core.errors import InputError
from reliab.core.plain_values import PlainResult
from reliab.core.vocabulary import Metric
from reliab.motions.loading import load_motions, read_motion
from reliab.rig.memory import MEASURED_COVARIATES, NextTest
from reliab.rig.prediction import Prediction, predict_next, predict_under_motion, predict_under_suite
from reliab.rig.rig_folder import RigFolder
from reliab.rig.rig_table import RigTable, require_date
from reliab.simulation.excitation import Excitation
from reliab.simulation.frames.frame_file import read_structure
from reliab.tracking.boundary.first_order import first_order_ellipse

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from reliab.report.document import Document
    from reliab.report.setting import ReportSetting
    from reliab.structures.structure import Structure

_USUAL = {"f": 1.0, "xi": 0.02}
_SHIPPED_SUITE = "real_suite"


@dataclass(frozen=True, kw_only=True, eq=False)
class RigPrediction(PlainResult):
    """The next test of a rig, predicted."""

    keys: ClassVar[Mapping[str, str]] = {
        "rig": "rig",
        **{key: f"prediction.{name}" for key, name in Prediction.keys.items()},
    }

    rig: Path
    prediction: Prediction

    def plot(self, axes: "Axes | None" = None) -> "Axes":
        """Draw the predicted error with its 90 % interval [%], and the threshold."""
        error = self.prediction.intervals["rms"]
        size = Estimate(value=error["median"], low=error["low"], high=error["high"])
        return plot_errors({"next test": size}, Metric.RMS, self.prediction.threshold, axes)


@asks(questions.PredictionQuestion, questions.RigArgument)
def predict_rig(rig: str | Path, **request: Unpack[questions.PredictionQuestion]) -> RigPrediction:
    """Predict the next test of a rig from all that it has done.

    Without a ground motion the error follows from those of the rig's own tests; with one the loop is
    simulated with actuators drawn from the posterior. Of a frame the rig must have tests of the same frame.

    Returns
    -------
    RigPrediction
        90 % intervals of A, d, remainder and error, the probability that the error stays below the threshold,
        and which of amplitude, delay and remainder drives it.

    Raises
    ------
    InputError
        If there are fewer than three tests, or an argument cannot be used.
    """
    table, date = RigFolder.open(rig).table(), request["date"]
    following = NextTest(
        date=require_date(date) if date else "",
        specimen=request["specimen"] or "",
        covariates=parse_covariates(request["covariate"] or (), MEASURED_COVARIATES),
    )
    limit = parse_threshold(request["threshold"])
    if request["structure"] is None:
        prediction = _predict_for_structure(table, following, limit, request)
    else:
        reason = "together with the `structure` of a frame"
        refuse_stated({**request}, *STRUCTURE, "motion", "suite", reason=reason)
        frame = read_structure(request["structure"])
        prediction = predict_next(table, None, following, threshold=limit, frame=frame.name)
    return RigPrediction(rig=Path(rig), prediction=prediction)


def _predict_for_structure(
    table: RigTable, following: NextTest, limit: float, request: questions.PredictionQuestion
) -> Prediction:
    values = stated_quantities({**request})
    if "f" not in values:
        raise InputError(
            "The natural frequency of the structure is missing",
            remedy="Give it in hertz, `f=1`, or a frame as `structure`",
        )
    structure, motion, suite = structure_of(values, xi=_USUAL["xi"]), request["motion"], request["suite"]
    if motion is not None:
        if suite is not None:
            raise refuse_unused("suite", "together with `motion`")
        record = read_motion(motion)
        excitation = Excitation(acceleration=record.acceleration, time_step=record.time_step)
        return predict_under_motion(table, structure, following, excitation, threshold=limit)
    if suite is None:
        return predict_next(table, structure, following, threshold=limit)
    if suite == _SHIPPED_SUITE:
        pairs = ellipses_of_motions(structure)
    else:
        ellipses = [
            first_order_ellipse(
                Excitation(acceleration=record.acceleration, time_step=record.time_step), structure
            )
            for record in load_motions(suite)
        ]
        pairs = (
            np.array([ellipse.amplitude for ellipse in ellipses]),
            np.array([ellipse.delay for ellipse in ellipses]),
        )
    return predict_under_suite(table, structure, following, pairs, threshold=limit, suite=suite)


@asks(questions.RigReportQuestion, questions.RigPdfArguments)
def report_rig(
    rig: str | Path,
    out: str | Path,
    *,
    setting: "ReportSetting | None" = None,
    **request: Unpack[questions.RigReportQuestion],
) -> Path:
    """Write the report of a rig: two pages for the head of the laboratory, and an appendix.

    What is not stated of the next test is as in the last one.

    Returns
    -------
    pathlib.Path
        The PDF.

    Raises
    ------
    InputError
        If there are fewer than three tests, an argument cannot be used, or the file cannot be written.
    """
    from reliab.report.pdf import write_pdf

    document = document_of_rig(rig, **request)
    write_pdf(document, Path(out), date=datetime.now(tz=UTC).date(), setting=setting)
    return Path(out)


@asks(questions.RigReportQuestion, questions.RigArgument)
def document_of_rig(rig: str | Path, **request: Unpack[questions.RigReportQuestion]) -> "Document":
    """Make the document that :func:`report_rig` sets as a PDF; arguments and errors are the same."""
    from reliab.report.kinds.rig_report import rig_report

    table = RigFolder.open(rig).table()
    if not table.rows:
        raise InputError("The rig has no tests", remedy="Add some with `reliab rig add`")
    last = table.rows[-1]
    limit = parse_threshold(
        float(last["threshold"]) if request["threshold"] is None else request["threshold"]
    )
    structure: Structure | None = None
    if request["f"] is None and last["structure"]:
        prediction = predict_next(table, None, NextTest(), threshold=limit, frame=last["structure"])
    else:
        values = stated_quantities({**request})
        last_values = {name: float(last[name]) for name in STRUCTURE if last[name] is not None}
        structure = structure_of(values, **{**_USUAL, **last_values})
        prediction = predict_next(table, structure, NextTest(), threshold=limit)
    digest = hashlib.sha256("\n".join(table.texts("sha256")).encode()).hexdigest()
    return rig_report(
        Path(rig).resolve().name,
        table,
        prediction,
        structure=structure,
        provenance={"tests": len(table), "checksums of the tests, SHA-256": digest},
    )
