"""What `reliab assess --structure` says about a test of a frame: plain numbers with stable keys."""

from typing import Any

import numpy as np

from reliab.validation.assessment.error_of_test import ErrorOfTest
from reliab.validation.assessment.findings import FaultEffect, capped
from reliab.validation.assessment.frame_test import FrameAssessment
from reliab.validation.assessment.verdict import Word, verdict_by_index
from reliab.vocabulary import Metric

_MILLISECONDS = 1e3


def summarise_frame(assessment: FrameAssessment) -> dict[str, Any]:
    """Put an assessment of a frame into plain numbers.

    Parameters
    ----------
    assessment : FrameAssessment
        The assessment.

    Returns
    -------
    dict
        With the keys of other assessments where they have the same meaning, and `structure`, `error_of`,
        `modes` of the frame; None where a value is infinite or unknown.
    """
    tracking, error, plain = assessment.tracking, assessment.error, assessment.tracking.plain
    partition = assessment.frame.partition
    modes = zip(
        partition.frame.modes.frequency,
        partition.frame.damping_ratios,
        partition.stiffness_shares,
        strict=True,
    )
    return {
        "test": assessment.recording.name,
        "structure": assessment.frame.name,
        "error_of": "the measured interface displacement",
        "A": tracking.amplitude,
        "phi": -2.0 * np.pi * plain.equivalent_frequency * tracking.delay,
        "f_eq_hz": plain.equivalent_frequency,
        "d_ms": _MILLISECONDS * tracking.delay,
        "critical_delay_ms": _finite(_MILLISECONDS * assessment.critical_delay),
        "stability_margin": assessment.stability_margin,
        "modes": [{"f_hz": float(f), "xi": float(xi), "alpha": float(alpha)} for f, xi, alpha in modes],
        "error": {
            **{
                str(name): {key: _finite(getattr(error.of(name), key)) for key in ("value", "low", "high")}
                for name in Metric
            },
            "probability": error.probability,
            "would_decide": list(error.would_decide),
        },
        "metric": str(error.metric),
        "threshold": error.threshold,
        "probability": error.probability,
        "verdict": str(assessment.verdict.word),
        "reliable": assessment.reliable,
        "reasons": list(assessment.verdict.reasons),
        "would_decide": list(assessment.verdict.would_decide),
        "faults": [_fault(effect, error) for effect in assessment.faults],
        "warnings": list(assessment.warnings),
        "by_index": None if assessment.criterion is None else _by_index(assessment),
    }


def _fault(effect: FaultEffect, error: ErrorOfTest) -> dict[str, Any]:
    otherwise = effect.otherwise
    return {
        "kind": effect.fault.kind,
        "finding": effect.fault.finding,
        "in_loop": effect.fault.in_loop,
        "error": _finite(error.of(error.metric).value),
        "error_otherwise": None if otherwise is None else _finite(otherwise.of(error.metric).value),
    }


def _by_index(assessment: FrameAssessment) -> dict[str, Any] | None:
    """Compare the test with the criterion that is given."""
    placed, criterion = assessment.population, assessment.criterion
    if placed is None or criterion is None:
        return None
    verdict = verdict_by_index(
        index=placed.index,
        interval=placed.index_interval,
        probability=capped(placed.probability),
        confidence=criterion.confidence,
        own_motion=False,
    )
    return {
        "verdict": str(verdict.word),
        "reliable": verdict.word is Word.RELIABLE,
        "reasons": list(verdict.reasons),
        "index": _finite(placed.index),
        "probability": capped(placed.probability),
        "a": placed.a,
        "b": placed.b,
        "confidence": criterion.confidence,
    }


def _finite(value: float | None) -> float | None:
    return float(value) if value is not None and np.isfinite(value) else None
