"""`reliab.judge_paper_cases`, `reliab.validate_rebuilt_error`: verdicts beside errors that were simulated."""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Unpack

import pandas as pd

from reliab.app import questions
from reliab.app.api.sources import FIVE_PERCENT, ONE_HERTZ, TWO_PERCENT, listed, paths
from reliab.app.declaration import Files, asks
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


@asks(questions.PaperCases)
def judge_paper_cases(case: str, **asked: Unpack[questions.PaperCases]) -> PaperCases:
    """Run the paper's four cases under a ground motion, and judge them by printed and recommended criteria.

    Parameters
    ----------
    case : str
        Name of the motion; it may be one that is held out.

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
    integrator, compensator = asked["integrator"], asked["compensator"]
    motion = _motion(asked["motions"], listed(asked["sets"]), case)
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


_NINETY_FIVE, _TRIALS = 0.95, 6


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


@asks(questions.RebuiltErrors)
def validate_rebuilt_error(
    *, show: Show = quietly, **asked: Unpack[questions.RebuiltErrors]
) -> RebuiltErrorValidation:
    """Judge simulated tests by their rebuilt error, by criteria, and by the boundary of the test's motion.

    Parameters
    ----------
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
    error, shares = Metric.parse(asked["metric"] or Metric.RMS), listed(asked["confidence"]) or [_NINETY_FIVE]
    if len(shares) > 1:
        raise InputError(
            "The criterion that is compared with the rebuilt error must have one `confidence`",
            value=", ".join(f"{share:g}" for share in shares),
            remedy="Give one",
        )
    suite = list(load_motions(*paths(asked["motions"] or "synthetic"), sets=listed(asked["sets"])))
    trials, tests = asked["trials"] or _TRIALS, asked["tests"]
    design = Design.for_motions(
        suite[:: max(1, len(suite) // trials)][:trials],
        [
            Structure(frequency=frequency, damping_ratio=ratio, experimental_fraction=share)
            for frequency in listed(asked["f"]) or [ONE_HERTZ]
            for ratio in listed(asked["xi"]) or [TWO_PERCENT]
            for share in listed(asked["alpha"]) or [1.0]
        ],
        trials=trials,
        threshold=FIVE_PERCENT if asked["threshold"] is None else asked["threshold"],
        metric=error,
        confidence=shares[0],
    )
    with show("Simulating tests") as progress:
        tried = try_tests(design, kept=None if tests is None else Path(tests), progress=progress)
    return RebuiltErrorValidation(design=design, tables=summarised(tried))
