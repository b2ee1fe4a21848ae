"""`reliab.judge_paper_cases`: the paper's four cases, Tables 5 and 6, under a ground motion of one's own."""

from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import pandas as pd

from reliab.api.sources import Files, listed, paths
from reliab.assessment import default_criterion
from reliab.criterion import published_criterion
from reliab.errors import InputError
from reliab.motions import Motion, load_motions
from reliab.rows import ResultWithRows
from reliab.shipped import shipped
from reliab.study import study_module
from reliab.sweep import Names, open_ellipses
from reliab.validation import earthquakes_among


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
