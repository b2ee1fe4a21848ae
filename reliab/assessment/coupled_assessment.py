"""What is found about a test with several actuators."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from reliab.assessment.budget import BudgetItem, Size, as_certain_as, budget_of_error
from reliab.assessment.coupled_error import CoupledError, DegreeError, ShownByGround
from reliab.assessment.faults import Fault
from reliab.assessment.frame_responses import ResponseErrors
from reliab.assessment.plain_error import finite, plain_estimate, plain_part
from reliab.assessment.rebuilt_error.spread import LEVEL
from reliab.assessment.verdict import Verdict, Word
from reliab.recordings import CoupledRecording
from reliab.significant import percent, percent_with_interval
from reliab.simulation.frames import FrameUnderTest
from reliab.structures import StabilityLimit
from reliab.vocabulary import MILLI, Metric

CAUSES_IN_WORDS = {
    "gain": "gain",
    "delay": "delay",
    "cross_coupling": "motion that other actuators cause",
    "rest": "other tracking errors",
}

_UNKNOWN = {"value": None, "low": None, "high": None}


@dataclass(frozen=True, kw_only=True, eq=False)
class CoupledAssessment:
    """Assessment of a test with several actuators.

    Attributes
    ----------
    recording : CoupledRecording
        The test.
    frame : FrameUnderTest
        The frame and its actuators.
    error : CoupledError
        The error of each interface displacement, from the test alone.
    metric : Metric
        Which error is asked about.
    threshold : float
        Largest error of a reliable test [-].
    faults : tuple of (str, Fault)
        Faults of the recording, each with the number of its actuator.
    sizes : mapping of str to Size
        Sizes of what is not known of the test, by the names of the tolerances.
    verdict : Verdict
        The verdict, by the error of the displacement whose error is largest.
    limit : StabilityLimit
        Where the test would become unstable.
    limit_of_gains : bool
        Whether that is with the measured gains; else they are too uncertain, and exact ones are taken.
    doubt_of_skew : str
        What is assumed of the skew of a slow recording; empty where it was stated.
    responses : ResponseErrors
        Errors of all floors and storeys, as the computer had them in the test.
    shown_by_ground : ShownByGround, optional
        What the recorded ground acceleration shows of the structure; None where it was not recorded.
    """

    recording: CoupledRecording
    frame: FrameUnderTest
    error: CoupledError
    metric: Metric
    threshold: float
    faults: tuple[tuple[str, Fault], ...]
    sizes: Mapping[str, Size]
    verdict: Verdict
    limit: StabilityLimit
    responses: ResponseErrors
    limit_of_gains: bool = True
    doubt_of_skew: str = ""
    shown_by_ground: ShownByGround | None = None

    @property
    def reliable(self) -> bool:
        """Whether the verdict is "reliable"."""
        return self.verdict.word is Word.RELIABLE

    @property
    def governing(self) -> DegreeError | None:
        """The displacement with the largest error; None where all are lost in noise."""
        return self.error.governing(self.metric)

    @property
    def probability(self) -> float:
        """Probability that the error of every judged displacement is below the threshold.

        At most 0.99 where sizes of what is not known are assumed.
        """
        return as_certain_as(self.sizes, self.error.probability(self.threshold, self.metric))

    @property
    def budget(self) -> tuple[BudgetItem, ...]:
        """What makes the interval of the governing error, the largest contribution first."""
        return budget_of_error(self.error.widenings(self.metric), self.sizes)

    @property
    def stability_margin(self) -> float:
        """Stability margin 1 − d/τ_c [-] by the largest delay of an actuator."""
        if math.isinf(self.limit.delay):
            return 1.0
        return 1.0 - max(float(np.diag(self.error.parts.delay).max()), 0.0) / self.limit.delay

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings about the recording and the displacements, in sentences."""
        sentences = [f"Actuator {number}: {fault.finding}" for number, fault in self.faults]
        sentences += [lost_in_noise(degree) for degree in self.error.degrees if not degree.judged]
        if not self.limit_of_gains:
            sentences.append(
                "The actuators' gains cannot be told apart by this motion: the stability margin is that of "
                "actuators without gain errors."
            )
        if self.doubt_of_skew:
            sentences.append(self.doubt_of_skew)
        sentences += self.responses.warnings
        if self.shown_by_ground is not None and self.shown_by_ground.opposite:
            sentences.append("The ground acceleration has the opposite sign.")
        if self.stability_margin < 0.0:
            sentences.append(
                "The measured delay is longer than the critical delay: the structure or the channels are "
                "not as stated, or the test was unstable."
            )
        return tuple(sentences)

    def to_dict(self) -> dict[str, Any]:
        """Put everything into plain numbers with stable keys; None where a value is infinite or unknown.

        The keys of other assessments where they have the same meaning; `error.degrees_of_freedom` holds each
        interface displacement, `error.rms` and `error.mte` the governing one, `actuators` what each did.
        """
        return {
            "test": self.recording.name,
            "structure": self.frame.name,
            "error_of": "the measured interface displacements",
            "channels_are": "interface displacements"
            if self.frame.channels_at_interface
            else "displacements of actuators",
            **_tracking(self),
            **_stability(self),
            "modes": _modes(self),
            "error": _error(self),
            "budget": [item.to_dict() for item in self.budget],
            "responses": self.responses.to_dict(),
            "shown_by_ground": _shown(self.shown_by_ground),
            "metric": str(self.metric),
            "threshold": self.threshold,
            "probability": self.probability,
            "verdict": str(self.verdict.word),
            "reliable": self.reliable,
            "reasons": list(self.verdict.reasons),
            "would_decide": list(self.verdict.would_decide),
            "faults": [
                {"actuator": number, "kind": fault.kind, "finding": fault.finding, "in_loop": fault.in_loop}
                for number, fault in self.faults
            ],
            "warnings": list(self.warnings),
            "recording": {"channels": [channel.summary() for channel in self.recording.channels]},
            "duration_s": self.recording.duration,
            "rate_hz": 1.0 / self.recording.time_step,
            "notes": list(self.recording.notes),
        }

    def __repr__(self) -> str:
        governing = self.governing
        if governing is None:
            return f"<CoupledAssessment of {self.recording.name}: undecided, all motion is lost in noise>"
        size = governing.estimate(self.metric)
        return (
            f"<CoupledAssessment of {self.recording.name}: {str(self.verdict.word).replace('_', ' ')}, "
            f"{self.metric.upper()} error of {governing.name} "
            f"{percent_with_interval(size.value, size.low, size.high)}>"
        )


def lost_in_noise(degree: DegreeError) -> str:
    """Say why a displacement is not judged."""
    if math.isinf(degree.noise):
        return f"{degree.name} does not move, and its error is not judged."
    return (
        f"{degree.name} moves too little for the noise of its sensors, which leaves "
        f"{percent(degree.noise)} of its largest displacement open: its error is not judged."
    )


def cause_in_words(part: str) -> str:
    """Name a part of the error, such as "actuator_1_gain", in words."""
    for cause, words in CAUSES_IN_WORDS.items():
        if part.endswith(f"_{cause}"):
            number = part.removeprefix("actuator_").removesuffix(f"_{cause}")
            return f"{words} of actuator {number}"
    return "lag of the fed-back force"


def _tracking(assessment: CoupledAssessment) -> dict[str, Any]:
    """Gains and delays of the actuators; A and d are those of the one that tracks worst."""
    gains, delays = assessment.error.parts.gain, assessment.error.parts.delay
    omega = 2.0 * np.pi * float(assessment.frame.partition.natural_frequencies[0])
    worst = int(np.argmax(np.hypot(np.diag(gains) - 1.0, omega * np.diag(delays))))
    actuators = [
        {
            "name": number,
            "A": float(gains[place, place]),
            "d_ms": MILLI * float(delays[place, place]),
            "gain_matrix_row": gains[place].tolist(),
            "delay_matrix_row_ms": (MILLI * delays[place]).tolist(),
        }
        for place, number in enumerate(assessment.recording.actuators)
    ]
    return {"actuators": actuators, "A": actuators[worst]["A"], "d_ms": actuators[worst]["d_ms"]}


def _stability(assessment: CoupledAssessment) -> dict[str, Any]:
    limit, names = assessment.limit, assessment.frame.partition.names
    return {
        "critical_delay_ms": finite(MILLI * limit.delay),
        "critical_frequency_hz": finite(limit.frequency),
        "critical_direction": dict(zip(names, limit.direction.tolist(), strict=True)),
        "stability_margin": finite(assessment.stability_margin),
    }


def _shown(shown: ShownByGround | None) -> dict[str, float] | None:
    """Factor of frequencies that the ground motion shows, and what it leaves unexplained."""
    if shown is None:
        return None
    return {
        "frequency_ratio": shown.frequency,
        "deviation": shown.deviation,
        "unexplained": shown.misfit,
    }


def _modes(assessment: CoupledAssessment) -> list[dict[str, Any]]:
    partition = assessment.frame.partition
    frequency, ratio, _ = partition.modes
    return [
        {"f_hz": f, "xi": xi, "alpha": alpha}
        for f, xi, alpha in zip(
            frequency.tolist(), ratio.tolist(), partition.stiffness_shares.tolist(), strict=True
        )
    ]


def _error(assessment: CoupledAssessment) -> dict[str, Any]:
    error, governing = assessment.error, assessment.governing
    ordered = sorted(error.degrees, key=lambda degree: degree is not governing)
    degrees = {degree.name: _degree(assessment, degree) for degree in ordered}
    at = None if governing is None else degrees[governing.name]
    return {
        "degrees_of_freedom": degrees,
        "governing": None if governing is None else governing.name,
        "rms": _UNKNOWN if at is None else at["rms"],
        "mte": _UNKNOWN if at is None else at["mte"],
        "interval_level": LEVEL,
        "probability": assessment.probability,
        "parts": {} if at is None else at["parts"],
        "improve_first": None if at is None else at["improve_first"],
        "would_decide": list(assessment.verdict.would_decide),
    }


def _degree(assessment: CoupledAssessment, degree: DegreeError) -> dict[str, Any]:
    place = assessment.frame.partition.names.index(degree.name)
    if not degree.judged:
        return {
            "judged": False,
            "why_not": lost_in_noise(degree),
            "rms": _UNKNOWN,
            "mte": _UNKNOWN,
            "probability": None,
            "parts": {},
            "improve_first": None,
        }
    parts = assessment.error.parts.of_degree(place)
    return {
        "judged": True,
        "rms": plain_estimate(degree.rms),
        "mte": plain_estimate(degree.mte),
        "probability": as_certain_as(
            assessment.sizes, degree.probability(assessment.threshold, assessment.metric)
        ),
        "parts": {name: plain_part(part) for name, part in parts.by_name.items()},
        "improve_first": parts.first,
    }
