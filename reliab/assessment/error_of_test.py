"""The error of a test with the threshold it is judged by, of one interface displacement or of several."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Final

import numpy as np

from reliab.assessment.budget.sizes import (
    Equipment,
    PriorSource,
    limit_certainty,
    tolerances_of_structure,
)
from reliab.assessment.inference.uncertain_quantity import PriorKnowledge
from reliab.assessment.inferred_error import InferredError
from reliab.assessment.measured_specimen.force_channel import NOTHING_STATED, ForceChannel
from reliab.assessment.parts import ErrorPart, Parts
from reliab.assessment.rebuild import RebuiltError, rebuild
from reliab.assessment.rebuilt_error.noise import filter_of_noise
from reliab.assessment.rebuilt_error.spread import LEVEL, UNKNOWN, DisplacementError, Estimate
from reliab.assessment.recorded_ground import ShownGround, refusal_of_unit
from reliab.assessment.uncertainty_budget import BudgetItem
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.plain_values import Keys, PlainResult, same_names
from reliab.core.significant_digits import significant
from reliab.core.stated_value import StatedValue
from reliab.core.vocabulary import MILLI, PERCENT, Metric
from reliab.recordings.recording import Recording
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure

if TYPE_CHECKING:
    from reliab.assessment.inference.posterior import TestPosterior
    from reliab.assessment.measured_specimen.rebuild import MeasuredSpecimen
    from reliab.simulation.frames.frame_file import FrameUnderTest
    from reliab.simulation.hybrid_test.model_file import UpdatedModel

_PARTS: Final[Keys] = {"parts": "parts.by_name", "improve_first": "parts.first"}
_NO_PARTS: Final = Parts(by_name={}, rms=0.0)

CANCELLING = (
    "Improve first: no single part. The parts of the error cancel each other: removing any one of them "
    "would not make the error smaller."
)
"""What is said where the removal of no part of an error makes it smaller."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Question:
    """Structure, metric and threshold by which a test is judged."""

    structure: Structure  # The structure under test
    # Frequency "f" [Hz], damping ratio "xi", share "alpha", sensor "scale" [-] and "feedback_lag" [ms], each
    # with its standard deviation
    stated: Mapping[str, StatedValue]
    equipment: Equipment  # What is not known where nothing is stated
    metric: Metric  # Which error
    threshold: float  # Error of the whole test [-]
    model: "UpdatedModel | None" = None  # Calibrated model of a nonlinear specimen
    seed: int = 0  # Seed of the draws
    measured_specimen: bool = False  # Whether the specimen is known by its recorded force only
    linear_specimen: bool = False  # Whether somebody stated that the specimen is linear
    force_channel: ForceChannel | None = None  # What is stated of the force of a measured specimen
    # The frame under test, of which `structure` is the mode that governs the error; None for one mass
    frame: "FrameUnderTest | None" = None
    ignores_force: bool = False  # Whether the recorded force is faulty, or not that of a linear specimen

    @property
    def full_structure(self) -> Partition:
        """The structure with its specimen; one mass is that which is stated [kg], else one."""
        if self.frame is not None:
            return self.frame.partition
        return Partition.from_structure(self.structure, 1.0 if self.mass is None else self.mass)

    @property
    def has_masses(self) -> bool:
        """Whether masses are stated, so that forces are in the unit of the structure's matrices."""
        return self.frame is not None or self.mass is not None

    def require_learnable(self, recording: Recording) -> None:
        """Refuse a measured specimen without its force, or without the mass of the structure."""
        if not self.has_masses:
            raise InputError(
                "A measured specimen needs its force and the mass of the structure",
                value="no force" if recording.force is None else "no `mass`",
                remedy="Record the force that was fed back, and state `mass` in kilograms or record the "
                "ground acceleration, too",
                where=recording.name,
            )
        if recording.force is None:
            raise InputError(
                "A measured specimen needs its force",
                value="a recording without force",
                remedy="Record the force that was fed back, in newtons",
                where=recording.name,
            )

    @property
    def mass(self) -> float | None:
        """Mass of one mass [kg], where it is stated."""
        return self.stated["mass"].value if "mass" in self.stated else None

    @property
    def resolution(self) -> float | None:
        """Step of the converter of the measured displacement [m], where it is stated."""
        return self.stated["resolution"].value / MILLI if "resolution" in self.stated else None

    @property
    def linear(self) -> bool:
        """Whether the specimen is stated as linear, neither modelled nor learned from its force."""
        return self.model is None and not self.measured_specimen

    @property
    def to_interface(self) -> Array:
        """Interface displacements per unit of each channel [-], shape (p, p)."""
        return np.eye(1) if self.frame is None else self.frame.to_interface

    def may_have_yielded(self, recording: Recording) -> bool:
        """Whether the specimen may have yielded, of which nothing was stated and no force recorded."""
        is_settled = self.linear_specimen or self.ignores_force or not self.equipment.yielding
        return self.linear and not is_settled and recording.force is None

    @property
    def feedback_lag(self) -> float:
        """Time by which the force is stated to be fed back late [s]."""
        return self.stated.get("feedback_lag", StatedValue(0.0)).value / MILLI


@dataclass(frozen=True, kw_only=True, eq=False)
class ErrorOfTest(PlainResult):
    """Error of a test; of several interface displacements the largest one."""

    keys: ClassVar[Keys] = {
        "**": "of_several",
        **same_names("rms", "mte", "interval_level", "probability"),
        **_PARTS,
        "would_decide": "would_decide",
    }
    interval_level = LEVEL

    rebuilt: RebuiltError  # The error with its histories and draws
    metric: Metric  # Which error is asked about
    threshold: float  # Error with which it is compared [-]
    modelled: bool = False  # Whether a calibrated model says what the specimen does

    @property
    def ground(self) -> ShownGround:
        """What the recorded ground acceleration shows."""
        return self.rebuilt.ground

    @property
    def specimen(self) -> "MeasuredSpecimen | None":
        """What was learned of the specimen from its own force, where it is known by that only."""
        return self.rebuilt.specimen

    @property
    def displacements(self) -> tuple[DisplacementError, ...]:
        """Errors of the interface displacements, in their order."""
        return self.rebuilt.displacements

    @property
    def has_several(self) -> bool:
        """Whether there are several interface displacements."""
        return len(self.displacements) > 1

    @property
    def governing(self) -> DisplacementError | None:
        """The displacement with the largest error; None where all are lost in noise."""
        return self.rebuilt.governing(self.metric)

    @property
    def of_several(self) -> dict[str, Any]:
        """What is found of each of several displacements; nothing of an only one."""
        if not self.has_several:
            return {}
        degrees = {degree.name: degree.to_dict() for degree in self.degrees_of_freedom}
        return {
            "degrees_of_freedom": degrees,
            "governing": None if self.governing is None else self.governing.name,
        }

    @property
    def inferred(self) -> InferredError | None:
        """What the channels show of everything that is uncertain; None where the specimen is not linear."""
        return None if self.modelled or self.specimen is not None else self.rebuilt.inferred

    @property
    def posterior(self) -> "TestPosterior | None":
        """What the channels show of the structure; None where only the specimen's force shows something."""
        inferred = self.rebuilt.inferred if self.ground.fits else self.inferred
        return None if inferred is None else inferred.posterior

    @property
    def specimen_known(self) -> str:
        """How the specimen is known: "stated" as linear, "modelled" or "measured"."""
        if self.specimen is not None:
            return "measured"
        return "modelled" if self.modelled else "stated"

    @property
    def plain_specimen(self) -> dict[str, Any]:
        """How the specimen is known; of one that was learned, by what and how well."""
        if (specimen := self.specimen) is None:
            return {"known": self.specimen_known}
        return {
            "known": self.specimen_known,
            "held_out": specimen.held_out,
            "beyond": specimen.beyond,
            "families": [vars(family) for family in specimen.families],
        }

    @property
    def reference(self) -> Array:
        """Response of an only displacement without actuator errors [m], shape (n,)."""
        return self.displacements[0].reference

    def estimate(self, metric: Metric) -> Estimate:
        """Error by one metric, with its 90 % interval [-]; of several displacements the largest one."""
        return self.rebuilt.estimate(metric)

    @property
    def judged_estimate(self) -> Estimate:
        """Error that is compared with the threshold [-]."""
        return self.estimate(self.metric)

    @property
    def rms(self) -> Estimate:
        """RMS^R with its 90 % interval [-]."""
        return self.estimate(Metric.RMS)

    @property
    def mte(self) -> Estimate:
        """MTE^R with its 90 % interval [-]."""
        return self.estimate(Metric.MTE)

    @property
    def probability(self) -> float:
        """Probability that the error asked about stays below the threshold.

        Where sizes of what is unknown are assumed it is at most 0.99: rare sizes are not known so well.
        """
        return self._limit(self.rebuilt.probability(self.threshold, self.metric))

    def _limit(self, probability: float) -> float:
        return limit_certainty(probability, assumed=self.rebuilt.inferred.assumed)

    @property
    def displacement_suffix(self) -> str:
        """Of which of several displacements the error is, to follow its name."""
        return f" of {self.governing.name}" if self.has_several and self.governing is not None else ""

    @property
    def not_judged(self) -> tuple[str, ...]:
        """Why the errors of some displacements are not judged, in sentences."""
        return tuple(degree.refusal_reason for degree in self.displacements if not degree.judged)

    @property
    def largest_drawn(self) -> float:
        """Largest error asked about among the draws [-]."""
        return float(self.rebuilt.draws.errors(self.metric).max())

    @cached_property
    def parts(self) -> Parts:
        """Parts of the error; none where all displacements are lost in noise."""
        return _NO_PARTS if self.governing is None else self.parts_of(self.governing)

    def parts_of(self, degree: DisplacementError) -> Parts:
        """Parts of the error of one displacement."""
        parts = self.rebuilt.parts(self.displacements.index(degree))
        return parts.subtract_noise(degree.rms.value)

    def part_of_tracking(self, followed_command: Array) -> ErrorPart:
        """Part of the error that an only actuator with this displacement [m] accounts for, shape (n,)."""
        return self.rebuilt.part_of_tracking(followed_command)

    def probability_of(self, degree: DisplacementError) -> float:
        """Probability that the error of one displacement stays below the threshold."""
        return self._limit(degree.probability(self.threshold, self.metric))

    @property
    def degrees_of_freedom(self) -> "list[ErrorOfDegree]":
        """Errors of the interface displacements with their parts, the governing one first."""
        ordered_displacements = sorted(self.displacements, key=lambda degree: degree is not self.governing)
        return [
            ErrorOfDegree(
                name=degree.name,
                rms=degree.estimate(Metric.RMS),
                mte=degree.estimate(Metric.MTE),
                probability=self.probability_of(degree),
                parts=self.parts_of(degree),
            )
            if degree.judged
            else ErrorOfDegree(name=degree.name, why_not=degree.refusal_reason)
            for degree in ordered_displacements
        ]

    @cached_property
    def budget(self) -> tuple[BudgetItem, ...]:
        """What makes the interval of the governing error, if any is judged, the largest part first."""
        if self.governing is None:
            return ()
        return self.rebuilt.budget(self.metric, self.displacements.index(self.governing))

    @property
    def would_decide(self) -> tuple[str, ...]:
        """What would narrow the interval most, in a sentence; none where nothing widens it."""
        if not self.budget:
            return ()
        widest = self.budget[0]
        if widest.deviation_for_half is None or widest.unit != "%" or widest.source is PriorSource.LEARNED:
            return (widest.remedy,)
        half = significant(PERCENT * widest.deviation_for_half, 2)
        return (f"Determine the {widest.quantity} to {half} %: the interval is then half as wide.",)


@dataclass(frozen=True, kw_only=True, eq=False)
class ErrorOfDegree(PlainResult):
    """Error of one of several interface displacements with its parts, or why it is not judged."""

    keys: ClassVar[Keys] = {
        "judged": "judged",
        "why_not?": "why_not",
        **same_names("rms", "mte", "probability"),
        **_PARTS,
    }

    name: str
    why_not: str = ""  # A sentence; empty for one that is judged
    rms: Estimate = UNKNOWN  # rms, mte: RMS^R and MTE^R with their 90 % intervals [-]
    mte: Estimate = UNKNOWN
    probability: float | None = None  # That the error asked about stays below the threshold
    parts: Parts = _NO_PARTS

    @property
    def judged(self) -> bool:
        """Whether the displacement moves enough for its noise."""
        return not self.why_not


def error_of_test(
    recording: Recording,
    question: Question,
    *,
    known_offsets: Collection[int] = (),
    left_by_repairs: Mapping[str, float] | None = None,
) -> ErrorOfTest:
    """Compute the error of a test.

    `known_offsets`: places of the actuators whose sensors have no offset; `left_by_repairs`: what repairs of
    the recording leave unknown.
    """
    recording = _true_channels(recording, question)
    if question.measured_specimen:
        question.require_learnable(recording)
    structure = question.full_structure
    channel = question.force_channel or NOTHING_STATED if question.measured_specimen else None
    rebuilt = rebuild(
        recording.command,
        recording.measured,
        recording.time_step,
        question.model or structure,
        to_interface=question.to_interface,
        feedback_lag=question.feedback_lag,
        sensor_offset=np.array([0.0 if k in known_offsets else np.nan for k in range(structure.degrees)]),
        resolution=question.resolution,
        ground=recording.ground,
        force=recording.force if question.has_masses and question.model is None else None,
        ignores_force=question.ignores_force,
        force_channel=channel,
        known=PriorKnowledge(
            stated=question.stated,
            equipment=question.equipment,
            tolerances=tolerances_of_structure(question.frame, calibrated=question.model is not None),
            left_by_faults={**_open_filter(recording, question), **(left_by_repairs or {})},
        ),
        seed=question.seed,
    )
    if (refusal := refusal_of_unit(rebuilt.ground, recording)) is not None:
        raise refusal
    return ErrorOfTest(
        rebuilt=rebuilt,
        metric=question.metric,
        threshold=question.threshold,
        modelled=question.model is not None,
    )


def _true_channels(recording: Recording, question: Question) -> Recording:
    """Channels with the stated scale of the sensor, and the curves of large motions, taken away."""
    scale = question.stated.get("scale", StatedValue(1.0)).value
    recording = replace(recording, measured=recording.measured / scale)
    if question.frame is None:
        return recording
    straighten = question.frame.straighten
    return replace(recording, command=straighten(recording.command), measured=straighten(recording.measured))


def _open_filter(recording: Recording, question: Question) -> dict[str, float]:
    """Delay [s] of a filter that noise shows where no filter is stated, and the command may have passed."""
    is_stated = question.equipment.is_exact or "filter_delay" in question.stated
    if is_stated or question.frame is not None:
        return {}
    filtering = filter_of_noise(recording.command, recording.measured, recording.time_step)
    return {} if filtering is None else {"open_filter": filtering.delay}
