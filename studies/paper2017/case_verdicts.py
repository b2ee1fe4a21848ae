"""Verdicts on the paper's four cases: equation (18), our criterion, and the simulated errors."""

from collections.abc import Callable, Mapping

import pandas as pd

from reliab.criterion import Criterion
from reliab.motions import Motion
from reliab.vocabulary import MILLI

from .cases import run_paper_cases

CriterionOf = Callable[[float, float], Criterion]
"""Gives the criterion of a structure: frequency [Hz] and damping ratio [-]."""


def case_verdicts(
    motion: Motion,
    criteria: Mapping[str, CriterionOf],
    *,
    integrator: str = "chen_ricles",
    compensator: str = "inverse",
) -> pd.DataFrame:
    """Simulate the paper's cases under a ground motion and compare criteria with the errors.

    One row for each case and criterion: `case`, `f` [Hz], `xi` [-], `estimated_delay` [steps], `A` [-],
    `d_ms`, `rms` [-], `good` (the error is at most the threshold), `criterion`, `index` [-], `accepted`, and
    `probability` [-] of staying below the threshold, None where it is unknown.
    """
    rows = []
    outcomes = run_paper_cases(motion, integrator=integrator, compensator=compensator)
    for number, outcome in enumerate(outcomes, start=1):
        case = outcome.case
        for name, criterion_of in criteria.items():
            criterion = criterion_of(case.frequency, case.damping_ratio)
            at = (outcome.amplitude, outcome.equivalent_delay, case.frequency, case.damping_ratio)
            index = float(criterion.index(*at))
            rows.append(
                {
                    "case": number,
                    "f": case.frequency,
                    "xi": case.damping_ratio,
                    "estimated_delay": case.estimated_delay,
                    "A": outcome.amplitude,
                    "d_ms": MILLI * outcome.equivalent_delay,
                    "rms": outcome.rms,
                    "good": outcome.rms <= criterion.threshold,
                    "criterion": name,
                    "index": index,
                    "accepted": index <= 1.0,
                    "probability": float(criterion.probability(*at)) if criterion.population else None,
                }
            )
    return pd.DataFrame(rows)
