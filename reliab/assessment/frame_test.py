"""The verdict on a test of a partitioned frame: its own error, faults of the recording, stability margin."""

import math
from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from reliab.assessment.budget import (
    Equipment,
    Size,
    sizes_of_structure,
    tolerances_of,
)
from reliab.assessment.contradictions import limited, of_frequency, of_specimen, of_stability
from reliab.assessment.doubts import doubted_by_entries, verdict_of_error
from reliab.assessment.error_of_test import (
    ErrorOfTest,
    Question,
    sizes_of_force,
    specimen_from_force,
    that_may_have_yielded,
    with_learned,
)
from reliab.assessment.exact_response import exact_test_of_one
from reliab.assessment.fault_effects import error_with_faults
from reliab.assessment.faults import find_faults, repaired
from reliab.assessment.findings import FaultEffect
from reliab.assessment.frame_assessment import FrameAssessment
from reliab.assessment.frame_responses import errors_of_responses
from reliab.assessment.measured_specimen import ForceChannel
from reliab.assessment.own_equation import OwnEquation
from reliab.assessment.placement import place
from reliab.assessment.plausibility import require_drawable, require_length, require_plausible
from reliab.assessment.rebuilt_error import Part, rebuild
from reliab.assessment.tracking_index import track
from reliab.assessment.turning import examine_turning
from reliab.assessment.verdict import Verdict
from reliab.criterion import Criterion
from reliab.errors import InputError
from reliab.indices import TrackingOverFrequency
from reliab.indices.tracking_over_frequency import tracking_over_frequency
from reliab.motions import Motion
from reliab.recordings import Recording, without_spikes
from reliab.simulation.frames import FrameUnderTest, governing_mode
from reliab.stated_value import StatedValue
from reliab.structures import Structure, stability_limit
from reliab.vocabulary import Metric

_FEW_DRAWS = 2
_SAME_SHARE = 1e-3


def assess_frame(
    recording: Recording,
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
) -> FrameAssessment:
    """Judge a test of a partitioned frame by the error computed from its displacements.

    Parameters
    ----------
    recording : Recording
        Command and measured displacement at the interface.
    frame : FrameUnderTest
        The frame; its specimen must be linear, or measured.
    criterion : Criterion, optional
        A criterion that was derived for this frame. Its threshold and metric are used, and the test's index
        is stated beside the error.
    threshold : float, optional
        Largest error of a reliable test [-].
    metric : Metric, optional
        Which error.
    stated : mapping of str to StatedValue, optional
        Time "feedback_lag" by which the force was fed back late [ms], "scale" of the displacement sensor [-],
        and the deviations of what the recording was corrected for.
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
        What the recorded force of a measured specimen holds beside that of the specimen.

    Returns
    -------
    FrameAssessment
        A, d, the stability margin, the error with its interval, faults of the recording, and the verdict.

    Raises
    ------
    InputError
        If the specimen is nonlinear and not measured, or measured and has a mass of its own, the error asked
        for is not that of the interface, the criterion is for another structure, or the recording cannot be
        judged.
    """
    require_linear_interface(frame, measured=measured_specimen)
    stated = stated or {}
    mode = governing_mode(frame.partition, frame.output)
    if criterion is not None:
        _check_criterion(criterion, mode)
        threshold, metric = criterion.threshold, Metric(criterion.metric)
    if "scale" in stated:
        recording = replace(recording, measured=recording.measured / stated["scale"].value)
    question = Question(
        structure=mode,
        stated=stated,
        equipment=equipment,
        metric=metric,
        threshold=threshold,
        linear_specimen=linear_specimen,
        measured_specimen=measured_specimen,
        force_channel=force_channel,
    )
    return _examined(recording, frame, question, criterion, motion)


def _examined(
    recording: Recording,
    frame: FrameUnderTest,
    question: Question,
    criterion: Criterion | None,
    motion: Motion | None,
) -> FrameAssessment:
    mode = question.structure
    require_length(recording, mode.frequency)
    require_drawable(recording, frame.partition)
    require_plausible(recording, stiffness=frame.partition.specimen.stiffness)
    bridged, *_ = without_spikes(recording)
    faults = find_faults(
        recording,
        track(bridged, draws=_FEW_DRAWS),
        threshold=question.threshold,
        experimental_fraction=float(frame.partition.shares_at_sensors(np.eye(1))[0]),
    )
    rebuilt = _rebuilding(frame, question)
    error, effects = error_with_faults(recording, faults, rebuilt)
    sound = repaired(recording, faults)
    tracking, over_frequency = track(sound), _over_frequency(sound)
    turning = examine_turning(error, recording, question)
    assessment = FrameAssessment(
        recording=recording,
        frame=frame,
        mode=mode,
        tracking=tracking,
        over_frequency=over_frequency,
        error=error,
        resolved=_resolved(sound, over_frequency, error),
        responses=errors_of_responses(
            exact_test_of_one(error, frame.partition.frame.names, recording.ground), motion, error
        ),
        faults=effects,
        verdict=turning.limit(_verdict(error, effects)),
        turning=turning,
        critical_delay=stability_limit(frame.partition, tracking.amplitude).delay,
        criterion=criterion,
        population=None
        if criterion is None
        else place(criterion, mode, tracking.amplitude, tracking.delay, tracking.draws),
    )
    return _with_contradictions(assessment, sound)


def _verdict(error: ErrorOfTest, effects: tuple[FaultEffect, ...]) -> Verdict:
    verdict = verdict_of_error(error, effects, OwnEquation(), ())
    return doubted_by_entries(
        verdict,
        error.sizes,
        error.rebuilt.draws.errors(error.metric),
        error.threshold,
        learned=error.rebuilt.unknown.own_frequency is not None,
    )


def _with_contradictions(assessment: FrameAssessment, sound: Recording) -> FrameAssessment:
    """Add where the recording contradicts what is stated, which limits the verdict."""
    specimen = assessment.error.specimen
    frequencies = [mode.frequency for mode in assessment.modes]
    contradictions = (
        *(of_frequency(sound, assessment.tracking, frequencies) if specimen is None else ()),
        *of_stability(assessment.stability_margin),
        *of_specimen(specimen),
    )
    return replace(
        assessment, contradictions=contradictions, verdict=limited(assessment.verdict, contradictions)
    )


def _over_frequency(recording: Recording) -> TrackingOverFrequency | None:
    try:
        return tracking_over_frequency(recording.command, recording.measured, recording.time_step)
    except InputError:
        return None


def _resolved(
    recording: Recording, over_frequency: TrackingOverFrequency | None, error: ErrorOfTest
) -> Part | None:
    if over_frequency is None:
        return None
    return error.part_of_tracking(over_frequency.follow(recording.command, recording.time_step))


def _rebuilding(
    frame: FrameUnderTest, question: Question
) -> Callable[[Recording, float | None, Mapping[str, Size]], ErrorOfTest]:
    """Give the function that rebuilds the error of a recording whose sensor has a stated offset [m]."""
    structure, of_structure = frame.partition, sizes_of_structure(frame)

    def rebuilt(test: Recording, offset: float | None, left: Mapping[str, Size]) -> ErrorOfTest:
        sizes = {**question.sizes(test.time_step), **of_structure, **left}
        tolerances, specimen = tolerances_of(sizes), None
        if question.measured_specimen:
            specimen = specimen_from_force(
                test, test.measured, question, structure, sensor_offset=offset, tolerances=tolerances
            )
            error = specimen.rebuilt
        else:
            error = rebuild(
                test.command,
                test.measured,
                test.time_step,
                structure,
                feedback_lag=question.feedback_lag,
                sensor_offset=offset,
                tolerances=tolerances,
            )
        of_test = ErrorOfTest(
            rebuilt=error,
            metric=question.metric,
            threshold=question.threshold,
            damping_ratio=question.structure.damping_ratio,
            sizes=with_learned(sizes, error.unknown.own_frequency) | sizes_of_force(specimen),
            specimen=specimen,
        )
        return that_may_have_yielded(of_test, question.yielding(test))

    return rebuilt


def require_linear_interface(frame: FrameUnderTest, *, measured: bool = False) -> None:
    """Refuse frames whose error cannot be rebuilt: of a nonlinear specimen, or of another response.

    `measured`: whether the specimen is learned from its force, and may be nonlinear.
    """
    if measured and frame.partition.specimen.mass:
        raise InputError(
            "A measured specimen of a frame has no mass of its own",
            value=f"mass_kg = {frame.partition.specimen.mass:g}",
            remedy="Leave it out where the load cell does not feel it, or state the specimen as linear",
        )
    if frame.partition.effects and not measured:
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
