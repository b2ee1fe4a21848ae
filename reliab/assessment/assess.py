"""Judge a test by its command and measured displacement.

Every test goes the same way: its faults are found and repaired, the error follows from what is left and the
verdict from the error, and what the recording contradicts limits the verdict. What only a frame needs is in
`frame_test`.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from reliab.assessment.assessment import Assessment
from reliab.assessment.budget.sizes import Equipment, exact_equipment
from reliab.assessment.checks import CHECKS, doubts_of_columns, verdict_of_error
from reliab.assessment.conflicts import OwnEquation, compare_with_stated, looks_nonlinear
from reliab.assessment.default_criterion import criterion_of_test
from reliab.assessment.error_of_test import ErrorOfTest, Question
from reliab.assessment.faults import (
    Fault,
    error_with_faults,
    faults_of_channel,
    faults_of_force,
    repair_recording,
)
from reliab.assessment.inference.quantities import QUANTITIES
from reliab.assessment.judged_test import JudgedTest
from reliab.assessment.placement import place, place_by_response, scope_of_test
from reliab.assessment.plausibility import require_drawable, require_length, require_plausible
from reliab.assessment.recorded_force import ExaminedForce, require_stated_forces
from reliab.assessment.recorded_ground import mass_from_ground, require_unit_of_force
from reliab.assessment.tracking_index import TrackingIndex, measure_tracking, track, track_windows
from reliab.assessment.turning import examine_turning
from reliab.core.errors import InputError
from reliab.core.significant_digits import significant
from reliab.core.stated_value import StatedValue
from reliab.core.vocabulary import Metric
from reliab.criterion.criterion import Criterion
from reliab.recordings.behaviour import remove_spikes
from reliab.recordings.recording import Recording
from reliab.structures.structure import Structure

if TYPE_CHECKING:
    from reliab.assessment.frame_assessment import FrameAssessment
    from reliab.assessment.measured_specimen.force_channel import ForceChannel
    from reliab.assessment.own_motion import OwnPlacement
    from reliab.motions.motion import Motion
    from reliab.simulation.frames.frame_file import FrameUnderTest
    from reliab.simulation.hybrid_test.model_file import UpdatedModel

AnyAssessment: TypeAlias = "Assessment | FrameAssessment"

_LEARNED_NOTE = (
    "The recorded force is not that of a spring with a dashpot. The specimen was therefore learned from it, "
    "as with `specimen` measured. State it as linear if it was."
)
_ANY_RATIO = 0.86  # of a ratio that nobody stated, as of one that lies anywhere from 0.5 to 10 %
_ANY_MASS = 0.2  # standard deviation of a mass that nobody stated, over its rough estimate
_SMALL_MOTION = 0.02  # of the largest command: below it, faults of a channel cannot be told from coupling


def assess(
    recording: Recording,
    structure: "Structure | FrameUnderTest",
    *,
    stated: Mapping[str, StatedValue] | None = None,
    equipment: Equipment | None = None,
    motion: "Motion | None" = None,
    criterion: Criterion | None = None,
    threshold: float = 0.05,
    confidence: float = 0.95,
    metric: str = "rms",
    model: "UpdatedModel | None" = None,
    measured_specimen: bool = False,
    linear_specimen: bool = False,
    force_channel: "ForceChannel | None" = None,
    assumed: tuple[str, ...] = (),
    seed: int = 0,
) -> AnyAssessment:
    """Judge a test by its command and measured displacement.

    Parameters
    ----------
    recording : Recording
        The test; of a frame command and measured displacement at the interface, or those of several
        actuators.
    structure : Structure or FrameUnderTest
        The structure under test. The specimen of a frame must be linear, or with one actuator measured.
    stated : mapping of str to StatedValue, optional
        Tolerances of its frequency "f" [Hz], damping ratio "xi" and share "alpha", which the file of a frame
        states itself; the "scale" of the sensor of the measured displacement over that of the command [-],
        the time "feedback_lag" by which the force was fed back late [ms], and the deviations of what the
        recording was corrected for.
    equipment : Equipment, optional
        What a laboratory does not know where the test states nothing, `ordinary_equipment()` for one as many
        are. By default everything is taken to be exact: channels, structure and specimen.
    motion : Motion, optional
        Its ground motion; the index is then that of this motion's own boundary, exact by simulation, over
        the part of the record that the test saw, as the error of the test is. Errors of floors and storeys
        of a frame are stated over their peaks under it, by default under the recorded ground acceleration.
    criterion : Criterion, optional
        The criterion; by default the one that ships with the package, for the threshold, metric and
        confidence given and for tests of this length, and none for a frame. A given criterion has its own
        threshold, metric and confidence; that of a frame must be derived for it, with one actuator.
    threshold : float, optional
        Error of the whole test [-].
    confidence : float, optional
        Share of the population's ground motions.
    metric : str, optional
        Which error, "rms" or "mte".
    model : UpdatedModel, optional
        Calibrated model of a nonlinear specimen, as `reliab diagnose` writes it; not for frames.
    measured_specimen : bool, optional
        Whether the specimen is known by its recorded force only: what it does is learned from the test
        itself, with the "mass" among what is stated; f and ξ then set the numerical substructure, or all of
        the frame but its specimen.
    linear_specimen : bool, optional
        Whether somebody states that the specimen is linear. Where nobody does and no force was recorded, the
        answer says what the error would be if it had yielded, which can withhold "reliable".
    force_channel : ForceChannel, optional
        What the recorded force of a measured specimen contains besides that of the specimen.
    assumed : tuple of str, optional
        Sentences saying that no damping ratio was stated and which one is assumed; repeated among the
        warnings. The interval then allows for any ratio from 0.5 to 10 %, as far as the channels do not show
        it.
    seed : int, optional
        Seed of the draws.

    Returns
    -------
    Assessment or FrameAssessment
        Error of the test with its interval, verdict, A and d, stability margin, and of one mass the index and
        what to improve first.

    Raises
    ------
    InputError
        If the test is too short or too long, sampled too coarsely, has two units or signs, the measured
        displacement does not follow the command, recording, criterion or what is asked do not fit the
        structure, or the specimen of a frame is nonlinear and not measured.
    """
    question = Question(
        structure=structure if isinstance(structure, Structure) else structure.governing_mode,
        stated=dict(stated or {}),
        equipment=equipment or exact_equipment(),
        metric=Metric(metric if criterion is None else criterion.metric),
        threshold=threshold if criterion is None else criterion.threshold,
        model=model,
        measured_specimen=measured_specimen,
        linear_specimen=linear_specimen,
        force_channel=force_channel,
        seed=seed,
        frame=None if isinstance(structure, Structure) else structure,
    )
    if question.frame is not None:
        from reliab.assessment.frame_test import fit_to_frame

        recording, question = fit_to_frame(recording, question, criterion)
    recording, question, faults = _set_force_aside(recording, question)
    stated_values, question = question.stated, _estimate_mass(recording, question)
    if _shows_nonlinear_specimen(recording, question):
        question = replace(question, measured_specimen=True)
    examined_force = _require_judgeable(recording, replace(question, stated=stated_values))
    if criterion is None and question.frame is None:
        arguments = question.structure.frequency, question.structure.damping_ratio, threshold, confidence
        criterion = criterion_of_test(*arguments, metric=metric, duration=recording.duration)
    judged = _judge(recording, question, faults, criterion, motion, has_damping=not assumed)
    question, assumed = _adopt_identified_values(
        judged, assumed, is_mass_open=len(question.stated) > len(stated_values)
    )
    judged = replace(judged, question=question, examined_force=examined_force)
    if question.measured_specimen and not measured_specimen:
        assumed = (*assumed, _LEARNED_NOTE)
    if question.frame is None:
        assessment: AnyAssessment = _conclude_mass(judged, assumed)
    else:
        from reliab.assessment.frame_test import conclude_frame

        assessment = conclude_frame(judged)
    return assessment.add_doubts(doubt for check in CHECKS for doubt in check(assessment))


def _set_force_aside(
    recording: Recording, question: Question
) -> tuple[Recording, Question, tuple[Fault, ...]]:
    """Take a force that stood still out of a test, and give its faults."""
    faults = tuple(faults_of_force(recording))
    if not faults:
        return recording, question, ()
    if question.measured_specimen:
        sentence = faults[0].sentence
        raise InputError(
            "A specimen cannot be learned from a force that stood still",
            value=f"that {sentence[:1].lower()}{sentence[1:].rstrip('.')}",
            remedy="Export the force again, or state the specimen as linear",
            where=recording.name,
        )
    return replace(recording, force=None), replace(question, ignores_force=True), faults


def _shows_nonlinear_specimen(recording: Recording, question: Question) -> bool:
    """Whether a specimen of which nothing is stated, and which can be learned, is nonlinear by its force."""
    is_settled = question.linear_specimen or question.equipment.is_exact or recording.has_several
    is_open, frame = question.linear and not is_settled, question.frame
    has_masses = "mass" in question.stated if frame is None else not frame.partition.specimen_mass.any()
    if not is_open or not has_masses or recording.force is None:
        return False
    return bool(looks_nonlinear(remove_spikes(recording)[0], question.structure))


def _require_judgeable(recording: Recording, question: Question) -> ExaminedForce | None:
    """Refuse a recording that cannot be that of the test; return its only force as it was examined."""
    examined = None
    require_length(recording, question.structure.frequency)
    require_drawable(recording, question.full_structure)
    stiffness = question.full_structure.specimen_stiffness
    for number, channel in _moving_channels(recording):
        own_stiffness = float(stiffness[number, number]) if question.has_masses else None
        examined = require_plausible(channel, stiffness=own_stiffness, linear=question.linear)
    if recording.has_several:
        require_stated_forces(recording, question.full_structure, question.to_interface)
    if question.frame is None and question.mass is not None and question.linear:
        require_unit_of_force(
            recording, question.structure, mass=question.mass, feedback_lag=question.feedback_lag
        )
    for quantity in QUANTITIES:
        quantity.require_possible(quantity.stated_deviation(question.stated))
    return None if recording.has_several else examined


def _moving_channels(recording: Recording) -> Iterator[tuple[int, Recording]]:
    """Give the channels of all actuators that move, each with its place."""
    ranges = np.ptp(np.atleast_2d(recording.command), axis=1)
    for number in np.flatnonzero(ranges > _SMALL_MOTION * ranges.max()).tolist():
        yield number, recording.select_actuator(number)


def _find_faults(recording: Recording, question: Question) -> tuple[tuple[Fault, ...], TrackingIndex | None]:
    """Find the faults of all channels, and how an only actuator tracked but for its spikes."""
    shares = question.full_structure.shares_at_sensors(question.to_interface)
    faults: list[Fault] = []
    tracking = None
    for number, channel in _moving_channels(recording):
        found, tracking = faults_of_channel(
            channel,
            threshold=question.threshold,
            experimental_fraction=float(shares[number]),
            seed=question.seed,
        )
        if recording.has_several:
            found = tuple(fault.assign_actuator(number, recording) for fault in found)
        faults += found
    return tuple(faults), None if recording.has_several else tracking


def _judge(
    recording: Recording,
    question: Question,
    known_faults: tuple[Fault, ...],
    criterion: Criterion | None,
    motion: "Motion | None",
    *,
    has_damping: bool,
) -> JudgedTest:
    """Judge a test by its error, and examine what its recording shows of the structure.

    `known_faults`: those of its force; `has_damping`: whether a damping ratio was stated.
    """
    faults, tracking = _find_faults(recording, question)
    faults = known_faults + faults
    sound = repair_recording(recording, faults)
    if tracking is not None and faults:
        tracking = track(sound, seed=question.seed)
    asked = question if has_damping else _broaden_damping(question)
    nonlinear = looks_nonlinear(sound, question.structure) if question.linear else ""
    asked = replace(asked, ignores_force=asked.ignores_force or bool(nonlinear))
    error, effects = error_with_faults(recording, faults, asked)
    equation = OwnEquation(notes=error.ground.notes, doubts=error.ground.doubts)
    if (posterior := error.posterior) is not None:
        structure = question.structure
        equation = compare_with_stated(posterior, structure, error.ground, asked.stated, nonlinear=nonlinear)
    return JudgedTest(
        recording=recording,
        sound=sound,
        question=question,
        criterion=criterion,
        motion=motion,
        tracking=tracking,
        error=error,
        faults=effects,
        equation=equation,
        turning=examine_turning(error, recording, question),
        column_doubts=() if tracking is None else tuple(doubts_of_columns(recording, tracking)),
        judgement=verdict_of_error(error),
    )


def _conclude_mass(judged: JudgedTest, assumed: tuple[str, ...]) -> Assessment:
    """Place a test of one mass in the (A, d) plane, and put together what was found."""
    sound, error, question, tracking = judged.sound, judged.error, judged.question, judged.tracking
    criterion, structure = judged.criterion, judged.question.structure
    if tracking is None or criterion is None:
        raise AssertionError  # one mass has one actuator
    if judged.motion is not None:
        judged = replace(judged, placement=_place_test(judged.motion, sound, tracking, error, question))
    return Assessment(
        **vars(judged),
        measures=measure_tracking(sound),
        windows=track_windows(sound, tracking),
        population=place(criterion, structure, tracking.amplitude, tracking.delay, tracking.draws),
        scope=scope_of_test(criterion, sound, structure, error.reference),
        by_response=place_by_response(sound, question, error.reference, criterion, tracking),
        assumed=assumed,
    )


def _place_test(
    motion: "Motion", sound: Recording, tracking: TrackingIndex, error: ErrorOfTest, question: Question
) -> "OwnPlacement":
    """Place the test against the boundary of its own ground motion."""
    from reliab.assessment.alignment import align
    from reliab.assessment.own_motion import place_on_own

    alignment = align(sound, error.reference, question.structure, motion)
    return place_on_own(motion, tracking, alignment, question)


def _estimate_mass(recording: Recording, question: Question) -> Question:
    """Estimate a mass that nobody stated from force and ground acceleration, roughly."""
    if question.frame is not None or question.model is not None or question.mass is not None:
        return question
    mass = mass_from_ground(recording, question.structure, feedback_lag=question.feedback_lag)
    if mass is None:
        return question
    return replace(question, stated={**question.stated, "mass": StatedValue(mass, _ANY_MASS * mass)})


def _adopt_identified_values(
    judged: JudgedTest, assumed: tuple[str, ...], *, is_mass_open: bool
) -> tuple[Question, tuple[str, ...]]:
    """Adopt the damping ratio and the mass that were identified where nobody stated them, and say so.

    `assumed`: that no damping ratio was stated; `is_mass_open`: whether the mass was not stated, which only a
    force that was used identifies.
    """
    question, error = judged.question, judged.error
    stated, inferred = dict(question.stated), error.rebuilt.inferred.posterior
    if assumed and error.posterior is not None:
        ratio = error.posterior.identified_value("damping_ratio", question.structure.damping_ratio)
        question = replace(question, structure=replace(question.structure, damping_ratio=ratio.value))
        stated["xi"] = ratio
        sentence = (
            f"No damping ratio was stated; the recording shows {significant(ratio.value, 2)} ± "
            f"{significant(ratio.deviation, 1)}, where any from 0.005 to 0.1 was possible."
        )
        assumed = (sentence,)
    if is_mass_open and not inferred.circumstances.specimen_force:
        del stated["mass"]
    elif is_mass_open:
        stated["mass"] = mass = inferred.identified_value("mass", stated["mass"].value)
        sentence = (
            "No mass was stated; the recorded force and ground acceleration show "
            f"{significant(mass.value, 4)} ± {significant(mass.deviation, 1)} kg."
        )
        assumed = (*assumed, sentence)
    return replace(question, stated=stated), assumed


def _broaden_damping(question: Question) -> Question:
    """Take a damping ratio that nobody stated as one that lies anywhere from 0.5 to 10 %."""
    ratio = question.structure.damping_ratio
    return replace(question, stated={**question.stated, "xi": StatedValue(ratio, _ANY_RATIO * ratio)})
