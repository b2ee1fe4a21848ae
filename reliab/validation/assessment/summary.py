"""What `reliab assess` says about a test: plain numbers with stable keys."""

from typing import Any

import numpy as np

from reliab.rebuilt_error import Estimate, Part, Widening
from reliab.rebuilt_error.interval import LEVEL as ERROR_LEVEL
from reliab.validation.assessment.findings import LARGEST_PROBABILITY, FaultEffect, Findings
from reliab.validation.assessment.own_equation import OwnEquation
from reliab.validation.assessment.tracking_index import LEVEL
from reliab.validation.assessment.verdict import Word
from reliab.vocabulary import Metric

_MILLISECONDS = 1e3


def summarise(found: Findings) -> dict[str, Any]:
    """Put an assessment into plain numbers.

    Parameters
    ----------
    found : Findings
        The assessment.

    Returns
    -------
    dict
        Ready for JSON; None where a value is infinite or unknown. Delays are in milliseconds.
    """
    tracking, structure = found.tracking, found.structure
    of_a, of_d = tracking.interval(LEVEL)
    turn = 2.0 * np.pi * tracking.plain.equivalent_frequency
    return {
        "test": found.recording.name,
        "f": structure.frequency,
        "xi": structure.damping_ratio,
        "alpha": structure.experimental_fraction,
        "threshold": found.criterion.threshold,
        "metric": found.criterion.metric,
        "confidence": found.criterion.confidence,
        "A": tracking.amplitude,
        "phi": -turn * tracking.delay,
        "f_eq_hz": tracking.plain.equivalent_frequency,
        "d_ms": _MILLISECONDS * tracking.delay,
        "A_interval": list(of_a),
        "d_ms_interval": [_MILLISECONDS * each for each in of_d],
        "interval_level": LEVEL,
        "index": _finite(found.index),
        "index_interval": _ends(found.index_interval),
        "verdict": str(found.verdict.word),
        "reliable": found.reliable,
        "reasons": list(found.verdict.reasons),
        "would_decide": list(found.verdict.would_decide),
        "probability": found.probability,
        "error": _error(found),
        "by_index": _by_index(found),
        "stability_margin": _finite(found.stability_margin),
        "critical_delay_ms": _finite(_MILLISECONDS * found.critical_delay),
        "basis": "population" if found.own is None else "motion",
        "population": _population(found),
        "motion": None if found.own is None else _motion(found),
        **_details(found),
        "duration_s": found.recording.duration,
        "rate_hz": 1.0 / found.recording.time_step,
        "notes": [*found.recording.notes, *(() if found.own else found.criterion.provenance.warnings)],
    }


def _details(found: Findings) -> dict[str, Any]:
    return {
        "improve": _improve(found),
        "windows": _windows(found),
        "noise": _noise(found),
        "tracking": _tracking(found),
        "faults": [_fault(effect, found) for effect in found.faults],
        "stated": {name: {"value": s.value, "deviation": s.deviation} for name, s in found.stated.items()},
        "window": {"seconds": found.recording.duration, "criterion": found.criterion.provenance.window},
    }


def _error(found: Findings) -> dict[str, Any]:
    error = found.error
    return {
        "rms": _interval(error.of(Metric.RMS)),
        "mte": _interval(error.of(Metric.MTE)),
        "interval_level": ERROR_LEVEL,
        "probability": error.probability,
        "parts": {name: _part(part) for name, part in error.parts.by_name.items()},
        "improve_first": error.parts.first,
        "widest": [_widening(each) for each in error.widenings],
        "would_decide": list(error.would_decide),
        "contradictions": [*found.equation.contradictions, *filter(None, [found.equation.nonlinear])],
        "identified": _identified(found.equation),
        "otherwise_stated": [_interval(each.of(found.metric)) for each in found.otherwise_stated],
    }


def _identified(equation: OwnEquation) -> dict[str, Any] | None:
    if equation.identified is None:
        return None
    quantities = {
        name: None
        if (found := getattr(equation.identified, name)) is None
        else {"value": found.value, "deviation": found.deviation, "stated": found.stated}
        for name in ("frequency", "damping_ratio", "experimental_fraction", "feedback_lag")
    }
    return {**quantities, "misfit": equation.identified.misfit, "contradicted": list(equation.wrong)}


def _part(part: Part) -> dict[str, float | None]:
    return {
        "rms": _finite(part.rms),
        "share": _finite(part.share),
        "remaining_rms": _finite(part.remaining_rms),
        "remaining_mte": _finite(part.remaining_mte),
    }


def _widening(widening: Widening) -> dict[str, Any]:
    return {
        "name": widening.name,
        "deviation": widening.deviation,
        "width": _finite(widening.width),
        "width_without": _finite(widening.width_without),
        "deviation_for_half": widening.deviation_for_half,
    }


def _interval(error: Estimate) -> dict[str, float | None]:
    return {"value": _finite(error.value), "low": _finite(error.low), "high": _finite(error.high)}


def _by_index(found: Findings) -> dict[str, Any]:
    verdict = found.verdict_by_index
    return {
        "verdict": str(verdict.word),
        "reliable": verdict.word is Word.RELIABLE,
        "reasons": list(verdict.reasons),
        "would_decide": list(verdict.would_decide),
        "index": _finite(found.index),
        "index_interval": _ends(found.index_interval),
        "probability": found.index_probability,
        "largest_probability": LARGEST_PROBABILITY,
        "basis": "population" if found.own is None else "motion",
        "side": "lead" if found.tracking.delay < 0.0 else "lag",
    }


def _fault(effect: FaultEffect, found: Findings) -> dict[str, Any]:
    metric = Metric(found.criterion.metric)
    otherwise = effect.otherwise
    return {
        "kind": effect.fault.kind,
        "finding": effect.fault.finding,
        "in_loop": effect.fault.in_loop,
        "error": _finite(found.error.of(metric).value),
        "error_otherwise": None if otherwise is None else _finite(otherwise.of(metric).value),
    }


def _tracking(found: Findings) -> dict[str, Any]:
    measures = found.measures
    return {
        "mte": measures.maximum_error,
        "rms": measures.rms_error,
        "tracking_indicator_m2": measures.tracking_indicator,
        "paei_phase_rad": measures.phase_error,
        "paei_amplitude": measures.amplitude_error,
        "energy_error": measures.energy_error,
        "energy_of_recorded_force": measures.of_recorded_force,
        "delay_by_correlation_ms": _MILLISECONDS * measures.delay_by_correlation,
    }


def _finite(value: float | None) -> float | None:
    return float(value) if value is not None and np.isfinite(value) else None


def _ends(interval: tuple[float, float] | None) -> list[float | None] | None:
    return None if interval is None else [_finite(end) for end in interval]


def _population(found: Findings) -> dict[str, Any]:
    placed, criterion = found.population, found.criterion
    return {
        "a": placed.a,
        "b": placed.b,
        "amplitude_limit": float(np.sqrt(placed.a)),
        "delay_limit_ms": float(np.sqrt(placed.b)),
        "index": _finite(placed.index),
        "reliable": None if placed.index is None else placed.index <= 1.0,
        "probability": placed.probability,
        "method": criterion.method,
        "joint": criterion.joint,
        "law": criterion.law.name,
        "source": criterion.provenance.source,
        "n_motions": criterion.provenance.n_motions,
        "n_events": criterion.provenance.n_events,
        "outside_validity": placed.carried_from is not None,
    }


def _motion(found: Findings) -> dict[str, Any]:
    own = found.own
    if own is None:
        return {}
    return {
        "name": own.motion,
        "error": own.error,
        "error_interval": list(own.error_interval),
        "index": _finite(own.index),
        "reliable": own.index <= 1.0,
        "probability": own.probability,
        "window_s": list(own.window),
        "begin_s": own.alignment.begin,
        "found_in_record": own.alignment.found,
        "match": own.alignment.match,
        "match_by": own.alignment.by,
        "from_rest": own.alignment.from_rest,
        "a": own.a,
        "b": own.b,
    }


def _improve(found: Findings) -> dict[str, Any]:
    advice = found.improvement
    return {
        "first": advice.first,
        "share_of_delay": advice.share_of_delay,
        "tolerable_delay_ms": _MILLISECONDS * advice.tolerable_delay,
        "tolerable_amplitude_error": advice.tolerable_amplitude_error,
    }


def _windows(found: Findings) -> dict[str, Any]:
    windows = found.windows
    return {
        "length_s": windows.length,
        "time_s": windows.centre.tolist(),
        "A": windows.amplitude.tolist(),
        "A_sd": windows.amplitude_sd.tolist(),
        "d_ms": (_MILLISECONDS * windows.delay).tolist(),
        "d_ms_sd": (_MILLISECONDS * windows.delay_sd).tolist(),
        "d_ms_range": _MILLISECONDS * windows.delay_range,
        "A_range": windows.amplitude_range,
    }


def _noise(found: Findings) -> dict[str, Any]:
    tracking = found.tracking
    plain = tracking.plain
    return {
        "share": tracking.noise_share,
        "signal_to_noise_db": _finite(-20.0 * float(np.log10(max(tracking.noise_share, 1e-15)))),
        "unexplained_share": tracking.unexplained_share,
        "attenuation": tracking.attenuation,
        "correction_of_A": tracking.amplitude - plain.amplitude,
        "correction_of_d_ms": _MILLISECONDS * (tracking.delay - plain.equivalent_delay),
    }
