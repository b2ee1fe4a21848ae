"""`reliab.judge_paper_cases`, `reliab.validate_rebuilt_error`: verdicts beside errors that were simulated."""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from reliab.app.api.sources import FIVE_PERCENT, ONE_HERTZ, TWO_PERCENT, Files, listed, paths
from reliab.assessment.default_criterion import default_criterion
from reliab.core.errors import InputError
from reliab.core.progress import Show, quietly
from reliab.core.rows import ResultWithRows
from reliab.core.shipped import shipped
from reliab.core.vocabulary import Metric
from reliab.criterion.published import published_criterion
from reliab.motions.loading import load_motions
from reliab.motions.motion import Motion
from reliab.structures.structure import Structure
from reliab.study.folders import study_module
from reliab.sweep.ellipse_file import open_ellipses
from reliab.sweep.several import Names, Numbers, several
from reliab.validation.earthquakes import earthquakes_among
from reliab.validation.rebuilt_error_study.design import Design
from reliab.validation.rebuilt_error_study.study import summarised, try_tests


@dataclass(frozen=True, kw_only=True, eq=False)
class PaperCases(ResultWithRows):
    """Verdicts on the paper's four cases.

    `motion`, `window`, `integrator`, `compensator`: name of the ground motion, length of its part [s], and
    how command and delay were treated.
    """

    rows_in = "cases"

    motion: str
    held_out: str | None
    window: str
    integrator: str
    compensator: str
    verdicts: pd.DataFrame

    def to_dict(self) -> dict[str, Any]:
        """Plain values with stable keys; the `cases` are rows."""
        cases = self.verdicts.astype(object).where(self.verdicts.notna(), None)
        return {
            "motion": self.motion,
            "held_out": self.held_out,
            "window": self.window,
            "integrator": self.integrator,
            "compensator": self.compensator,
            "cases": cases.to_dict(orient="records"),
        }


def judge_paper_cases(
    case: str,
    *,
    motions: Files | None = None,
    sets: Names | None = None,
    integrator: str = "chen_ricles",
    compensator: str = "inverse",
) -> PaperCases:
    """Run the paper's four cases under a ground motion, and judge them by printed and recommended criteria.

    Parameters
    ----------
    case : str
        Name of the motion; it may be one that is held out.
    motions : str, pathlib.Path or sequence of these
        Records, folders or a built-in suite that hold it.
    sets : str or sequence of str, optional
        Sets of their catalogue.
    integrator : {"chen_ricles", "central_difference", "operator_splitting", "exact"}, optional
        How the command is computed; the paper's by default.
    compensator : {"inverse", "feedforward", "polynomial_extrapolation", "none"}, optional
        How the actuator's delay is compensated; the paper's by default.

    Returns
    -------
    PaperCases
        Errors and verdicts.

    Raises
    ------
    InputError
        If there is no such motion, integrator or compensator.
    """
    record_seconds = study_module("paper2017", "cases").RECORD_SECONDS
    motion = _motion(motions, listed(sets), case)
    event, verdicts = _verdicts(motion, integrator, compensator)
    return PaperCases(
        motion=motion.name,
        held_out=event,
        window=f"{min(record_seconds, motion.duration):g}",
        integrator=integrator,
        compensator=compensator,
        verdicts=verdicts,
    )


def _verdicts(motion: Motion, integrator: str, compensator: str) -> tuple[str | None, pd.DataFrame]:
    """Judge the cases by the printed and the recommended criterion; name the held-out earthquake."""
    printed = published_criterion("guo_2017_18")
    learned = open_ellipses(shipped("datasets", "real_suite/ellipses.nc"))
    (event,) = earthquakes_among([motion.event], [motion.checksum], learned)
    verdicts = study_module("paper2017", "cases").case_verdicts(
        motion,
        {
            "guo_2017_18": lambda f, xi: printed,  # noqa: ARG005 - one law for all structures
            "recommended": lambda f, xi: default_criterion(f, xi, without=event),
        },
        integrator=integrator,
        compensator=compensator,
    )
    return event, verdicts


def _motion(motions: Files | None, sets: list[str] | None, name: str) -> Motion:
    """Find a motion of a suite by its name, also among those that are held out."""
    if not motions:
        raise InputError(
            "The paper's cases need a ground motion",
            value="no `motions`",
            remedy=f"Give the folder or file of {name} with `motions`",
        )
    suite = load_motions(*paths(motions), sets=sets)
    if name not in suite.names and sets is None:
        with suppress(InputError):  # where nothing is held out, the suite's own message is the better one
            suite = load_motions(*paths(motions), sets=["held_out"])
    return suite.select(names=[name])[0]


_NINETY_FIVE = 0.95


@dataclass(frozen=True, kw_only=True, eq=False)
class RebuiltErrorValidation:
    """How often the rebuilt error, criteria and boundaries are right about simulated tests."""

    design: Design
    tables: Mapping[str, pd.DataFrame]

    def to_dict(self) -> dict[str, Any]:
        """Plain values with stable keys; each table as rows."""
        return {
            "threshold": self.design.threshold,
            "metric": str(self.design.metric),
            "confidence": self.design.confidence,
            "structures": [
                {
                    "f": structure.frequency,
                    "xi": structure.damping_ratio,
                    "alpha": structure.experimental_fraction,
                }
                for structure in self.design.structures
            ],
            "n_motions": len(self.design.motions),
            "trials": self.design.trials,
            **{
                name: table.astype(object).where(table.notna(), None).to_dict(orient="records")
                for name, table in self.tables.items()
            },
        }


def validate_rebuilt_error(
    *,
    motions: Files = "synthetic",
    sets: Names | None = None,
    f: Numbers = ONE_HERTZ,
    xi: Numbers = TWO_PERCENT,
    alpha: Numbers = 1.0,
    threshold: float = FIVE_PERCENT,
    metric: str = "rms",
    confidence: Numbers = _NINETY_FIVE,
    trials: int = 6,
    tests: str | Path | None = None,
    show: Show = quietly,
) -> RebuiltErrorValidation:
    """Judge simulated tests by their rebuilt error, by criteria, and by the boundary of the test's motion.

    Parameters
    ----------
    motions : str, pathlib.Path or sequence of these, optional
        Ground motions; the synthetic suite by default.
    sets : str or sequence of str, optional
        Sets of their catalogue.
    f, xi, alpha : float or sequence of float, optional
        Structures: natural frequencies [Hz], damping ratios [-] and shares of the stiffness in the
        laboratory [-].
    threshold : float, optional
        Error up to which a test is good [-].
    metric : {"rms", "mte"}, optional
        Error of the whole test.
    confidence : float, optional
        Share of the population's ground motions that the criterion states.
    trials : int, optional
        Tests of each kind of actuator and specimen, for each structure.
    tests : str or pathlib.Path, optional
        CSV file of all tests and verdicts, from which an interrupted run resumes.
    show : callable, optional
        Takes the name of a task and shows its progress.

    Returns
    -------
    RebuiltErrorValidation
        How often each judge is right.

    Raises
    ------
    InputError
        If a value is not allowed.
    """
    error, shares = Metric.parse(metric), several(confidence)
    if len(shares) > 1:
        raise InputError(
            "The criterion that is compared with the rebuilt error must have one `confidence`",
            value=", ".join(f"{share:g}" for share in shares),
            remedy="Give one",
        )
    suite = list(load_motions(*paths(motions), sets=listed(sets)))
    design = Design.for_motions(
        suite[:: max(1, len(suite) // trials)][:trials],
        [
            Structure(frequency=frequency, damping_ratio=ratio, experimental_fraction=share)
            for frequency in several(f)
            for ratio in several(xi)
            for share in several(alpha)
        ],
        trials=trials,
        threshold=threshold,
        metric=error,
        confidence=shares[0],
    )
    with show("Simulating tests") as progress:
        tried = try_tests(design, kept=None if tests is None else Path(tests), progress=progress)
    return RebuiltErrorValidation(design=design, tables=summarised(tried))
