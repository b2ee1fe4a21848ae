"""What `reliab assess` says about a test: plain numbers with stable keys."""

from typing import TYPE_CHECKING, Any

import numpy as np

from reliab.validation.assessment.assess import LEVEL

if TYPE_CHECKING:
    from reliab.validation.assessment.assess import Assessment

_MILLISECONDS = 1e3


def summarise(found: "Assessment") -> dict[str, Any]:
    """Put an assessment into plain numbers.

    Parameters
    ----------
    found : Assessment
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
        "index_interval": [_finite(each) for each in found.index_interval],
        "reliable": found.reliable,
        "probability": found.probability,
        "stability_margin": _finite(found.stability_margin),
        "critical_delay_ms": _finite(_MILLISECONDS * found.critical_delay),
        "basis": "population" if found.own is None else "motion",
        "population": _population(found),
        "motion": None if found.own is None else _motion(found),
        "improve": _improve(found),
        "windows": _windows(found),
        "noise": _noise(found),
        "duration_s": found.recording.duration,
        "rate_hz": 1.0 / found.recording.time_step,
        "warnings": list(found.warnings),
        "notes": [*found.recording.notes, *(() if found.own else found.criterion.provenance.warnings)],
    }


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def _population(found: "Assessment") -> dict[str, Any]:
    placed, criterion = found.population, found.criterion
    return {
        "a": placed.a,
        "b": placed.b,
        "amplitude_limit": float(np.sqrt(placed.a)),
        "delay_limit_ms": float(np.sqrt(placed.b)),
        "index": _finite(placed.index),
        "reliable": placed.index <= 1.0,
        "probability": placed.probability,
        "method": criterion.method,
        "joint": criterion.joint,
        "law": criterion.law.name,
        "source": criterion.provenance.source,
        "n_motions": criterion.provenance.n_motions,
        "n_events": criterion.provenance.n_events,
        "outside_validity": placed.carried_from is not None,
    }


def _motion(found: "Assessment") -> dict[str, Any]:
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
        "a": own.a,
        "b": own.b,
    }


def _improve(found: "Assessment") -> dict[str, Any]:
    advice = found.improvement
    return {
        "first": advice.first,
        "share_of_delay": advice.share_of_delay,
        "tolerable_delay_ms": _MILLISECONDS * advice.tolerable_delay,
        "tolerable_amplitude_error": advice.tolerable_amplitude_error,
    }


def _windows(found: "Assessment") -> dict[str, Any]:
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


def _noise(found: "Assessment") -> dict[str, Any]:
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
