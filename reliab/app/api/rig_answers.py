"""What a rig's tests answer: the next test predicted, and a report."""

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from reliab.app.api.arguments import Quantity, stated_threshold, stated_values, unused
from reliab.app.api.rigs import stated_covariates
from reliab.assessment.default_criterion import ellipses_of_motions
from reliab.core.errors import InputError
from reliab.core.files import require_ending
from reliab.motions.loading import load_motions, read_motion
from reliab.rig.memory import MEASURED, NextTest
from reliab.rig.prediction import Prediction, predict_next, predict_under_motion, predict_under_suite
from reliab.rig.rig_folder import RigFolder
from reliab.rig.rig_table import RigTable
from reliab.rig.rig_test import require_date
from reliab.simulation.excitation import Excitation
from reliab.simulation.frames.frame_file import read_structure
from reliab.structures.structure import Structure
from reliab.tracking.boundary.first_order import first_order_ellipse

if TYPE_CHECKING:
    from reliab.report.document import Document
    from reliab.report.setting import Setting

_SHIPPED_SUITE = "real_suite"


@dataclass(frozen=True, kw_only=True, eq=False)
class RigPrediction:
    """The next test of a rig, predicted."""

    rig: Path
    prediction: Prediction

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return {"rig": str(self.rig), **self.prediction.to_dict()}


def predict_rig(
    rig: str | Path,
    *,
    f: Quantity | None = None,
    xi: Quantity | None = None,
    alpha: Quantity | None = None,
    structure: str | Path | None = None,
    motion: str | Path | None = None,
    suite: str | None = None,
    threshold: float | None = None,
    date: str | None = None,
    specimen: str | None = None,
    covariate: Iterable[str] | None = None,
) -> RigPrediction:
    """Predict the next test of a rig from all that it has done.

    Parameters
    ----------
    rig : str or pathlib.Path
        The folder, with at least three tests.
    f, xi, alpha : float, str or StatedValue, optional
        Natural frequency [Hz], damping ratio [-], 0.02 by default, and share of the stiffness in the
        laboratory [-], 1 by default.
    structure : str or pathlib.Path, optional
        A frame, in place of these; the rig must have tests of the same frame.
    motion : str or pathlib.Path, optional
        The ground motion; the loop is then simulated with actuators drawn from the posterior. By default the
        motion is unknown, and the error follows from those of the rig's own tests.
    suite : str, optional
        Any motion of a suite instead: "real_suite", which ships as ellipses, "synthetic", or a folder.
    threshold : float, optional
        Error of the whole test, 0.05 by default.
    date, specimen : str, optional
        When it is performed, after the last test by default, and on what, the last specimen by default.
    covariate : iterable of str, optional
        Numbers of the next test that all tests have, "current=0.4"; also its peak displacement, velocity and
        equivalent frequency, "peak_mm=40", "velocity_mm_s=300", "f_eq_hz=1.1".

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
    table = RigFolder.opened(rig).table()
    asked = NextTest(
        date=require_date(date) if date else "",
        specimen=specimen or "",
        covariates=stated_covariates(covariate or (), MEASURED),
    )
    limit = stated_threshold(threshold)
    if structure is not None:
        beside = {"f": f, "xi": xi, "alpha": alpha, "motion": motion, "suite": suite}
        prediction = _of_frame(table, structure, asked, limit, beside)
    else:
        prediction = _of_structure(table, _structure(f, xi, alpha), asked, limit, motion, suite)
    return RigPrediction(rig=Path(rig), prediction=prediction)


def _structure(f: Quantity | None, xi: Quantity | None, alpha: Quantity | None) -> Structure:
    stated = stated_values(f=f, xi=xi, alpha=alpha)
    if "f" not in stated:
        raise InputError(
            "The natural frequency of the structure must be stated",
            value="no `f`",
            remedy="Give it in hertz, `f=1`, or a frame as `structure`",
        )
    return Structure(
        frequency=stated["f"].value,
        damping_ratio=stated["xi"].value if "xi" in stated else 0.02,
        experimental_fraction=stated["alpha"].value if "alpha" in stated else 1.0,
    )


def _of_frame(
    table: RigTable,
    structure: str | Path,
    asked: NextTest,
    threshold: float,
    beside: Mapping[str, object],
) -> Prediction:
    for name, value in beside.items():
        if value is not None:
            raise unused(name, "together with the `structure` of a frame")
    frame = read_structure(structure)
    return predict_next(table, None, asked, threshold=threshold, frame=frame.name)


def _of_structure(
    table: RigTable,
    structure: Structure,
    asked: NextTest,
    threshold: float,
    motion: str | Path | None,
    suite: str | None,
) -> Prediction:
    if motion is not None:
        if suite is not None:
            raise unused("suite", "together with `motion`")
        record = read_motion(motion)
        excitation = Excitation(acceleration=record.acceleration, time_step=record.time_step)
        return predict_under_motion(table, structure, asked, excitation, threshold=threshold)
    if suite is None:
        return predict_next(table, structure, asked, threshold=threshold)
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
    return predict_under_suite(table, structure, asked, pairs, threshold=threshold, suite=suite)


def report_rig(
    rig: str | Path,
    out: str | Path,
    *,
    f: Quantity | None = None,
    xi: Quantity | None = None,
    alpha: Quantity | None = None,
    threshold: float | None = None,
    setting: "Setting | None" = None,
) -> Path:
    """Write the report of a rig: two pages for the head of the laboratory, and an appendix.

    Parameters
    ----------
    rig : str or pathlib.Path
        The folder, with at least three tests.
    out : str or pathlib.Path
        The PDF.
    f, xi, alpha, threshold
        Of the next test, as for :func:`predict_rig`; those of the last test by default.
    setting : Setting, optional
        Paper, title, date (today by default), and name and logo of the laboratory.

    Returns
    -------
    pathlib.Path
        The PDF.

    Raises
    ------
    InputError
        If there are fewer than three tests, an argument cannot be used, or the file cannot be written.
    """
    require_ending(out, ".pdf")
    from reliab.report.pdf import write_pdf

    document = document_of_rig(rig, f=f, xi=xi, alpha=alpha, threshold=threshold)
    write_pdf(document, Path(out), date=datetime.now(tz=UTC).date(), setting=setting)
    return Path(out)


def document_of_rig(
    rig: str | Path,
    *,
    f: Quantity | None = None,
    xi: Quantity | None = None,
    alpha: Quantity | None = None,
    threshold: float | None = None,
) -> "Document":
    """Make the document that :func:`report_rig` sets as a PDF; arguments and errors are the same."""
    from reliab.report.kinds.rig_report import rig_report

    table = RigFolder.opened(rig).table()
    if not table.rows:
        raise InputError("A rig must have tests", value="none", remedy="Add tests with `reliab rig add`")
    last = table.rows[-1]
    limit = stated_threshold(float(last["threshold"]) if threshold is None else threshold)
    structure: Structure | None = None
    if f is None and last["structure"]:
        prediction = predict_next(table, None, NextTest(), threshold=limit, frame=last["structure"])
    else:
        structure = _structure_of_next(last, f, xi, alpha)
        prediction = predict_next(table, structure, NextTest(), threshold=limit)
    digest = hashlib.sha256("\n".join(table.texts("sha256")).encode()).hexdigest()
    return rig_report(
        Path(rig).resolve().name,
        table,
        prediction,
        structure=structure,
        provenance={"tests": len(table), "checksums of the tests, SHA-256": digest},
    )


def _structure_of_next(
    last: Mapping[str, Any], f: Quantity | None, xi: Quantity | None, alpha: Quantity | None
) -> Structure:
    """Return what is stated of the next structure, and the rest as in the last test."""
    stated = stated_values(f=f, xi=xi, alpha=alpha)
    usual = {"f": 1.0, "xi": 0.02, "alpha": 1.0}
    frequency, damping, share = (
        stated[name].value if name in stated else float(value if last[name] is None else last[name])
        for name, value in usual.items()
    )
    return Structure(frequency=frequency, damping_ratio=damping, experimental_fraction=share)
