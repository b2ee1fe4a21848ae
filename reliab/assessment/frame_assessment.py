"""What is found about a test of a partitioned frame, with one actuator or with several."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reliab.assessment.frame_responses import ResponseErrors
from reliab.assessment.judged_test import JudgedTest
from reliab.assessment.parts import ErrorPart
from reliab.assessment.placement import Placement, ScopeOfTest, compare_test, reasons_without_promise
from reliab.assessment.plausibility import warn_of_signal
from reliab.assessment.recorded_force import doubts_of_force
from reliab.assessment.verdict import Verdict, verdict_by_index
from reliab.core.arrays import Array
from reliab.core.plain_values import Keys, PlainResult, same_names
from reliab.simulation.frames.frame_file import FrameUnderTest
from reliab.structures.critical_delay import StabilityLimit
from reliab.structures.structure import Structure
from reliab.tracking.indices.tracking import TrackingOverFrequency


@dataclass(frozen=True, kw_only=True)
class ModeOfTest(PlainResult):
    """A mode of a tested frame, and how the actuator tracked at its frequency."""

    keys: ClassVar[Keys] = {
        "f_hz": "frequency",
        "xi": "damping_ratio",
        "alpha": "share",
        "A": "amplitude",
        "d_ms": "delay",
    }

    # frequency, damping_ratio, share: Natural frequency [Hz], damping ratio and the specimen's share of the
    # stiffness [-]
    frequency: float
    damping_ratio: float
    share: float
    # amplitude, delay: A [-] and d [s] at that frequency; None where the test does not show them, or there
    # are several actuators
    amplitude: float | None = None
    delay: float | None = None


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class FrameAssessment(JudgedTest):
    """Assessment of a test of a partitioned frame, with one actuator or with several.

    Of several actuators, A and d are those of the one that tracks worst, `error.degrees_of_freedom` holds
    each interface displacement, and `error.rms` and `error.mte` the governing one.
    """

    keys: ClassVar[Keys] = {
        **JudgedTest.keys,
        "structure": "frame.name",
        "error_of": "error_of",
        "critical_delay_ms": "critical_delay",
        "critical_frequency_hz": "limit.frequency",
        **same_names("stability_margin", "modes", "responses"),
        "A": "worst_actuator.amplitude",
        "phi": "tracking.phase",
        "f_eq_hz": "tracking.plain.equivalent_frequency",
        "d_ms": "worst_actuator.delay",
        "over_frequency": {
            "?": "over_frequency",
            "frequency_hz": "over_frequency.frequency",
            "A": "over_frequency.amplitude",
            "A_deviation": "over_frequency.amplitude_deviation",
            "d_ms": "over_frequency.delay",
            "d_ms_deviation": "over_frequency.delay_deviation",
            "coherence": "over_frequency.coherence",
            "error": "resolved",
        },
        "specimen": "error.plain_specimen",
        "would_turn": "turning",
        "by_index": {
            "?": "verdict_by_index",
            "verdict": "verdict_by_index.word",
            **{name: f"verdict_by_index.{name}" for name in ("reliable", "reasons")},
            "index": "population.index",
            "probability": "index_probability",
            **{name: f"population.{name}" for name in ("a", "b")},
            "confidence": "promise",
            "scope": "scope",
        },
        **same_names("channels_are", "actuators", "critical_direction"),
        "shown_by_ground": {
            "?": "error.ground.misfit",
            "frequency_ratio": "error.ground.frequency",
            "deviation": "error.ground.deviation",
            "unexplained": "error.ground.misfit",
        },
    }

    responses: ResponseErrors  # Errors of all floors and storeys, as the computer had them in the test
    limit: StabilityLimit  # Where the test would become unstable with the measured gains
    # Whether `limit` is with the measured gains; else they are too uncertain, and exact ones are taken
    limit_of_gains: bool
    # A and d over frequency; None where the displacements are hardly coherent
    over_frequency: TrackingOverFrequency | None = None
    resolved: ErrorPart | None = None  # What that accounts for of the error; None where it is
    population: Placement | None = None  # The test against that criterion

    @property
    def frame(self) -> FrameUnderTest:
        """The frame and its actuators."""
        if self.question.frame is None:
            raise AssertionError  # it is of frames only
        return self.question.frame

    @property
    def mode(self) -> Structure:
        """Frequency, damping ratio and specimen's share of the mode that governs the error."""
        return self.question.structure

    @property
    def error_of(self) -> str:
        """Which response's error is judged, in words."""
        return f"the measured interface displacement{'s' if self.error.has_several else ''}"

    @property
    def critical_delay(self) -> float:
        """Exact critical delay [s]; infinite where no delay is critical."""
        return self.limit.delay

    @property
    def scope(self) -> ScopeOfTest | None:
        """The test among the motions behind the criterion; None without one."""
        if self.criterion is None:
            return None
        return compare_test(self.criterion, {"length": self.recording.duration})

    @property
    def promise(self) -> float | None:
        """Share of the population's ground motions that the criterion promises for the test."""
        if self.criterion is None or self.scope is None:
            return None
        return None if self.scope.is_outside else self.criterion.promise

    @property
    def modes(self) -> tuple[ModeOfTest, ...]:
        """Modes of the frame, the lowest first, with A and d where the test shows them."""
        partition, tracking = self.frame.partition, self.over_frequency
        frequency, ratio, _ = partition.modes
        rows = zip(frequency.tolist(), ratio.tolist(), partition.stiffness_shares.tolist(), strict=True)
        modes = []
        for f, xi, share in rows:
            a, d = (
                (None, None)
                if tracking is None or not tracking.covers(f)
                else map(float, tracking.interpolate(f))
            )
            modes.append(ModeOfTest(frequency=f, damping_ratio=xi, share=share, amplitude=a, delay=d))
        return tuple(modes)

    @property
    def channels_are(self) -> str:
        """What the channels are, in words."""
        return "interface displacements" if self.frame.channels_at_interface else "displacements of actuators"

    @property
    def actuators(self) -> tuple["ActuatorOfTest", ...]:
        """What each actuator did."""
        if self.tracking is not None:
            gains, delays = np.array([[self.tracking.amplitude]]), np.array([[self.tracking.delay]])
        else:
            gains, delays = self.error.rebuilt.readings.tracking
        return tuple(
            ActuatorOfTest(name=number, place=place, gains=gains[place], delays=delays[place])
            for place, number in enumerate(self.recording.actuators)
        )

    @property
    def worst_actuator(self) -> "ActuatorOfTest":
        """The actuator that tracks worst."""
        omega = 2.0 * np.pi * float(self.frame.partition.natural_frequencies[0])
        return max(self.actuators, key=lambda one: math.hypot(one.amplitude - 1.0, omega * one.delay))

    @property
    def stability_margin(self) -> float | None:
        """Stability margin 1 − d/τ_c [-] of the latest actuator; None where any delay is unstable."""
        if math.isinf(self.critical_delay):
            return 1.0
        if self.critical_delay <= 0.0:
            return None
        longest_delay = max(actuator.delay for actuator in self.actuators)
        return 1.0 - max(longest_delay, 0.0) / self.critical_delay

    @property
    def critical_direction(self) -> dict[str, float]:
        """Motion of the displacements in which stability is lost."""
        return dict(zip(self.frame.partition.names, self.limit.direction.tolist(), strict=True))

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings about the recording, the displacements and the loop, in sentences."""
        return tuple(dict.fromkeys(self._warn()))

    def _warn(self) -> Iterator[str]:
        yield from (effect.fault.sentence for effect in self.faults)
        yield from self.error.not_judged
        yield from self.error.ground.notes
        yield from (contradiction.finding for contradiction in self.contradictions)
        yield from self.turning.warnings(self.judgement)
        yield from self.responses.warnings
        yield from doubts_of_force(self.recording, self.examined_force)
        if self.tracking is not None:
            yield from warn_of_signal(self.recording, self.tracking, self.mode.frequency)
            if self.over_frequency is None:
                yield "A and d over frequency are unknown: the displacements are hardly coherent."
        if not self.limit_of_gains:
            yield (
                "With the measured gains the loop would be unstable even without delay. They are too "
                "uncertain, so the stability margin is that of actuators without gain errors."
            )

    @property
    def index_probability(self) -> float | None:
        """Probability by A and d that the error stays below the threshold; None where none is promised."""
        if self.promise is None or self.population is None:
            return None
        return self.population.capped_probability

    @property
    def verdict_by_index(self) -> Verdict | None:
        """The verdict by A and d alone; None without a criterion."""
        if self.population is None or self.criterion is None or self.scope is None:
            return None
        return verdict_by_index(
            index=self.population.index,
            interval=self.population.index_interval,
            probability=self.index_probability,
            confidence=self.criterion.confidence,
            own_motion=False,
            outside_reasons=(
                reasons_without_promise(self.scope, self.criterion) if self.promise is None else ()
            ),
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class ActuatorOfTest(PlainResult):
    """What an actuator did at the commands of all of them."""

    keys: ClassVar[Keys] = {
        "name": "name",
        "A": "amplitude",
        "d_ms": "delay",
        "gain_matrix_row": "gains",
        "delay_matrix_row_ms": "delays",
    }

    name: str
    place: int  # Among the actuators, from 0 on
    gains: Array  # Of its displacement for each command [-], shape (p,)
    delays: Array  # Likewise [s], shape (p,)

    @property
    def amplitude(self) -> float:
        """Gain for its own command [-]."""
        return float(self.gains[self.place])

    @property
    def delay(self) -> float:
        """Delay behind its own command [s]."""
        return float(self.delays[self.place])
