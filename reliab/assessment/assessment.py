"""What is found about a test of one mass."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Final

import numpy as np

from reliab.assessment.faults import FaultEffect
from reliab.assessment.judged_test import JudgedTest
from reliab.assessment.placement import LARGEST_PROBABILITY, Placement, ScopeOfTest, reasons_without_promise
from reliab.assessment.plausibility import warn_of_signal
from reliab.assessment.recorded_force import doubts_of_force, remark_on_force
from reliab.assessment.tracking_index import LEVEL, TrackingIndex, TrackingMeasures, Windows
from reliab.assessment.verdict import Verdict, Word, verdict_by_index
from reliab.core.plain_values import Keys, same_names
from reliab.core.significant_digits import percent, share_in_words, significant
from reliab.core.stated_value import StatedValue
from reliab.core.vocabulary import ERROR_NAMES, MILLI, Metric, Side
from reliab.criterion.criterion import Criterion
from reliab.criterion.experimental_share import whole_is_worst
from reliab.structures.structure import Structure, critical_delay, stability_margin

_IDENTIFIED: Final = ("frequency", "damping_ratio", "experimental_fraction", "feedback_lag", "misfit")
_PLACEMENT: Final = same_names("a", "b", "index", "index_interval")

_SHAPE_CRITERION = "shape of the response"
_FAR_FROM_ONE = 0.2
_VARYING = 0.1  # share of a limit
_UNEXPLAINED_SHARE = 0.3  # share of the amplitude limit

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
            "error.budget",
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
class Assessment(JudgedTest):
    """What is found about a test."""

    keys: ClassVar[Keys] = {**JudgedTest.keys, **KEYS}
    interval_level = LEVEL
    largest_probability = LARGEST_PROBABILITY

    criterion: Criterion  # The criterion
    tracking: TrackingIndex  # A and d with their uncertainty
    measures: TrackingMeasures  # Established measures of tracking
    windows: Windows  # A and d in moving windows
    population: Placement  # The test against the population of ground motions
    scope: ScopeOfTest  # The test compared with the motions behind the criterion
    # The test against the motions that ship, carried to its own response; None where they cannot be
    by_response: Placement | None
    assumed: tuple[str, ...] = ()  # What was not stated and had to be assumed, in sentences

    @property
    def structure(self) -> Structure:
        """The structure under test."""
        return self.question.structure

    @property
    def stated(self) -> Mapping[str, StatedValue]:
        """What is stated of structure and channels, by the names of the options."""
        return self.question.stated

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

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """Warnings to read before relying on the verdict, in sentences."""
        return _cautions(self)


def _cautions(assessment: Assessment) -> tuple[str, ...]:
    """List what limits a verdict."""
    sentences = (
        sentence
        for group in (
            _warn_of_faults,
            _warn_of_error,
            _warn_of_assumptions,
            _warn_of_columns,
            _warn_of_force,
            _warn_of_signal,
            _warn_of_constancy,
            _warn_of_validity,
            _warn_of_scope,
            _warn_of_motion,
            _warn_of_contradictions,
        )
        for sentence in group(assessment)
    )
    return tuple(dict.fromkeys([*assessment.assumed, *sentences]))


def _warn_of_scope(assessment: Assessment) -> Iterator[str]:
    if assessment.placement is None:
        yield from assessment.scope.sentences
    if assessment.speaks_for_none:
        yield (
            "The criterion promises nothing for such a test. The error of the test "
            "itself does not depend on it."
        )


def _warn_of_faults(assessment: Assessment) -> Iterator[str]:
    for effect in assessment.faults:
        yield " ".join([effect.fault.finding, *_consequence(effect, assessment)])


def _consequence(effect: FaultEffect, assessment: Assessment) -> Iterator[str]:
    if effect.otherwise is None:
        return
    metric = Metric(assessment.criterion.metric)
    error, error_otherwise = assessment.error.estimate(metric).value, effect.otherwise.estimate(metric).value
    name, fault = ERROR_NAMES[metric], effect.fault
    sizes = [percent(size, 2) for size in (error, error_otherwise)]
    if fault.in_loop is True:
        yield (
            f"The command responds to it, so that the structure felt it: the {name} is {sizes[0]} with it "
            f"and would be {sizes[1]} without."
        )
    elif fault.kind == "zero":
        yield (
            f"The {name} is {sizes[0]} from there; from the recorded zero it would be {sizes[1]}. State "
            "zeros in channels.toml if the structure rests elsewhere."
        )
    elif fault.in_loop is False:
        reason = (
            ""
            if fault.kind in ("spike", "held")
            else "The command does not respond to it, so that only the sensor reading is wrong. "
        )
        yield f"{reason}The {name} is {sizes[0]} without it; had the structure felt it, {sizes[1]}."
    else:
        yield f"The {name} is {sizes[0]} as recorded and {sizes[1]} without it."


def _warn_of_error(assessment: Assessment) -> Iterator[str]:
    yield from assessment.equation.contradictions
    yield from assessment.equation.notes
    error_verdict, index_word = assessment.verdict, assessment.verdict_by_index.word
    if (
        Word.UNDECIDED in (error_verdict, index_word)
        or error_verdict is index_word
        or assessment.index is None
    ):
        return
    size = assessment.error.estimate(Metric(assessment.criterion.metric)).value
    basis = (
        f"{share_in_words(assessment.promise, decimals=0)} of comparable ground motions"
        if assessment.placement is None
        else "a gain and a delay alone"
    )
    reason = (
        f"{percent(assessment.tracking.unexplained_share, 2)} of the rig's motion is neither gain nor delay"
        if assessment.tracking.unexplained_share > _UNEXPLAINED_SHARE * float(np.sqrt(assessment.limits[0]))
        else "this ground motion and length are more or less demanding than those"
    )
    yield (
        f"The error of this test ({percent(size, 2)}) and the index "
        f"({significant(assessment.index)}, limit 1) "
        f"disagree: the index is for {basis}, and {reason}. The verdict follows the error."
    )


def _warn_of_assumptions(assessment: Assessment) -> Iterator[str]:
    yield from assessment.turning.warnings(assessment.judgement)


def _warn_of_columns(assessment: Assessment) -> Iterator[str]:
    tracking = assessment.tracking
    yield from (doubt.finding for doubt in assessment.column_doubts)
    if abs(tracking.amplitude - 1.0) > _FAR_FROM_ONE:
        yield (
            f"A = {tracking.amplitude:.4g} is far from 1. Check the units of command and measured "
            "displacement."
        )


def _warn_of_force(assessment: Assessment) -> Iterator[str]:
    examined = assessment.examined_force
    if examined is None:
        return
    yield from doubts_of_force(assessment.recording, examined)
    unknown = assessment.error.specimen_known != "stated" or "alpha" in assessment.equation.wrong
    if "mass" not in assessment.stated or not unknown:
        sentence = remark_on_force(examined, assessment.structure, assessment.stated)
        yield from (sentence,) if sentence else ()


def _warn_of_signal(assessment: Assessment) -> Iterator[str]:
    tracking = assessment.tracking
    yield from warn_of_signal(assessment.recording, tracking, assessment.structure.frequency)
    limit = float(np.sqrt(assessment.limits[0]))
    if tracking.unexplained_share > _UNEXPLAINED_SHARE * limit:
        yield (
            f"{percent(tracking.unexplained_share, 2)} of the measured motion is neither gain nor "
            f"delay, more than the tolerable amplitude error of {percent(limit, 2)}. Look for "
            "friction, backlash, saturation or slow noise; limits based on A and d may be off by 25 %."
        )


def _warn_of_constancy(assessment: Assessment) -> Iterator[str]:
    a, b = assessment.limits
    windows = assessment.windows
    late = MILLI * windows.delay_range
    if late > _VARYING * np.sqrt(b):
        first, last = (MILLI * delay for delay in (windows.delay.min(), windows.delay.max()))
        yield (
            f"The delay varies over the test, from {significant(first)} to {significant(last)} ms; A and d "
            "are averages. Check the compensator."
        )
    if windows.amplitude_range > _VARYING * np.sqrt(a):
        yield (
            f"The amplitude varies over the test, from A = {windows.amplitude.min():.4f} to "
            f"{windows.amplitude.max():.4f}; A is an average. Check the compensator."
        )


def _warn_of_validity(assessment: Assessment) -> Iterator[str]:
    structure, source_structure = assessment.structure, assessment.population.carried_from
    if source_structure is not None and assessment.placement is None:
        yield (
            f"The criterion does not cover the structure ({structure.frequency:g} Hz, "
            f"ξ = {structure.damping_ratio:g}); its limits are scaled from those at "
            f"{source_structure[0]:g} Hz, "
            f"ξ = {source_structure[1]:g}. Give the `motion` of the test for exact ones."
        )
    if structure.experimental_fraction < 1.0 and assessment.placement is None:
        whole_structure_is_worst = whole_is_worst(structure.frequency, structure.damping_ratio)
        judgement = (
            "it is conservative"
            if whole_structure_is_worst
            else "it may not be conservative outside of 0.5 to 3 Hz and 1 to 10 % damping"
        )
        yield (
            "The criterion is for a specimen with all of the stiffness (α = 1); for "
            f"α = {structure.experimental_fraction:g} {judgement}."
        )


def _warn_of_motion(assessment: Assessment) -> Iterator[str]:
    placement = assessment.placement
    if placement is not None and placement.alignment.matched and placement.alignment.by == _SHAPE_CRITERION:
        yield (
            f"The response has the shape, but not the size of that under {placement.motion}. "
            "Check the scale of the record and the unit of the displacements."
        )


def _warn_of_contradictions(assessment: Assessment) -> Iterator[str]:
    yield from (contradiction.finding for contradiction in assessment.contradictions)
