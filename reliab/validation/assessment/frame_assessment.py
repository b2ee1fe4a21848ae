"""What is found about a test of a partitioned frame."""

import math
from dataclasses import dataclass

from reliab.criterion import Criterion
from reliab.indices.tracking_over_frequency import TrackingOverFrequency
from reliab.loop.partition.frame_file import FrameUnderTest
from reliab.loop.structure import Structure
from reliab.rebuilt_error import Part
from reliab.validation.assessment.error_of_test import ErrorOfTest
from reliab.validation.assessment.findings import FaultEffect
from reliab.validation.assessment.placement import Placement
from reliab.validation.assessment.recording import Recording
from reliab.validation.assessment.tracking_index import TrackingIndex
from reliab.validation.assessment.verdict import Verdict, Word


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
    faults : tuple of FaultEffect
        Faults of the recording and what they do to the error.
    verdict : Verdict
        The verdict, by the test's own error.
    critical_delay : float
        Exact critical delay at the measured amplitude [s]; infinite where no delay is critical.
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
    faults: tuple[FaultEffect, ...]
    verdict: Verdict
    critical_delay: float
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
        if self.stability_margin is None or self.stability_margin <= 0.0:
            sentences.append("The delay exceeds the critical one: the loop is unstable.")
        if self.over_frequency is None:
            sentences.append("A and d over frequency are unknown: the displacements are hardly coherent.")
        return tuple(sentences)
