"""What is found about a test of a partitioned frame."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from reliab.assessment.contradictions import Contradiction, of_stability
from reliab.assessment.error_of_test import ErrorOfTest
from reliab.assessment.findings import FaultEffect, capped
from reliab.assessment.frame_responses import ResponseErrors
from reliab.assessment.placement import Placement
from reliab.assessment.plain_error import finite, plain_estimate, plain_part, plain_specimen
from reliab.assessment.rebuilt_error import Part
from reliab.assessment.rebuilt_error.spread import LEVEL as ERROR_LEVEL
from reliab.assessment.scope_of_test import compared, why_for_none
from reliab.assessment.tracking_index import TrackingIndex
from reliab.assessment.turning import Turning
from reliab.assessment.verdict import Verdict, Word, verdict_by_index
from reliab.criterion import Criterion
from reliab.indices import TrackingOverFrequency
from reliab.recordings import Recording
from reliab.significant import percent_with_interval
from reliab.simulation.frames import FrameUnderTest
from reliab.structures import Structure
from reliab.vocabulary import MILLI, Metric


@dataclass(frozen=True, kw_only=True)
class ModeOfTest:
    """A mode of a tested frame, and how the actuator tracked at its frequency.

    Attributes
    ----------
    frequency, damping_ratio, share : float
        Natural frequency [Hz], damping ratio and the specimen's share of the stiffness [-].
    amplitude, delay : float or None
        A [-] and d [s] at that frequency; None where the test does not show them.
    """

    frequency: float
    damping_ratio: float
    share: float
    amplitude: float | None
    delay: float | None


@dataclass(frozen=True, kw_only=True, eq=False)
class FrameAssessment:
    """Assessment of a test of a partitioned frame.

    Attributes
    ----------
    recording : Recording
        The test.
    frame : FrameUnderTest
        The frame.
    mode : Structure
        Frequency, damping ratio and specimen's share of the mode that governs the error.
    tracking : TrackingIndex
        A and d with their uncertainty, without faults of the recording.
    over_frequency : TrackingOverFrequency or None
        A and d over frequency; None where the displacements are hardly coherent.
    error : ErrorOfTest
        The error of the measured interface displacement, from the test alone.
    resolved : Part or None
        Part of the error that A and d over frequency account for; None where these are.
    responses : ResponseErrors
        Errors of all floors and storeys, as the computer had them in the test.
    faults : tuple of FaultEffect
        Faults of the recording and what they do to the error.
    verdict : Verdict
        The verdict, by the test's own error.
    turning : Turning
        What was not stated and would turn it.
    critical_delay : float
        Exact critical delay at the measured amplitude [s]; infinite where no delay is critical.
    contradictions : tuple of Contradiction
        Where the recording contradicts what is stated, so that the verdict is undecided at best.
    criterion : Criterion or None
        A criterion of this frame, where one is given.
    population : Placement or None
        The test against that criterion.
    """

    recording: Recording
    frame: FrameUnderTest
    mode: Structure
    tracking: TrackingIndex
    over_frequency: TrackingOverFrequency | None
    error: ErrorOfTest
    resolved: Part | None
    responses: ResponseErrors
    faults: tuple[FaultEffect, ...]
    verdict: Verdict
    turning: Turning
    critical_delay: float
    contradictions: tuple[Contradiction, ...] = ()
    criterion: Criterion | None = None
    population: Placement | None = None

    @property
    def modes(self) -> tuple[ModeOfTest, ...]:
        """Modes of the frame, the lowest first."""
        partition, resolved = self.frame.partition, self.over_frequency
        rows = zip(
            partition.frame.modes.frequency.tolist(),
            partition.frame.damping_ratios.tolist(),
            partition.stiffness_shares.tolist(),
            strict=True,
        )
        modes = []
        for frequency, ratio, share in rows:
            seen = resolved is not None and resolved.known(frequency)
            a, d = map(float, resolved.at(frequency)) if resolved is not None and seen else (None, None)
            modes.append(
                ModeOfTest(frequency=frequency, damping_ratio=ratio, share=share, amplitude=a, delay=d)
            )
        return tuple(modes)

    @property
    def promise(self) -> float | None:
        """Share of the population's ground motions that the criterion promises for the test."""
        if self.criterion is None:
            return None
        outside = compared(self.criterion, {"length": self.recording.duration}).outside
        return None if outside else self.criterion.promise

    @property
    def reliable(self) -> bool:
        """Whether the verdict is "reliable"."""
        return self.verdict.word is Word.RELIABLE

    @property
    def stability_margin(self) -> float | None:
        """Stability margin 1 − d/τ_c [-]; None where the loop is unstable with any delay."""
        if math.isinf(self.critical_delay):
            return 1.0
        if self.critical_delay <= 0.0:
            return None
        return 1.0 - max(self.tracking.delay, 0.0) / self.critical_delay

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings about the recording and the loop, in sentences."""
        sentences = [effect.fault.finding for effect in self.faults]
        sentences += self.error.frequency_shown
        contradictions = [*self.contradictions, *of_stability(self.stability_margin)]
        sentences += dict.fromkeys(contradiction.finding for contradiction in contradictions)
        sentences += self.turning.warnings(self.verdict)
        sentences += self.responses.warnings
        if self.over_frequency is None:
            sentences.append("A and d over frequency are unknown: the displacements are hardly coherent.")
        return tuple(sentences)

    def to_dict(self) -> dict[str, Any]:
        """Put everything into plain numbers with stable keys; None where a value is infinite or unknown.

        The keys of other assessments where they have the same meaning, with `structure`, `error_of`,
        `modes` and `over_frequency` of the frame.
        """
        tracking, error, plain = self.tracking, self.error, self.tracking.plain
        return {
            "test": self.recording.name,
            "structure": self.frame.name,
            "error_of": "the measured interface displacement",
            "A": tracking.amplitude,
            "phi": -2.0 * np.pi * plain.equivalent_frequency * tracking.delay,
            "f_eq_hz": plain.equivalent_frequency,
            "d_ms": MILLI * tracking.delay,
            "critical_delay_ms": finite(MILLI * self.critical_delay),
            "stability_margin": self.stability_margin,
            "modes": [_mode(mode) for mode in self.modes],
            "over_frequency": _over_frequency(self),
            "error": _error(error),
            "responses": self.responses.to_dict(),
            "budget": [item.to_dict() for item in error.budget],
            "specimen": plain_specimen(error.specimen_known, error.specimen),
            "would_turn": self.turning.to_dict(),
            "metric": str(error.metric),
            "threshold": error.threshold,
            "probability": error.probability,
            "verdict": str(self.verdict.word),
            "reliable": self.reliable,
            "reasons": list(self.verdict.reasons),
            "would_decide": list(self.verdict.would_decide),
            "faults": [_fault(effect, error) for effect in self.faults],
            "warnings": list(self.warnings),
            "recording": {"channels": [channel.summary() for channel in self.recording.channels]},
            "duration_s": self.recording.duration,
            "rate_hz": 1.0 / self.recording.time_step,
            "notes": list(self.recording.notes),
            "by_index": None if self.criterion is None else _by_index(self),
        }

    def __repr__(self) -> str:
        size = self.error.estimate(self.error.metric)
        return (
            f"<FrameAssessment of {self.recording.name}: {str(self.verdict.word).replace('_', ' ')}, "
            f"{self.error.metric.upper()} error {percent_with_interval(size.value, size.low, size.high)}>"
        )


def _mode(mode: ModeOfTest) -> dict[str, float | None]:
    return {
        "f_hz": mode.frequency,
        "xi": mode.damping_ratio,
        "alpha": mode.share,
        "A": mode.amplitude,
        "d_ms": None if mode.delay is None else MILLI * mode.delay,
    }


def _error(error: ErrorOfTest) -> dict[str, Any]:
    return {
        **{str(name): plain_estimate(error.estimate(name)) for name in Metric},
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
        "d_ms": (MILLI * resolved.delay).tolist(),
        "d_ms_deviation": (MILLI * resolved.delay_deviation).tolist(),
        "coherence": resolved.coherence.tolist(),
        "error": plain_part(part),
    }


def _fault(effect: FaultEffect, error: ErrorOfTest) -> dict[str, Any]:
    otherwise = effect.otherwise
    return {
        "kind": effect.fault.kind,
        "finding": effect.fault.finding,
        "in_loop": effect.fault.in_loop,
        "error": finite(error.estimate(error.metric).value),
        "error_otherwise": None if otherwise is None else finite(otherwise.estimate(error.metric).value),
    }


def _by_index(assessment: FrameAssessment) -> dict[str, Any] | None:
    """Compare the test with the criterion that is given."""
    placed, criterion = assessment.population, assessment.criterion
    if placed is None or criterion is None:
        return None
    scope = compared(criterion, {"length": assessment.recording.duration})
    promise = assessment.promise
    probability = None if promise is None else capped(placed.probability)
    verdict = verdict_by_index(
        index=placed.index,
        interval=placed.index_interval,
        probability=probability,
        confidence=criterion.confidence,
        own_motion=False,
        outside=why_for_none(scope, criterion) if promise is None else (),
    )
    return {
        "verdict": str(verdict.word),
        "reliable": verdict.word is Word.RELIABLE,
        "reasons": list(verdict.reasons),
        "index": finite(placed.index),
        "probability": probability,
        "a": placed.a,
        "b": placed.b,
        "confidence": promise,
        "scope": scope.to_dict(),
    }
