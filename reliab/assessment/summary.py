"""What `reliab assess` says about a test: plain numbers with stable keys."""

from typing import Any

import numpy as np

from reliab.assessment.findings import LARGEST_PROBABILITY, Findings, cap_probability
from reliab.assessment.own_equation import OwnEquation
from reliab.assessment.placement import Placement
from reliab.assessment.rebuilt_error.widenings import Widening
from reliab.assessment.tracking_index import LEVEL
from reliab.assessment.verdict import Word
from reliab.core.plain_values import finite
from reliab.core.vocabulary import MILLI


def summarise(findings: Findings) -> dict[str, Any]:
    """Put what only an assessment of one mass has into plain numbers.

    Returns ready for JSON; None where a value is infinite or unknown. Delays are in milliseconds.
    """
    tracking, structure = findings.tracking, findings.structure
    a_interval, d_interval = tracking.interval(LEVEL)
    turn = 2.0 * np.pi * tracking.plain.equivalent_frequency
    return {
        "f": structure.frequency,
        "xi": structure.damping_ratio,
        "alpha": structure.experimental_fraction,
        "confidence": findings.promise,
        "A": tracking.amplitude,
        "phi": -turn * tracking.delay,
        "f_eq_hz": tracking.plain.equivalent_frequency,
        "d_ms": MILLI * tracking.delay,
        "A_interval": list(a_interval),
        "d_ms_interval": [MILLI * bound for bound in d_interval],
        "interval_level": LEVEL,
        "index": finite(findings.index),
        "index_interval": _ends(findings.index_interval),
        "error": _error(findings),
        "by_index": _summarise_by_index(findings),
        "stability_margin": finite(findings.stability_margin),
        "critical_delay_ms": finite(MILLI * findings.critical_delay),
        "basis": "population" if findings.placement is None else "motion",
        "population": _population(findings),
        "scope": findings.scope.to_dict(),
        "motion": None if findings.placement is None else _motion(findings),
        **_details(findings),
        "notes": [
            *findings.recording.notes,
            *(() if findings.placement else findings.criterion.provenance.warnings),
        ],
    }


def _details(findings: Findings) -> dict[str, Any]:
    return {
        "would_turn": findings.turning.to_dict(),
        "specimen": findings.error.plain_specimen,
        "improve": _improve(findings),
        "windows": _windows(findings),
        "noise": _noise(findings),
        "tracking": _tracking(findings),
        "stated": {name: {"value": s.value, "deviation": s.deviation} for name, s in findings.stated.items()},
        "window": {
            "seconds": findings.recording.duration,
            "criterion": findings.criterion.provenance.window,
            "motion_s": None if findings.placement is None else list(findings.placement.window),
        },
    }


def _error(findings: Findings) -> dict[str, Any]:
    error = findings.error
    return {
        **error.to_dict(),
        "widest": [_widening(widening) for widening in error.widenings],
        "contradictions": [*findings.equation.contradictions, *filter(None, [findings.equation.nonlinear])],
        "identified": _summarise_identification(findings.equation),
    }


def _summarise_identification(equation: OwnEquation) -> dict[str, Any] | None:
    if equation.identified is None:
        return None
    quantities = {
        name: None
        if (estimate := getattr(equation.identified, name)) is None
        else {"value": estimate.value, "deviation": estimate.deviation, "stated": estimate.stated}
        for name in ("frequency", "damping_ratio", "experimental_fraction", "feedback_lag")
    }
    return {**quantities, "misfit": equation.identified.misfit, "contradicted": list(equation.wrong)}


def _widening(widening: Widening) -> dict[str, Any]:
    return {
        "name": widening.name,
        "deviation": widening.deviation,
        "width": finite(widening.width),
        "width_without": finite(widening.width_without),
        "deviation_for_half": widening.deviation_for_half,
    }


def _summarise_by_index(findings: Findings) -> dict[str, Any]:
    verdict = findings.verdict_by_index
    return {
        "verdict": str(verdict.word),
        "reliable": verdict.word is Word.RELIABLE,
        "reasons": list(verdict.reasons),
        "would_decide": list(verdict.would_decide),
        "index": finite(findings.index),
        "index_interval": _ends(findings.index_interval),
        "probability": findings.index_probability,
        "largest_probability": LARGEST_PROBABILITY,
        "basis": "population" if findings.placement is None else "motion",
        "by_response": _summarise_by_response(findings.by_response),
        "side": "lead" if findings.tracking.delay < 0.0 else "lag",
    }


def _summarise_by_response(placement: Placement | None) -> dict[str, Any] | None:
    if placement is None:
        return None
    return {
        "a": placement.a,
        "b": placement.b,
        "index": finite(placement.index),
        "index_interval": _ends(placement.index_interval),
        "probability": cap_probability(placement.probability),
    }


def _tracking(findings: Findings) -> dict[str, Any]:
    measures = findings.measures
    return {
        "mte": measures.maximum_error,
        "rms": measures.rms_error,
        "tracking_indicator_m2": measures.tracking_indicator,
        "paei_phase_rad": measures.phase_error,
        "paei_amplitude": measures.amplitude_error,
        "energy_error": measures.energy_error,
        "energy_of_recorded_force": measures.of_recorded_force,
        "delay_by_correlation_ms": MILLI * measures.delay_by_correlation,
    }


def _ends(interval: tuple[float, float] | None) -> list[float | None] | None:
    return None if interval is None else [finite(end) for end in interval]


def _population(findings: Findings) -> dict[str, Any]:
    placement, criterion = findings.population, findings.criterion
    return {
        "a": placement.a,
        "b": placement.b,
        "amplitude_limit": float(np.sqrt(placement.a)),
        "delay_limit_ms": float(np.sqrt(placement.b)),
        "index": finite(placement.index),
        "reliable": None if placement.index is None else placement.index <= 1.0,
        "probability": None if findings.scope.is_outside else cap_probability(placement.probability),
        "method": criterion.method,
        "joint": criterion.joint,
        "law": criterion.law.name,
        "source": criterion.provenance.source,
        "n_motions": criterion.provenance.n_motions,
        "n_events": criterion.provenance.n_events,
        "outside_validity": placement.carried_from is not None,
    }


def _motion(findings: Findings) -> dict[str, Any]:
    placement = findings.placement
    if placement is None:
        return {}
    return {
        "name": placement.motion,
        "error": placement.error,
        "error_interval": list(placement.error_interval),
        "index": finite(placement.index),
        "reliable": placement.index <= 1.0,
        "probability": cap_probability(placement.probability),
        "window_s": list(placement.window),
        "begin_s": placement.alignment.begin,
        "found_in_record": placement.alignment.matched,
        "match": placement.alignment.match,
        "match_by": placement.alignment.by,
        "from_rest": placement.alignment.from_rest,
        "a": placement.a,
        "b": placement.b,
    }


def _improve(findings: Findings) -> dict[str, Any]:
    advice = findings.improvement
    return {
        "first": advice.first,
        "share_of_delay": advice.share_of_delay,
        "tolerable_delay_ms": MILLI * advice.tolerable_delay,
        "tolerable_amplitude_error": advice.tolerable_amplitude_error,
    }


def _windows(findings: Findings) -> dict[str, Any]:
    windows = findings.windows
    return {
        "length_s": windows.length,
        "time_s": windows.centre.tolist(),
        "A": windows.amplitude.tolist(),
        "A_sd": windows.amplitude_sd.tolist(),
        "d_ms": (MILLI * windows.delay).tolist(),
        "d_ms_sd": (MILLI * windows.delay_sd).tolist(),
        "d_ms_range": MILLI * windows.delay_range,
        "A_range": windows.amplitude_range,
    }


def _noise(findings: Findings) -> dict[str, Any]:
    tracking = findings.tracking
    plain = tracking.plain
    return {
        "share": tracking.noise_share,
        "signal_to_noise_db": finite(-20.0 * float(np.log10(max(tracking.noise_share, 1e-15)))),
        "unexplained_share": tracking.unexplained_share,
        "attenuation": tracking.attenuation,
        "correction_of_A": tracking.amplitude - plain.amplitude,
        "correction_of_d_ms": MILLI * (tracking.delay - plain.equivalent_delay),
    }
