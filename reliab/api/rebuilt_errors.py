"""`reliab.validate_rebuilt_error`: the rebuilt error beside criteria, on the same simulated tests."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from reliab.api.sources import FIVE_PERCENT, ONE_HERTZ, TWO_PERCENT, Files, listed, paths
from reliab.errors import InputError
from reliab.motions import load_motions
from reliab.progress import Show, quietly
from reliab.structures import Structure
from reliab.sweep import Names, Numbers, several
from reliab.validation.rebuilt_error_study import Design, summarised, try_tests
from reliab.vocabulary import Metric

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
