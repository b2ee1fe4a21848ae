"""Errors and their parts as plain numbers, the same in every summary of a test."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from reliab.assessment.rebuilt_error.parts import Part
from reliab.assessment.rebuilt_error.spread import Estimate
from reliab.core.vocabulary import Metric

if TYPE_CHECKING:
    from reliab.assessment.measured_specimen.rebuild import MeasuredSpecimen


def finite(value: float | None) -> float | None:
    """Return a number ready for JSON; None where it is unknown or infinite."""
    return float(value) if value is not None and np.isfinite(value) else None


def plain_estimate(error: Estimate) -> dict[str, float | None]:
    """Value and ends of the 90 % interval of an error [-]."""
    return {"value": finite(error.value), "low": finite(error.low), "high": finite(error.high)}


def plain_errors(estimate: Callable[[Metric], Estimate] | None) -> dict[str, dict[str, float | None]]:
    """RMS^R and MTE^R of a test or a displacement by name, as it estimates them; unknown without."""
    return {
        str(name): dict.fromkeys(("value", "low", "high"))
        if estimate is None
        else plain_estimate(estimate(name))
        for name in Metric
    }


def plain_part(part: Part) -> dict[str, float | None]:
    """Size of a part of the error, its share, and what would remain without it [-]."""
    return {
        "rms": finite(part.rms),
        "share": finite(part.share),
        "remaining_rms": finite(part.remaining_rms),
        "remaining_mte": finite(part.remaining_mte),
    }


def plain_specimen(how_known: str, learned: "MeasuredSpecimen | None") -> dict[str, Any]:
    """How the specimen is known; of one that was learned, by what and how well."""
    if learned is None:
        return {"known": how_known}
    return {
        "known": how_known,
        "held_out": learned.held_out,
        "beyond": learned.beyond,
        "families": [vars(family) for family in learned.families],
    }
