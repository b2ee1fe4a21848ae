"""What is found about a test of a partitioned frame, with one actuator or with several."""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from reliab.assessment.contradictions import contradict_stability
from reliab.assessment.doubts import doubts_of_signal
from reliab.assessment.error_of_test import ErrorOfTest
from reliab.assessment.error_with_threshold import ErrorOfSeveral
from reliab.assessment.findings import cap_probability
from reliab.assessment.frame_responses import ResponseErrors
from reliab.assessment.judged_test import JudgedTest
from reliab.assessment.placement import Placement
from reliab.assessment.rebuilt_error.parts import ErrorPart
from reliab.assessment.recorded_force import doubts_of_force
from reliab.assessment.scope_of_test import compare_test, reasons_without_promise
from reliab.assessment.tracking_index import TrackingIndex
from reliab.assessment.uncertainty_budget import BudgetItem
from reliab.assessment.verdict import Word, verdict_by_index
from reliab.core.plain_values import finite
from reliab.core.vocabulary import MILLI
from reliab.criterion.criterion import Criterion
from reliab.recordings.coupled_recording import CoupledRecording
from reliab.recordings.recording import Recording
from reliab.simulation.frames.frame_file import FrameUnderTest
from reliab.structures.critical_delay import StabilityLimit
from reliab.structures.structure import Structure
from reliab.tracking.indices.frequency_evaluation import TrackingOverFrequency


@dataclass(frozen=True, kw_only=True)
class ModeOfTest:
    """A mode of a tested frame, and how the actuator tracked at its frequency."""

    # frequency, damping_ratio, share: Natural frequency [Hz], damping ratio and the specimen's share of the
    # stiffness [-]
    frequency: float
    damping_ratio: float
    share: float
    # amplitude, delay: A [-] and d [s] at that frequency; None where the test does not show them, or there
    # are several actuators
    amplitude: float | None = None
    delay: float | None = None

    def to_dict(self) -> dict[str, float | None]:
        """Put it into plain values."""
        return {
            "f_hz": self.frequency,
            "xi": self.damping_ratio,
            "alpha": self.share,
            "A": self.amplitude,
            "d_ms": None if self.delay is None else MILLI * self.delay,
        }


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class JudgedFrame(JudgedTest, ABC):
    """Assessment of a test of a partitioned frame, as far as it is the same for any number of actuators."""

    frame: FrameUnderTest  # The frame and its actuators
    responses: ResponseErrors  # Errors of all floors and storeys, as the computer had them in the test
    limit: StabilityLimit  # Where the test would become unstable with the measured gains

    error_of: ClassVar[str]

    @property
    @abstractmethod
    def longest_delay(self) -> float:
        """Delay of the actuator that is latest [s]."""

    @property
    def critical_delay(self) -> float:
        """Exact critical delay [s]; infinite where no delay is critical."""
        return self.limit.delay

    @property
    def budget(self) -> tuple[BudgetItem, ...]:
        """What makes the interval of the error, the largest contribution first."""
        return self.error.budget

    @property
    def modes(self) -> tuple[ModeOfTest, ...]:
        """Modes of the frame, the lowest first."""
        partition = self.frame.partition
        frequency, ratio, _ = partition.modes
        rows = zip(frequency.tolist(), ratio.tolist(), partition.stiffness_shares.tolist(), strict=True)
        return tuple(ModeOfTest(frequency=f, damping_ratio=xi, share=share) for f, xi, share in rows)

    @property
    def stability_margin(self) -> float | None:
        """Stability margin 1 − d/τ_c [-]; None where the loop is unstable with any delay."""
        if math.isinf(self.critical_delay):
            return 1.0
        if self.critical_delay <= 0.0:
            return None
        return 1.0 - max(self.longest_delay, 0.0) / self.critical_delay

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings about the recording and the loop, in sentences."""
        contradictions = [*self.contradictions, *contradict_stability(self.stability_margin)]
        return (
            *(effect.fault.sentence for effect in self.faults),
            *self.error.not_judged,
            *dict.fromkeys(
                [*self.error.ground.notes, *(contradiction.finding for contradiction in contradictions)]
            ),
            *self.turning.warnings(self.judgement),
            *self.responses.warnings,
        )

    def to_dict(self) -> dict[str, Any]:
        """Put everything into plain numbers with stable keys; None where a value is infinite or unknown."""
        return {
            **super().to_dict(),
            "structure": self.frame.name,
            "error_of": self.error_of,
            "critical_delay_ms": finite(MILLI * self.critical_delay),
            "critical_frequency_hz": finite(self.limit.frequency),
            "stability_margin": self.stability_margin,
            "modes": [mode.to_dict() for mode in self.modes],
            "responses": self.responses.to_dict(),
        }


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class FrameAssessment(JudgedFrame):
    """Assessment of a test of a partitioned frame with one actuator."""

    recording: Recording
    error: ErrorOfTest
    mode: Structure  # Frequency, damping ratio and specimen's share of the mode that governs the error
    tracking: TrackingIndex  # A and d with their uncertainty, without faults of the recording
    # A and d over frequency; None where the displacements are hardly coherent
    over_frequency: TrackingOverFrequency | None
    resolved: ErrorPart | None  # What A and d over frequency account for of the error; None where these are
    criterion: Criterion | None = None  # A criterion of this frame, where one is given
    population: Placement | None = None  # The test against that criterion

    error_of = "the measured interface displacement"

    @property
    def promise(self) -> float | None:
        """Share of the population's ground motions that the criterion promises for the test."""
        if self.criterion is None:
            return None
        is_outside = compare_test(self.criterion, {"length": self.recording.duration}).is_outside
        return None if is_outside else self.criterion.promise

    @property
    def longest_delay(self) -> float:
        """Equivalent delay of the actuator [s]."""
        return self.tracking.delay

    @property
    def modes(self) -> tuple[ModeOfTest, ...]:
        """Modes of the frame, the lowest first, with A and d where the test shows them."""
        tracking = self.over_frequency
        if tracking is None:
            return super().modes
        modes = []
        for mode in super().modes:
            is_covered = tracking.covers(mode.frequency)
            a, d = map(float, tracking.interpolate(mode.frequency)) if is_covered else (None, None)
            modes.append(replace(mode, amplitude=a, delay=d))
        return tuple(modes)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings about the recording and the loop, in sentences."""
        sentences = [*super().warnings, *doubts_of_force(self.recording)]
        sentences += doubts_of_signal(self.recording, self.tracking, self.mode.frequency)
        if self.over_frequency is None:
            sentences.append("A and d over frequency are unknown: the displacements are hardly coherent.")
        return tuple(sentences)

    def to_dict(self) -> dict[str, Any]:
        """Put everything into plain numbers: also A and d, over frequency too, and the criterion's index."""
        tracking, plain = self.tracking, self.tracking.plain
        return {
            **super().to_dict(),
            "A": tracking.amplitude,
            "phi": -2.0 * np.pi * plain.equivalent_frequency * tracking.delay,
            "f_eq_hz": plain.equivalent_frequency,
            "d_ms": MILLI * tracking.delay,
            "over_frequency": _summarise_over_frequency(self),
            "specimen": self.error.plain_specimen,
            "would_turn": self.turning.to_dict(),
            "by_index": None if self.criterion is None else _summarise_by_index(self),
        }


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class CoupledAssessment(JudgedFrame):
    """Assessment of a test of a partitioned frame with several actuators."""

    recording: CoupledRecording
    error: ErrorOfSeveral
    # Whether `limit` is with the measured gains; else they are too uncertain, and exact ones are taken
    limit_of_gains: bool = True

    error_of = "the measured interface displacements"

    @property
    def longest_delay(self) -> float:
        """Delay of the actuator that follows its own command latest [s]."""
        return float(np.diag(self.error.parts.delay).max())

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings about the recording, the displacements and the loop, in sentences."""
        sentences = list(super().warnings)
        if not self.limit_of_gains:
            sentences.append(
                "The actuators' gains cannot be told apart by this motion: the stability margin is that of "
                "actuators without gain errors."
            )
        return tuple(sentences)

    def to_dict(self) -> dict[str, Any]:
        """Put everything into plain numbers: also what each actuator did.

        `error.degrees_of_freedom` holds each interface displacement, `error.rms` and `error.mte` the
        governing one; A and d are those of the actuator that tracks worst.
        """
        gains, delays = np.asarray(self.error.parts.gain), np.asarray(self.error.parts.delay)
        omega = 2.0 * np.pi * float(self.frame.partition.natural_frequencies[0])
        worst = int(np.argmax(np.hypot(np.diag(gains) - 1.0, omega * np.diag(delays))))
        actuators = [
            {
                "name": number,
                "A": float(gains[place, place]),
                "d_ms": MILLI * float(delays[place, place]),
                "gain_matrix_row": gains[place].tolist(),
                "delay_matrix_row_ms": (MILLI * delays[place]).tolist(),
            }
            for place, number in enumerate(self.recording.actuators)
        ]
        are_interface_channels = self.frame.channels_at_interface
        directions = zip(self.frame.partition.names, self.limit.direction.tolist(), strict=True)
        return {
            **super().to_dict(),
            "channels_are": "interface displacements"
            if are_interface_channels
            else "displacements of actuators",
            "actuators": actuators,
            "A": actuators[worst]["A"],
            "d_ms": actuators[worst]["d_ms"],
            "critical_direction": dict(directions),
            "shown_by_ground": self.error.ground.to_dict(),
        }


def _summarise_over_frequency(assessment: FrameAssessment) -> dict[str, Any] | None:
    """A(f) and d(f) with their standard deviations, and the part of the error that they account for."""
    tracking, part = assessment.over_frequency, assessment.resolved
    if tracking is None or part is None:
        return None
    return {
        "frequency_hz": tracking.frequency.tolist(),
        "A": tracking.amplitude.tolist(),
        "A_deviation": tracking.amplitude_deviation.tolist(),
        "d_ms": (MILLI * tracking.delay).tolist(),
        "d_ms_deviation": (MILLI * tracking.delay_deviation).tolist(),
        "coherence": tracking.coherence.tolist(),
        "error": part.to_dict(),
    }


def _summarise_by_index(assessment: FrameAssessment) -> dict[str, Any] | None:
    """Compare the test with the criterion that is given."""
    placement, criterion = assessment.population, assessment.criterion
    if placement is None or criterion is None:
        return None
    scope = compare_test(criterion, {"length": assessment.recording.duration})
    promise = assessment.promise
    probability = None if promise is None else cap_probability(placement.probability)
    verdict = verdict_by_index(
        index=placement.index,
        interval=placement.index_interval,
        probability=probability,
        confidence=criterion.confidence,
        own_motion=False,
        outside_reasons=reasons_without_promise(scope, criterion) if promise is None else (),
    )
    return {
        "verdict": str(verdict.word),
        "reliable": verdict.word is Word.RELIABLE,
        "reasons": list(verdict.reasons),
        "index": finite(placement.index),
        "probability": probability,
        "a": placement.a,
        "b": placement.b,
        "confidence": promise,
        "scope": scope.to_dict(),
    }
