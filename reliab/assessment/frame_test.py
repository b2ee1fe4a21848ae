"""The verdict on a test of a partitioned frame: its own error, faults of the recording, stability margin."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import partial

import numpy as np

from reliab.assessment.alignment import factor_of_ground
from reliab.assessment.budget.sizes import Equipment, Size, Source, exact_equipment, tolerances_of
from reliab.assessment.conflicts import find_conflicts
from reliab.assessment.contradictions import (
    Contradiction,
    contradict_frequency,
    contradict_ground,
    contradict_specimen,
    contradict_stability,
)
from reliab.assessment.doubts import doubt_entries, doubt_rest, verdict_of_error
from reliab.assessment.error_of_test import ErrorOfTest, Question
from reliab.assessment.error_with_threshold import ErrorOfSeveral, ErrorWithThreshold
from reliab.assessment.exact_response import exact_test
from reliab.assessment.fault_effects import FaultEffect, error_of_one_with_faults, error_with_faults
from reliab.assessment.faults import Fault, faults_of_channel, repair_recording
from reliab.assessment.frame_assessment import CoupledAssessment, FrameAssessment
from reliab.assessment.frame_responses import ResponseErrors, errors_of_responses
from reliab.assessment.measured_specimen.force_channel import ForceChannel
from reliab.assessment.placement import place
from reliab.assessment.plausibility import require_drawable, require_length, require_plausible
from reliab.assessment.rebuilt_error.parts import Part
from reliab.assessment.recorded_ground import require_unit_of_ground
from reliab.assessment.tracking_index import track
from reliab.assessment.turning import examine_turning
from reliab.assessment.verdict import Verdict
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.stated_value import StatedValue
from reliab.core.vocabulary import Metric
from reliab.criterion.criterion import Criterion
from reliab.motions.motion import Motion
from reliab.recordings.coupled_recording import CoupledRecording
from reliab.recordings.recording import Recording
from reliab.simulation.frames.frame_file import FrameUnderTest
from reliab.simulation.frames.governing_mode import governing_mode
from reliab.structures.critical_delay import StabilityLimit, stability_limit
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure
from reliab.tracking.indices.frequency_evaluation import TrackingOverFrequency, tracking_over_frequency

_DRAWS_AS_STATED = 64
_SAME_SHARE = 1e-3
_LEAST_SHARE = 1e-6
_SMALL_MOTION = 0.02  # of the largest command: below it, faults of a channel cannot be told from coupling


def assess_frame(
    recording: Recording | CoupledRecording,
    frame: FrameUnderTest,
    *,
    criterion: Criterion | None = None,
    threshold: float = 0.05,
    metric: Metric = Metric.RMS,
    stated: Mapping[str, StatedValue] | None = None,
    equipment: Equipment | None = None,
    linear_specimen: bool = False,
    motion: Motion | None = None,
    measured_specimen: bool = False,
    force_channel: ForceChannel | None = None,
) -> FrameAssessment | CoupledAssessment:
    """Judge a test of a partitioned frame by the error computed from its displacements.

    Parameters
    ----------
    recording : Recording or CoupledRecording
        Command and measured displacement at the interface, or those of several actuators.
    frame : FrameUnderTest
        The frame; its specimen must be linear, or with one actuator measured.
    criterion : Criterion, optional
        A criterion that was derived for this frame with one actuator. Its threshold and metric are used, and
        the test's index is stated beside the error.
    threshold : float, optional
        Largest error of a reliable test [-].
    metric : Metric, optional
        Which error.
    stated : mapping of str to StatedValue, optional
        Time "feedback_lag" by which the force was fed back late [ms], "scale" of the displacement sensors
        [-], and the deviations of what the recording was corrected for.
    equipment : Equipment, optional
        What is not known where neither the frame's tolerances nor `stated` have it; by default all that is
        exact.
    linear_specimen : bool, optional
        Whether somebody stated that the specimen stayed linear. Where nobody did and no force was recorded,
        it may have yielded, with the probability that `equipment` states.
    motion : Motion, optional
        Ground motion of the test, by which the errors of floors and storeys are stated over their own peaks;
        by default the recorded one, where the test has it.
    measured_specimen : bool, optional
        Whether the specimen is known by its recorded force only: what it does is learned from the test
        itself, and the frame without its specimen is what the computer simulates.
    force_channel : ForceChannel, optional
        What the recorded force of a measured specimen contains besides that of the specimen.

    Returns
    -------
    FrameAssessment or CoupledAssessment
        A, d, the stability margin, the error with its interval, faults of the recording, and the verdict.

    Raises
    ------
    InputError
        If the specimen is nonlinear and not measured, or measured and has a mass of its own, the error asked
        for is not that of the interface, the criterion is for another structure, the recording does not fit
        the frame or cannot be judged, or something is asked of several actuators that only one has.
    """
    require_answerable(
        frame,
        criterion=criterion is not None,
        specimen=measured_specimen or linear_specimen,
        force_channel=force_channel is not None,
        measured_specimen=measured_specimen,
    )
    stated = stated or {}
    mode = _mode_of_sizes(frame)
    if criterion is not None:
        _check_criterion(criterion, mode)
        threshold, metric = criterion.threshold, Metric(criterion.metric)
    scale = stated.get("scale", StatedValue(1.0))
    recording = replace(recording, measured=recording.measured / scale.value)
    question = Question(
        structure=mode,
        stated={**stated, "scale": StatedValue(1.0, scale.deviation / abs(scale.value))},
        equipment=equipment or exact_equipment(),
        metric=metric,
        threshold=threshold,
        linear_specimen=linear_specimen,
        measured_specimen=measured_specimen,
        force_channel=force_channel,
        frame=frame,
    )
    if isinstance(recording, CoupledRecording):
        return _assess_several(_order_channels(recording, frame), frame, question, motion)
    if frame.has_several:
        frame.order_of_channels(("",), recording.name)
    return _assess_one(recording, frame, question, criterion, motion)


def _assess_one(
    recording: Recording,
    frame: FrameUnderTest,
    question: Question,
    criterion: Criterion | None,
    motion: Motion | None,
) -> FrameAssessment:
    mode, partition = question.structure, frame.partition
    require_length(recording, mode.frequency)
    require_drawable(recording, partition)
    faults = tuple(_faults(recording, frame, question.threshold, linear=question.linear))
    error, effects = error_of_one_with_faults(recording, faults, question)
    sound = repair_recording(recording, faults)
    tracking, tracking_by_frequency = track(sound), _track_over_frequency(sound)
    turning = examine_turning(error, recording, question)
    responses = _responses(error, recording, question, motion)
    assessment = FrameAssessment(
        recording=recording,
        frame=frame,
        mode=mode,
        tracking=tracking,
        over_frequency=tracking_by_frequency,
        error=error,
        resolved=_part_of_tracking(sound, tracking_by_frequency, error),
        responses=responses,
        faults=effects,
        judgement=turning.limit(_verdict(error, effects, sound)),
        turning=turning,
        limit=stability_limit(partition, tracking.amplitude),
        criterion=criterion,
        population=None
        if criterion is None
        else place(criterion, mode, tracking.amplitude, tracking.delay, tracking.draws),
    )
    specimen, frequencies = error.specimen, [mode_of_test.frequency for mode_of_test in assessment.modes]
    return assessment.add_contradictions(
        *(contradict_frequency(sound, tracking, frequencies) if specimen is None else ()),
        *_contradict_structure(error, question, recording.time_step),
        *contradict_stability(assessment.stability_margin),
        *contradict_specimen(specimen),
    )


def _assess_several(
    recording: CoupledRecording, frame: FrameUnderTest, question: Question, motion: Motion | None
) -> CoupledAssessment:
    partition, carry = frame.partition, frame.to_interface
    require_length(recording, question.structure.frequency)
    faults = tuple(_faults(recording, frame, question.threshold))
    error, effects = error_with_faults(
        recording,
        faults,
        lambda test, sensors, repairs: _error_of_several(test, frame, question, sensors, repairs),
    )
    limit, gain_margin = _limit(partition, carry @ error.parts.gain @ np.linalg.inv(carry))
    assessment = CoupledAssessment(
        recording=recording,
        frame=frame,
        error=error,
        responses=_responses(error, recording, question, motion),
        faults=effects,
        judgement=_verdict(error, effects, repair_recording(recording, faults)),
        turning=examine_turning(error, recording, question),
        limit=limit,
        limit_of_gains=gain_margin,
        shown_by_ground=error.shown_by_ground,
    )
    return assessment.add_contradictions(
        *_contradict_structure(error, question, recording.time_step),
        *contradict_stability(assessment.stability_margin),
    )


def _contradict_structure(
    error: ErrorWithThreshold, question: Question, time_step: float
) -> Iterator[Contradiction]:
    """Say where the channels contradict the structure as stated; `time_step` [s]."""
    if error.inferred is None or question.equipment.is_exact:
        yield from contradict_ground(
            error.shown_by_ground, question.sizes(time_step), question.full_structure
        )
    if error.inferred is not None:
        conflicts = find_conflicts(error.inferred.posterior, question.structure, question.stated)
        yield from (conflict for conflict in conflicts if conflict.remedy)


def _responses(
    error: ErrorWithThreshold,
    recording: Recording | CoupledRecording,
    question: Question,
    motion: Motion | None,
) -> ResponseErrors:
    degrees = question.full_structure.degrees_of_freedom
    force_known = not (isinstance(recording, Recording) and question.may_have_yielded(recording))
    responses = errors_of_responses(error, degrees, recording.ground, motion, force_known=force_known)
    if motion is None and recording.ground is not None:
        exact = exact_test(error, degrees, recording.ground)
        require_unit_of_ground(recording, factor_of_ground(exact))
    return responses


def _verdict(
    error: ErrorWithThreshold, effects: tuple[FaultEffect, ...], sound: Recording | CoupledRecording
) -> Verdict:
    return doubt_rest(doubt_entries(verdict_of_error(error, effects), error), error, sound)


def _faults(
    recording: Recording | CoupledRecording, frame: FrameUnderTest, threshold: float, *, linear: bool = True
) -> Iterator[Fault]:
    """Find the faults of each channel; those that hardly move have none."""
    shares = frame.partition.shares_at_sensors(frame.to_interface)
    for number, channel in _channels(recording):
        stiffness = float(frame.partition.specimen_stiffness[number, number])
        require_plausible(channel, stiffness=stiffness, linear=linear)
        share = float(shares[number])
        faults, _ = faults_of_channel(channel, threshold=threshold, experimental_fraction=share)
        if isinstance(recording, CoupledRecording):
            faults = tuple(fault.assign_actuator(number, recording) for fault in faults)
        yield from faults


def _channels(recording: Recording | CoupledRecording) -> Iterator[tuple[int, Recording]]:
    """Give the recordings of all actuators that move, each with its place."""
    if isinstance(recording, Recording):
        yield 0, recording
        return
    ranges = np.ptp(recording.command, axis=1)
    for number in np.flatnonzero(ranges > _SMALL_MOTION * ranges.max()).tolist():
        yield number, recording.select_actuator(number)


def _track_over_frequency(recording: Recording) -> TrackingOverFrequency | None:
    try:
        return tracking_over_frequency(recording.command, recording.measured, recording.time_step)
    except InputError:
        return None


def _part_of_tracking(
    recording: Recording, tracking_by_frequency: TrackingOverFrequency | None, error: ErrorOfTest
) -> Part | None:
    if tracking_by_frequency is None:
        return None
    return error.part_of_tracking(tracking_by_frequency.follow(recording.command, recording.time_step))


def _error_of_several(
    test: CoupledRecording,
    frame: FrameUnderTest,
    question: Question,
    sensors: frozenset[int],
    repairs: Mapping[str, Size],
) -> ErrorOfSeveral:
    """Rebuild the errors of all interface displacements; see `error_with_faults`."""
    from reliab.assessment.coupled_error.ground_motion import compare_with_ground
    from reliab.assessment.coupled_error.posterior_errors import infer_coupled
    from reliab.assessment.coupled_error.rebuild import rebuild_coupled

    sizes = {**question.sizes(test.time_step), **repairs}
    command, measured_displacement = frame.straighten(test.command), frame.straighten(test.measured)
    rebuild = partial(
        rebuild_coupled,
        command,
        measured_displacement,
        test.time_step,
        frame.partition,
        to_interface=frame.to_interface,
        feedback_lag=question.feedback_lag,
        sensor_offsets=np.array([0.0 if place in sensors else np.nan for place in range(len(test.command))]),
    )
    combine = partial(ErrorOfSeveral, metric=question.metric, threshold=question.threshold)
    ground_fit = None
    if test.ground is not None:
        nominal_error = rebuild(draws=_DRAWS_AS_STATED)
        ground_fit = compare_with_ground(nominal_error.histories, nominal_error.reduced, test.ground)
        if ground_fit is not None and not ground_fit.is_other_motion:
            inference = infer_coupled(
                nominal_error,
                command,
                measured_displacement,
                ground_fit.evidence(test.ground),
                stated=question.stated,
                equipment=question.equipment,
                tolerances=question.tolerances,
                left_by_faults={name: size.deviation for name, size in repairs.items()},
            )
            if inference is not None:
                error, inferred_error = inference
                return combine(
                    rebuilt=error, sizes=sizes, inferred=inferred_error, shown_by_ground=ground_fit
                )
    error = rebuild(tolerances=tolerances_of(sizes))
    if (own_frequency := error.unknown.own_frequency) is not None:
        sizes["frequency"] = Size(deviation=own_frequency.deviation, source=Source.LEARNED)
    return combine(rebuilt=error, sizes=sizes, shown_by_ground=ground_fit)


def _limit(partition: Partition, gains: Array) -> tuple[StabilityLimit, bool]:
    """Where the test becomes unstable with the measured gains; with exact ones where it would be at once."""
    try:
        return stability_limit(partition, gains), True
    except InputError:
        return stability_limit(partition), False


def _mode_of_sizes(frame: FrameUnderTest) -> Structure:
    """Mode that governs the error; of several actuators the lowest one."""
    if not frame.has_several:
        return governing_mode(frame.partition, frame.output)
    return frame.partition.lowest_mode


def _order_channels(recording: CoupledRecording, frame: FrameUnderTest) -> CoupledRecording:
    """Put channels that have the names of the degrees of freedom into their order."""
    order = frame.order_of_channels(recording.actuators, recording.name)
    return replace(
        recording,
        command=recording.command[order],
        measured=recording.measured[order],
        actuators=tuple(recording.actuators[place] for place in order),
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
