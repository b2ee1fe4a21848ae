"""The error of one test, rebuilt from its command and measured displacement."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final, overload

import numpy as np

from reliab.assessment.budget.sizes import Equipment, tolerances_of_structure
from reliab.assessment.error_with_threshold import ErrorOfSeveral, ErrorWithThreshold
from reliab.assessment.inference.channel_spectra import ChannelSpectra
from reliab.assessment.inference.uncertain_quantity import Circumstances
from reliab.assessment.inferred_error import infer_errors
from reliab.assessment.parts import ErrorPart, Parts
from reliab.assessment.rebuild import Readings, RebuiltError
from reliab.assessment.rebuilt_error.noise import filter_of_noise
from reliab.assessment.rebuilt_error.readings import require_lag
from reliab.assessment.rebuilt_error.widenings import Widening
from reliab.assessment.recorded_force import stiffness_from_mass
from reliab.assessment.recorded_ground import ShownGround, examine_ground, examine_ground_by_force
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.stated_value import StatedValue
from reliab.core.vocabulary import MILLI, Metric
from reliab.recordings.coupled_recording import CoupledRecording
from reliab.recordings.recording import Recording
from reliab.structures.partition import Partition, whole_structure
from reliab.structures.structure import Structure

if TYPE_CHECKING:
    from reliab.assessment.measured_specimen.force_channel import ForceChannel
    from reliab.assessment.measured_specimen.rebuild import MeasuredSpecimen
    from reliab.simulation.frames.frame_file import FrameUnderTest
    from reliab.simulation.hybrid_test.model_file import UpdatedModel

PART_NAMES: Final[Mapping[str, str]] = {
    "amplitude": "amplitude",
    "delay": "delay",
    "neither": "other tracking errors",
    "fed_back_force": "lag of the fed-back force",
}
"""Parts of the error in words."""

CANCELLING = (
    "Improve first: no single part. The parts of the error cancel each other: removing any one of them "
    "would not make the error smaller."
)
"""What is said where the removal of no part of an error makes it smaller."""

_CAUSES: Final[Mapping[str, str]] = {
    "gain": "gain of actuator {}",
    "delay": "delay of actuator {}",
    "cross_coupling": "motion of actuator {} that others cause",
    "rest": "other tracking errors of actuator {}",
}


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
    force_channel: "ForceChannel | None" = None  # What is stated of the force of a measured specimen
    # The frame under test, of which `structure` is the mode that governs the error; None for one mass
    frame: "FrameUnderTest | None" = None
    ignores_force: bool = False  # Whether the recorded force is not that of a linear specimen

    @property
    def full_structure(self) -> Partition:
        """The structure with its specimen."""
        return whole_structure(self.structure) if self.frame is None else self.frame.partition

    def rebuilt_structure(self, recording: Recording | CoupledRecording) -> Partition:
        """Structure with which the error of a test is rebuilt; of a measured specimen with its mass [kg]."""
        if self.model is not None:
            from reliab.assessment.modelled_test import tangent_structure

            return tangent_structure(self.model.test)
        if self.linear:
            return self.full_structure
        force = recording.force if isinstance(recording, Recording) else None
        if self.frame is None and self.mass is None:
            raise InputError(
                "A measured specimen needs its force and the mass of the structure",
                value="no force" if force is None else "no `mass`",
                remedy="Record the force that was fed back, and state `mass` in kilograms",
                where=recording.name,
            )
        if force is None:
            raise InputError(
                "A measured specimen needs its force",
                value="a recording without force",
                remedy="Record the force that was fed back, in newtons",
                where=recording.name,
            )
        if self.frame is not None or self.mass is None:
            return self.full_structure
        return Partition.from_structure(self.structure, self.mass)

    @property
    def mass(self) -> float | None:
        """Mass of one mass [kg], where it is stated."""
        return self.stated["mass"].value if "mass" in self.stated else None

    def stiffness_of_specimen(self, number: int) -> float | None:
        """Stiffness against the motion of an actuator [N/m]; None where no mass is stated."""
        if self.frame is not None:
            return float(self.frame.partition.specimen_stiffness[number, number])
        return stiffness_from_mass(self.structure, self.stated)

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

    def may_have_yielded(self, recording: Recording | CoupledRecording) -> bool:
        """Whether the specimen may have yielded, of which nothing was stated and no force recorded."""
        return (
            isinstance(recording, Recording)
            and self.linear
            and not self.linear_specimen
            and recording.force is None
            and self.equipment.yielding > 0.0
        )

    @property
    def feedback_lag(self) -> float:
        """Time by which the force is stated to be fed back late [s]."""
        return self.stated.get("feedback_lag", StatedValue(0.0)).value / MILLI

    def circumstances(
        self,
        channels: ChannelSpectra,
        ground: ShownGround,
        left_by_faults: Mapping[str, float],
        structure: Partition,
    ) -> Circumstances:
        """Put together what is known before the channels are weighed; `left_by_faults` [SI units]."""
        return Circumstances(
            partition=structure,
            channels=replace(channels, ground=ground.evidence(channels.ground)),
            stated=self.stated,
            equipment=self.equipment,
            tolerances=tolerances_of_structure(self.frame, calibrated=self.model is not None),
            specimen_force=channels.force is not None and not self.ignores_force,
            feedback_lag=self.feedback_lag,
            left_by_faults=left_by_faults,
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class ErrorOfTest(ErrorWithThreshold):
    """Error of a test with one actuator."""

    rebuilt: RebuiltError
    damping_ratio: float  # ξ of the structure with which it was rebuilt [-]

    @property
    def displacements(self) -> tuple[RebuiltError]:
        """The error of the one interface displacement."""
        return (self.rebuilt,)

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
        """Response without actuator errors, computed from the test [m], shape (n,)."""
        return self.rebuilt.reference

    @cached_property
    def parts(self) -> Parts:
        """Parts of the error: amplitude, delay, neither, and a late force."""
        return (self.specimen or self.rebuilt).parts().subtract_noise(self.estimate(Metric.RMS).value)

    def part_of_tracking(self, followed_command: Array) -> ErrorPart:
        """Part of the error that an actuator with this displacement [m] accounts for, shape (n,)."""
        return (self.specimen or self.rebuilt).part_of_tracking(followed_command)

    @cached_property
    def widenings(self) -> tuple[Widening, ...]:
        """What widens the interval, the widest first."""
        return (self.specimen or self.rebuilt).widenings(self.metric)


def part_in_words(name: str) -> str:
    """Name a part of the error, such as "delay" or "actuator_1_delay", in words."""
    for cause, words in _CAUSES.items():
        if name.startswith("actuator_") and name.endswith(f"_{cause}"):
            number = name.removeprefix("actuator_").removesuffix(f"_{cause}")
            return words.format(number)
    return PART_NAMES[name]


@overload
def error_of_test(
    recording: Recording,
    question: Question,
    *,
    known_offsets: Collection[int] = ...,
    left_by_repairs: Mapping[str, float] | None = ...,
) -> ErrorOfTest: ...
@overload
def error_of_test(
    recording: CoupledRecording,
    question: Question,
    *,
    known_offsets: Collection[int] = ...,
    left_by_repairs: Mapping[str, float] | None = ...,
) -> ErrorOfSeveral: ...


def error_of_test(
    recording: Recording | CoupledRecording,
    question: Question,
    *,
    known_offsets: Collection[int] = (),
    left_by_repairs: Mapping[str, float] | None = None,
) -> ErrorOfTest | ErrorOfSeveral:
    """Compute the error of a test.

    `known_offsets`: places of the actuators whose sensors have no offset; `left_by_repairs`: what repairs of
    the recording leave unknown.
    """
    recording = _true_channels(recording, question)
    structure, lag = question.rebuilt_structure(recording), question.feedback_lag
    require_lag(lag, recording.duration)
    readings = Readings.from_histories(
        recording.command,
        recording.measured,
        recording.time_step,
        structure,
        to_interface=question.to_interface if isinstance(recording, CoupledRecording) else None,
        ground=recording.ground if question.linear else None,
        force=_force_over_mass(recording, question),
        sensor_offsets=np.array([0.0 if k in known_offsets else np.nan for k in range(structure.degrees)]),
        resolution=question.resolution,
    )
    ground = _examine_ground(recording, question, readings)
    left_by_faults = {**_open_filter(recording, question), **(left_by_repairs or {})}
    circumstances = question.circumstances(readings.channels, ground, left_by_faults, structure)
    if isinstance(recording, CoupledRecording):
        inferred = infer_errors(circumstances, readings.stride, question.seed)
        return ErrorOfSeveral(
            rebuilt=readings.rebuilt_of_several(inferred),
            metric=question.metric,
            threshold=question.threshold,
            ground=ground,
        )
    rebuilt, specimen = _rebuild(recording, question, readings, circumstances)
    return ErrorOfTest(
        rebuilt=rebuilt,
        metric=question.metric,
        threshold=question.threshold,
        damping_ratio=question.structure.damping_ratio,
        ground=ground,
        specimen=specimen,
        modelled=question.model is not None,
    )


def _true_channels(
    recording: Recording | CoupledRecording, question: Question
) -> Recording | CoupledRecording:
    """Channels with the stated scale of the sensor, and the curves of large motions, taken away."""
    if isinstance(recording, Recording):
        scale = question.stated.get("scale", StatedValue(1.0)).value
        return replace(recording, measured=recording.measured / scale)
    if question.frame is None:
        raise AssertionError  # one mass has one actuator
    straighten = question.frame.straighten
    return replace(recording, command=straighten(recording.command), measured=straighten(recording.measured))


def _force_over_mass(recording: Recording | CoupledRecording, question: Question) -> Array | None:
    """Return the force of a linear specimen over the stated mass [N/kg]; None where one is not known."""
    if isinstance(recording, CoupledRecording) or recording.force is None:
        return None
    return recording.force / question.mass if question.linear and question.mass is not None else None


def _rebuild(
    recording: Recording, question: Question, readings: Readings, circumstances: Circumstances
) -> "tuple[RebuiltError, MeasuredSpecimen | None]":
    """Rebuild the error with the specimen as stated, modelled or learned."""
    if question.model is not None:
        from reliab.assessment.modelled_test import rebuild_modelled

        test, deviations = question.model.test, question.model.deviations
        return rebuild_modelled(readings, test, deviations, circumstances, seed=question.seed), None
    if question.measured_specimen:
        from reliab.assessment.measured_specimen.rebuild import rebuild_learned

        force, channel = recording.force, question.force_channel
        specimen = rebuild_learned(readings, force, channel, circumstances, seed=question.seed)
        return specimen.rebuilt, specimen
    return readings.rebuilt(infer_errors(circumstances, readings.stride, question.seed)), None


def _examine_ground(
    recording: Recording | CoupledRecording, question: Question, readings: Readings
) -> ShownGround:
    """Examine the recorded ground acceleration; of a measured specimen by its force."""
    if question.model is not None:
        return ShownGround()
    lag = question.feedback_lag
    if isinstance(recording, Recording) and not question.linear:
        return examine_ground_by_force(
            recording, question.full_structure, mass=question.mass or 1.0, feedback_lag=lag
        )
    return examine_ground(recording, readings.channels, question.full_structure, feedback_lag=lag)


def _open_filter(recording: Recording | CoupledRecording, question: Question) -> dict[str, float]:
    """Delay [s] of a filter that noise shows where no filter is stated, and the command may have passed."""
    is_stated = question.equipment.is_exact or "filter_delay" in question.stated
    if is_stated or question.frame is not None or isinstance(recording, CoupledRecording):
        return {}
    filtering = filter_of_noise(recording.command, recording.measured, recording.time_step)
    return {} if filtering is None else {"open_filter": filtering.delay}
