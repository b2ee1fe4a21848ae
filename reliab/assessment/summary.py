"""What `reliab assess` says about a test of one mass beyond what every test has: each key with its source."""

from typing import Final

from reliab.core.plain_values import Keys, same_names

_IDENTIFIED: Final = ("frequency", "damping_ratio", "experimental_fraction", "feedback_lag", "misfit")
_PLACEMENT: Final = same_names("a", "b", "index", "index_interval")

KEYS: Final[Keys] = {
    "f": "structure.frequency",
    "xi": "structure.damping_ratio",
    "alpha": "structure.experimental_fraction",
    "confidence": "promise",
    "A": "tracking.amplitude",
    "phi": "tracking.phase",
    "f_eq_hz": "tracking.plain.equivalent_frequency",
    "d_ms": "tracking.delay",
    "A_interval": "tracking.amplitude_interval",
    "d_ms_interval": "tracking.delay_interval",
    **same_names("interval_level", "index", "index_interval"),
    "error": {
        "**": "error",
        "widest": (
            "error.widenings",
            same_names("name", "deviation", "width", "width_without", "deviation_for_half"),
        ),
        "contradictions": "equation.all_contradictions",
        "identified": {
            "?": "equation.identified",
            **{name: f"equation.identified.{name}" for name in _IDENTIFIED},
            "contradicted": "equation.wrong",
        },
    },
    "by_index": {
        "verdict": "verdict_by_index.word",
        **{name: f"verdict_by_index.{name}" for name in ("reliable", "reasons", "would_decide")},
        **same_names("index", "index_interval"),
        "probability": "index_probability",
        **same_names("largest_probability", "basis"),
        "by_response": ("by_response", {**_PLACEMENT, "probability": "capped_probability"}),
        "side": "side",
    },
    "stability_margin": "stability_margin",
    "critical_delay_ms": "critical_delay",
    "basis": "basis",
    "population": {
        **{name: f"population.{name}" for name in ("a", "b", "amplitude_limit", "delay_limit_ms", "index")},
        "reliable": "population.accepted",
        "probability": "population_probability",
        **{name: f"criterion.{name}" for name in ("method", "joint")},
        "law": "criterion.law.name",
        **{name: f"criterion.provenance.{name}" for name in ("source", "n_motions", "n_events")},
        "outside_validity": "population.is_carried",
    },
    "scope": "scope",
    "motion": (
        "placement",
        {
            "name": "motion",
            **same_names("error", "error_interval", "index"),
            "reliable": "accepted",
            "probability": "capped_probability",
            "window_s": "window",
            "begin_s": "alignment.begin",
            "found_in_record": "alignment.matched",
            "match": "alignment.match",
            "match_by": "alignment.by",
            "from_rest": "alignment.from_rest",
            **same_names("a", "b"),
        },
    ),
    "would_turn": "turning",
    "specimen": "error.plain_specimen",
    "improve": (
        "improvement",
        {
            **same_names("first", "share_of_delay"),
            "tolerable_delay_ms": "tolerable_delay",
            "tolerable_amplitude_error": "tolerable_amplitude_error",
        },
    ),
    "windows": (
        "windows",
        {
            "length_s": "length",
            "time_s": "centre",
            "A": "amplitude",
            "A_sd": "amplitude_sd",
            "d_ms": "delay",
            "d_ms_sd": "delay_sd",
            "d_ms_range": "delay_range",
            "A_range": "amplitude_range",
        },
    ),
    "noise": (
        "tracking",
        {
            "share": "noise_share",
            "signal_to_noise_db": "signal_to_noise",
            **same_names("unexplained_share", "attenuation"),
            "correction_of_A": "amplitude_correction",
            "correction_of_d_ms": "delay_correction",
        },
    ),
    "tracking": (
        "measures",
        {
            "mte": "maximum_error",
            "rms": "rms_error",
            "tracking_indicator_m2": "tracking_indicator",
            "paei_phase_rad": "phase_error",
            "paei_amplitude": "amplitude_error",
            "energy_error": "energy_error",
            "energy_of_recorded_force": "of_recorded_force",
            "delay_by_correlation_ms": "delay_by_correlation",
        },
    ),
    "stated": ("stated", same_names("value", "deviation")),
    "window": {
        "seconds": "recording.duration",
        "criterion": "criterion.provenance.window",
        "motion_s": "placement.window",
    },
    "notes": "notes",
}
