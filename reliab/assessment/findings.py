"""What is found about a test: numbers, before they are put into words."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Final

import numpy as np

from reliab.assessment.conflicts import OwnEquation
from reliab.assessment.error_of_test import ErrorOfTest
from reliab.assessment.judged_test import JudgedTest
from reliab.assessment.placement import LARGEST_PROBABILITY, Placement, ScopeOfTest, reasons_without_promise
from reliab.assessment.tracking_index import LEVEL, TrackingIndex, TrackingMeasures, Windows
from reliab.assessment.verdict import Contradiction, Verdict, verdict_by_index
from reliab.core.plain_values import Keys, same_names
from reliab.core.stated_value import StatedValue
from reliab.core.vocabulary import MILLI, Side
from reliab.criterion.criterion import Criterion
from reliab.recordings.recording import Recording
from reliab.structures.structure import Structure, critical_delay, stability_margin

if TYPE_CHECKING:
    from reliab.assessment.own_motion import OwnPlacement

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


@dataclass(frozen=True, kw_only=True)
class Improvement:
    """Which of the two errors weighs more, and what would be tolerable."""

    first: str  # The error with the greater part of the index
    share_of_delay: float  # Part of the delay in the index [-]
    # Delay [s] up to which the test is accepted at its own amplitude; 0 where no delay is small enough
    tolerable_delay: float
    # Amplitude error |A − 1| [-] up to which it is accepted at its own delay; likewise
    tolerable_amplitude_error: float


def improvement(amplitude: float, delay: float, a: float, b: float) -> Improvement:
    """Divide the index of a test between its two errors.

    >>> found = improvement(1.003, 0.0012, 5.3e-5, 1.04)
    >>> found.first, round(found.share_of_delay, 2), round(1e3 * found.tolerable_delay, 3)
    ('delay', 0.89, 0.929)
    """
    amplitude_part = _part((amplitude - 1.0) ** 2, a)
    delay_part = _part((MILLI * delay) ** 2, b)
    total = amplitude_part + delay_part
    share = 0.5 if total == 0.0 or np.isinf(total) else delay_part / total
    return Improvement(
        first="delay" if delay_part >= amplitude_part else "amplitude",
        share_of_delay=share,
        tolerable_delay=float(np.sqrt(max(1.0 - amplitude_part, 0.0) * b)) / MILLI,
        tolerable_amplitude_error=float(np.sqrt(max(1.0 - delay_part, 0.0) * a)),
    )


def _part(square: float, limit: float) -> float:
    if limit > 0.0:
        return square / limit
    return 0.0 if square == 0.0 else np.inf


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Findings(JudgedTest):
    """What is found about a test."""

    keys: ClassVar[Keys] = {**JudgedTest.keys, **KEYS}
    interval_level = LEVEL
    largest_probability = LARGEST_PROBABILITY

    recording: Recording
    structure: Structure  # The structure under test
    # Frequency "f", damping ratio "xi", share "alpha" and sensor "scale" with their tolerances
    stated: Mapping[str, StatedValue]
    criterion: Criterion  # The criterion
    tracking: TrackingIndex  # A and d with their uncertainty
    measures: TrackingMeasures  # Established measures of tracking
    windows: Windows  # A and d in moving windows
    population: Placement  # The test against the population of ground motions
    scope: ScopeOfTest  # The test compared with the motions behind the criterion
    # The test against the motions that ship, carried to its own response; None where they cannot be
    by_response: Placement | None
    placement: "OwnPlacement | None"  # The test against its own ground motion's boundary, where that is known
    error: ErrorOfTest
    equation: OwnEquation  # What the test's equation of motion shows about the structure
    assumed: tuple[str, ...] = ()  # What was not stated and had to be assumed, in sentences
    column_doubts: tuple[Contradiction, ...] = ()  # Why command and measured displacement may be swapped

    @property
    def _placed(self) -> Placement:
        """The test against its own ground motion where that is known, else against the population."""
        return self.population if self.placement is None else self.placement

    @property
    def index(self) -> float | None:
        """Index of the test: by its own motion where that is known, else by the population.

        None where the test leads and the criterion has no limits for leads.
        """
        return self._placed.index

    @property
    def index_interval(self) -> tuple[float, float] | None:
        """95 % interval of the index."""
        return self._placed.index_interval

    @property
    def index_probability(self) -> float | None:
        """Probability, by A and d alone, that the error of such a test stays below the threshold.

        None where the test lies outside of the motions behind the criterion.
        """
        if self.speaks_for_none:
            return None
        return self._placed.capped_probability

    @property
    def verdict_by_index(self) -> Verdict:
        """The verdict by A and d alone."""
        return verdict_by_index(
            index=self.index,
            interval=self.index_interval,
            probability=self.index_probability,
            confidence=self.criterion.confidence,
            own_motion=self.placement is not None,
            outside_reasons=reasons_without_promise(self.scope, self.criterion)
            if self.speaks_for_none
            else (),
        )

    @property
    def basis(self) -> str:
        """What the index rests on: the test's own ground motion, or a population of them."""
        return "population" if self.placement is None else "motion"

    @property
    def side(self) -> str:
        """Whether the actuator leads or lags."""
        return str(Side.LEAD if self.tracking.delay < 0.0 else Side.LAG)

    @property
    def population_probability(self) -> float | None:
        """Probability by the population; None where the test lies outside of it."""
        return None if self.scope.is_outside else self.population.capped_probability

    @property
    def notes(self) -> tuple[str, ...]:
        """What was assumed when the test was read, and what the criterion warns of, in sentences."""
        return *self.recording.notes, *(() if self.placement else self.criterion.provenance.warnings)

    @property
    def speaks_for_none(self) -> bool:
        """Whether the index rests on ground motions that are none like the test's."""
        return self.placement is None and (self.scope.is_outside or self.criterion.promise is None)

    @property
    def promise(self) -> float | None:
        """Share of the population's ground motions that is promised for the test; None where none is."""
        return None if self.speaks_for_none else self.criterion.confidence

    @property
    def stability_margin(self) -> float:
        """Stability margin: one minus the delay over the critical delay [-]."""
        late = max(self.tracking.delay, 0.0)
        return float(stability_margin(self.structure, self.tracking.amplitude, late))

    @property
    def critical_delay(self) -> float:
        """Delay [s] at which the loop would lose stability; infinite where none does."""
        return float(critical_delay(self.structure, self.tracking.amplitude))

    @property
    def limits(self) -> tuple[float, float]:
        """Ellipse parameters a [-] and b [ms²] behind the index."""
        return self._placed.a, self._placed.b

    @property
    def improvement(self) -> Improvement:
        """What to improve first, by the index."""
        return improvement(self.tracking.amplitude, self.tracking.delay, *self.limits)
