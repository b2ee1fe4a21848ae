"""What only a test of a frame needs: the order of its channels, what it cannot be asked, its floors."""

import math
from dataclasses import replace

import numpy as np

from reliab.assessment.error_of_test import ErrorOfTest, Question
from reliab.assessment.frame_assessment import FrameAssessment
from reliab.assessment.frame_responses import errors_of_responses
from reliab.assessment.judged_test import JudgedTest
from reliab.assessment.parts import ErrorPart
from reliab.assessment.placement import place
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.stated_value import StatedValue
from reliab.criterion.criterion import Criterion
from reliab.recordings.recording import Recording
from reliab.simulation.frames.frame_file import FrameUnderTest
from reliab.structures.critical_delay import StabilityLimit, stability_limit
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure
from reliab.tracking.indices.tracking import TrackingOverFrequency, tracking_over_frequency

_SAME_SHARE = 1e-3


def fit_to_frame(
    recording: Recording, question: Question, criterion: Criterion | None
) -> tuple[Recording, Question]:
    """Bring the channels of a test into the order and the scale of its frame, which they must fit."""
    frame = question.frame
    if frame is None:
        raise AssertionError  # one mass is no frame
    require_answerable(
        frame,
        criterion=criterion is not None,
        specimen=question.measured_specimen,
        force_channel=question.force_channel is not None,
        measured_specimen=question.measured_specimen,
    )
    if criterion is not None:
        _check_criterion(criterion, question.structure)
    scale = question.stated.get("scale", StatedValue(1.0))
    stated = {**question.stated, "scale": StatedValue(1.0, scale.deviation / abs(scale.value))}
    recording = replace(recording, measured=recording.measured / scale.value)
    if frame.has_several:
        recording = _order_channels(recording, frame)
    return recording, replace(question, stated=stated)


def conclude_frame(judged: JudgedTest) -> FrameAssessment:
    """Put together what was found about a test of a frame, with its floors and storeys."""
    question, error, tracking, criterion = judged.question, judged.error, judged.tracking, judged.criterion
    frame = question.frame
    if frame is None:
        raise AssertionError  # one mass is no frame
    carry = frame.to_interface
    gains = error.rebuilt.readings.tracking[0] if tracking is None else np.array([[tracking.amplitude]])
    limit, limit_of_gains = _limit(frame.partition, carry @ gains @ np.linalg.inv(carry))
    over_frequency = None if tracking is None else _track_over_frequency(judged.sound)
    degrees, may_yield = frame.partition.degrees_of_freedom, question.may_have_yielded(judged.recording)
    ground = error.ground.evidence(judged.recording.ground, needs_fit=not may_yield)
    return FrameAssessment(
        **vars(judged),
        responses=errors_of_responses(error, degrees, ground, judged.motion),
        limit=limit,
        limit_of_gains=limit_of_gains,
        over_frequency=over_frequency,
        resolved=_part_of_tracking(judged.sound, over_frequency, error),
        population=None
        if criterion is None or tracking is None
        else place(criterion, question.structure, tracking.amplitude, tracking.delay, tracking.draws),
    )


def _track_over_frequency(recording: Recording) -> TrackingOverFrequency | None:
    try:
        return tracking_over_frequency(recording.command, recording.measured, recording.time_step)
    except InputError:
        return None


def _part_of_tracking(
    recording: Recording, tracking_by_frequency: TrackingOverFrequency | None, error: ErrorOfTest
) -> ErrorPart | None:
    if tracking_by_frequency is None:
        return None
    return error.part_of_tracking(tracking_by_frequency.follow(recording.command, recording.time_step))


def _limit(partition: Partition, gains: Array) -> tuple[StabilityLimit, bool]:
    """Where the test becomes unstable with the measured gains; with exact ones where it would be at once."""
    try:
        return stability_limit(partition, gains), True
    except InputError:
        return stability_limit(partition), False


def _order_channels(recording: Recording, frame: FrameUnderTest) -> Recording:
    """Put channels that have the names of the degrees of freedom into their order."""
    order = frame.order_of_channels(recording.actuators, recording.name)
    return replace(
        recording,
        command=np.atleast_2d(recording.command)[order],
        measured=np.atleast_2d(recording.measured)[order],
        force=None if recording.force is None else np.atleast_2d(recording.force)[order],
        actuators=tuple(recording.actuators[place] or "1" for place in order),
    )


def require_answerable(frame: FrameUnderTest, *, measured_specimen: bool = False, **options: bool) -> None:
    """Refuse what a frame's test cannot be asked, by the names of the arguments of `reliab.assess`.

    `measured_specimen`: whether the specimen is learned from its force.
    """
    for name, is_asked in options.items():
        if is_asked and frame.has_several:
            raise InputError(
                f"`{name}` has no effect together with a `structure` with several actuators",
                remedy="Leave it out",
            )
    if not frame.has_several:
        require_linear_interface(frame, measured_specimen=measured_specimen)


def require_linear_interface(frame: FrameUnderTest, *, measured_specimen: bool = False) -> None:
    """Refuse frames whose error cannot be rebuilt: of a nonlinear specimen, or of another response.

    `measured_specimen`: whether the specimen is learned from its force, and may be nonlinear.
    """
    if measured_specimen and frame.partition.specimen.mass:
        raise InputError(
            "A measured specimen of a frame has no mass of its own",
            value=f"mass_kg = {frame.partition.specimen.mass:g}",
            remedy="Leave it out where the load cell does not feel it, or state the specimen as linear",
        )
    if frame.partition.effects and not measured_specimen:
        raise InputError(
            "The error of a frame is rebuilt for a linear specimen",
            value=", ".join(effect.name for effect in frame.partition.effects),
            remedy="State `specimen` as measured where its force was recorded, or leave [[specimen.effects]] "
            "out if the specimen is nearly linear",
        )
    if frame.output is not None:
        raise InputError(
            "Only the error of the measured interface displacement can be computed from a test",
            value=frame.error_of,
            remedy='Leave [error] out, or give of = "interface"',
        )


def _check_criterion(criterion: Criterion, mode: Structure) -> None:
    """Refuse a criterion that was derived with another share of the specimen than this frame's."""
    share = criterion.provenance.experimental_fraction
    if not math.isclose(share, mode.experimental_fraction, rel_tol=_SAME_SHARE):
        raise InputError(
            "The criterion of a frame's test must be that of the frame",
            value=f"α = {share:.4g} in the criterion, {mode.experimental_fraction:.4g} in the governing mode",
            remedy="Derive it with `reliab criterion --structure` and the same description of the frame",
        )
    criterion.limits(mode.frequency, mode.damping_ratio)
