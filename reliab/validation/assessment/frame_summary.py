"""What `reliab assess --structure` says about a test of a frame: plain numbers with stable keys."""

from typing import Any

import numpy as np

from reliab.rebuilt_error.spread import LEVEL as ERROR_LEVEL
from reliab.validation.assessment.error_of_test import ErrorOfTest
from reliab.validation.assessment.findings import FaultEffect, capped
from reliab.validation.assessment.frame_assessment import FrameAssessment, ModeOfTest
from reliab.validation.assessment.plain_error import finite, plain_estimate, plain_part
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
        `modes` and `over_frequency` of the frame; None where a value is infinite or unknown.
    """
    tracking, error, plain = assessment.tracking, assessment.error, assessment.tracking.plain
    return {
        "test": assessment.recording.name,
        "structure": assessment.frame.name,
        "error_of": "the measured interface displacement",
        "A": tracking.amplitude,
        "phi": -2.0 * np.pi * plain.equivalent_frequency * tracking.delay,
        "f_eq_hz": plain.equivalent_frequency,
        "d_ms": _MILLISECONDS * tracking.delay,
        "critical_delay_ms": finite(_MILLISECONDS * assessment.critical_delay),
        "stability_margin": assessment.stability_margin,
        "modes": [_mode(mode) for mode in assessment.modes],
        "over_frequency": _over_frequency(assessment),
        "error": _error(error),
        "metric": str(error.metric),
        "threshold": error.threshold,
        "probability": error.probability,
        "verdict": str(assessment.verdict.word),
        "reliable": assessment.reliable,
        "reasons": list(assessment.verdict.reasons),
        "would_decide": list(assessment.verdict.would_decide),
        "faults": [_fault(effect, error) for effect in assessment.faults],
        "warnings": list(assessment.warnings),
        "duration_s": assessment.recording.duration,
        "rate_hz": 1.0 / assessment.recording.time_step,
        "notes": list(assessment.recording.notes),
        "by_index": None if assessment.criterion is None else _by_index(assessment),
    }


def _mode(mode: ModeOfTest) -> dict[str, float | None]:
    return {
        "f_hz": mode.frequency,
        "xi": mode.damping_ratio,
        "alpha": mode.share,
        "A": mode.amplitude,
        "d_ms": None if mode.delay is None else _MILLISECONDS * mode.delay,
    }


def _error(error: ErrorOfTest) -> dict[str, Any]:
    return {
        **{str(name): plain_estimate(error.of(name)) for name in Metric},
        "interval_level": ERROR_LEVEL,
        "probability": error.probability,
        "parts": {name: plain_part(part) for name, part in error.parts.by_name.items()},
        "improve_first": error.parts.first,
        "would_decide": list(error.would_decide),
    }


def _over_frequency(assessment: FrameAssessment) -> dict[str, Any] | None:
    """A(f) and d(f) with their standard deviations, and the part of the error that they account for."""
    resolved, part = assessment.over_frequency, assessment.resolved
    if resolved is None or part is None:
        return None
    return {
        "frequency_hz": resolved.frequency.tolist(),
        "A": resolved.amplitude.tolist(),
        "A_deviation": resolved.amplitude_deviation.tolist(),
        "d_ms": (_MILLISECONDS * resolved.delay).tolist(),
        "d_ms_deviation": (_MILLISECONDS * resolved.delay_deviation).tolist(),
        "coherence": resolved.coherence.tolist(),
        "error": plain_part(part),
    }


def _fault(effect: FaultEffect, error: ErrorOfTest) -> dict[str, Any]:
    otherwise = effect.otherwise
    return {
        "kind": effect.fault.kind,
        "finding": effect.fault.finding,
        "in_loop": effect.fault.in_loop,
        "error": finite(error.of(error.metric).value),
        "error_otherwise": None if otherwise is None else finite(otherwise.of(error.metric).value),
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
        "index": finite(placed.index),
        "probability": capped(placed.probability),
        "a": placed.a,
        "b": placed.b,
        "confidence": criterion.confidence,
    }
