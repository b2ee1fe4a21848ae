"""Judge a test by its command and measured displacement."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from reliab.assessment.assessment import Assessment
from reliab.assessment.budget.sizes import Equipment, exact_equipment, sizes_of_unknown, tolerances_of
from reliab.assessment.conflicts import damping_from_channels, find_conflicts, identify_structure
from reliab.assessment.contradictions import (
    contradict_columns,
    contradict_frequency,
    contradict_motion,
    contradict_specimen,
    contradict_stability,
)
from reliab.assessment.default_criterion import criterion_of_test
from reliab.assessment.doubts import doubt_rest, verdict_of_error
from reliab.assessment.error_of_test import ErrorOfTest, Question, error_of_test
from reliab.assessment.fault_effects import FaultEffect, error_of_one_with_faults
from reliab.assessment.faults import Fault, faults_of_channel, repair_recording
from reliab.assessment.inference.posterior import TestPosterior, favours_frequency
from reliab.assessment.own_equation import OwnEquation, compare_with_stated, looks_nonlinear
from reliab.assessment.placement import place
from reliab.assessment.plausibility import require_drawable, require_length, require_plausible
from reliab.assessment.recorded_force import stiffness_from_mass
from reliab.assessment.recorded_ground import ShownGround, examine_ground, require_unit_of_force
from reliab.assessment.scope_of_test import place_by_response, scope_of_test
from reliab.assessment.tracking_index import TrackingIndex, measure_tracking, track, track_windows
from reliab.assessment.turning import examine_turning
from reliab.assessment.verdict import word_of_probability
from reliab.core.significant_digits import significant
from reliab.core.stated_value import StatedValue
from reliab.core.vocabulary import MILLI, Metric
from reliab.criterion.criterion import Criterion
from reliab.recordings.recording import Recording
from reliab.recordings.spikes import remove_spikes
from reliab.structures.partition import whole_structure
from reliab.structures.structure import Structure

if TYPE_CHECKING:
    from reliab.assessment.measured_specimen.force_channel import ForceChannel
    from reliab.assessment.own_motion import OwnPlacement
    from reliab.motions.motion import Motion
    from reliab.simulation.hybrid_test.model_file import UpdatedModel

_LEARNED_NOTE = (
    "The recorded force is that of a nonlinear specimen, which was therefore learned from it, as with "
    "`specimen` measured. State it as linear if it was."
)
_ANY_RATIO = 0.86  # of a ratio that nobody stated, as of one that lies anywhere from 0.5 to 10 %


def assess(
    recording: Recording,
    structure: Structure,
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
    taper: str = "hann",
    seed: int = 0,
) -> Assessment:
    """Judge a test by its command and measured displacement.

    Parameters
    ----------
    recording : Recording
        The test.
    structure : Structure
        The structure under test.
    stated : mapping of str to StatedValue, optional
        Tolerances of its frequency "f" [Hz], damping ratio "xi" and share "alpha", and the "scale" of the
        sensor of the measured displacement over that of the command.
    equipment : Equipment, optional
        What a laboratory does not know where the test states nothing, `ordinary_equipment()` for one as many
        are. By default everything is taken to be exact: channels, structure and specimen.
    motion : Motion, optional
        Its ground motion; the index is then that of this motion's own boundary, exact by simulation, over
        the part of the record that the test saw, as the error of the test is.
    criterion : Criterion, optional
        The criterion; by default the one that ships with the package, for the threshold, metric and
        confidence given and for tests of this length. A given criterion has its own threshold, metric and
        confidence.
    threshold : float, optional
        Error of the whole test [-].
    confidence : float, optional
        Share of the population's ground motions.
    metric : str, optional
        Which error, "rms" or "mte".
    model : UpdatedModel, optional
        Calibrated model of a nonlinear specimen, as `reliab diagnose` writes it.
    measured_specimen : bool, optional
        Whether the specimen is known by its recorded force only: what it does is learned from the test
        itself, with the "mass" among what is stated; f and ξ then set the numerical substructure.
    linear_specimen : bool, optional
        Whether somebody states that the specimen is linear. Where nobody does and no force was recorded, the
        interval holds that it may have yielded, as likely as `equipment` says.
    force_channel : ForceChannel, optional
        What the recorded force of a measured specimen contains besides that of the specimen.
    assumed : tuple of str, optional
        Sentences saying that no damping ratio was stated and which one is assumed; repeated among the
        warnings. The interval then allows for any ratio from 0.5 to 10 %, as far as the channels do not show
        it.
    taper : str, optional
        Window of the evaluation index.
    seed : int, optional
        Seed of the draws.

    Returns
    -------
    Assessment
        Error of the test with its interval, verdict, index, stability margin and what to improve first.

    Raises
    ------
    InputError
        If the test is too short or too long, sampled too coarsely, has two units or signs, or the measured
        displacement does not follow the command.
    """
    learned_notes: tuple[str, ...] = ()
    equipment = equipment or exact_equipment()
    if not (equipment.is_exact or measured_specimen or linear_specimen or model is not None):
        nonlinear = "mass" in (stated or {}) and looks_nonlinear(remove_spikes(recording)[0], structure)
        measured_specimen = bool(nonlinear)
        learned_notes = (_LEARNED_NOTE,) if nonlinear else ()
    linear = model is None and not measured_specimen
    _require_judgeable(recording, structure, stated or {}, linear=linear)
    stated = dict(stated or {})
    tolerances_of(sizes_of_unknown(stated, structure, equipment, recording.time_step))
    criterion_arguments = structure.frequency, structure.damping_ratio, threshold, confidence
    criterion_used = criterion or criterion_of_test(
        *criterion_arguments, metric=metric, duration=recording.duration
    )
    question = Question(
        structure=structure,
        stated=stated,
        equipment=equipment,
        metric=Metric(criterion_used.metric),
        threshold=criterion_used.threshold,
        model=model,
        measured_specimen=measured_specimen,
        linear_specimen=linear_specimen,
        force_channel=force_channel,
        seed=seed,
    )
    return _examine(recording, question, criterion_used, motion, (assumed, learned_notes), taper)


def _examine(
    recording: Recording,
    question: Question,
    criterion: Criterion,
    motion: "Motion | None",
    notes: tuple[tuple[str, ...], tuple[str, ...]],
    taper: str,
) -> Assessment:
    assumptions, learned_notes = notes
    faults, tracking = faults_of_channel(
        recording,
        threshold=question.threshold,
        experimental_fraction=question.structure.experimental_fraction,
        window=taper,
        seed=question.seed,
    )
    clean = repair_recording(recording, faults)
    if faults:
        tracking = track(clean, window=taper, seed=question.seed)
    outcome = _judge(recording, clean, faults, _broaden_damping(question) if assumptions else question)
    if assumptions and outcome.error.inferred is not None:
        question, assumptions = _take_shown_damping(question, outcome.error.inferred.posterior)
    structure = question.structure
    turning = examine_turning(outcome.error, recording, question)
    verdict = verdict_of_error(outcome.error, outcome.effects, outcome.equation)
    verdict = doubt_rest(verdict, outcome.error, clean)
    assessment = Assessment(
        recording=recording,
        structure=structure,
        stated=question.stated,
        criterion=criterion,
        tracking=tracking,
        measures=measure_tracking(clean),
        windows=track_windows(clean, tracking, window=taper),
        population=place(criterion, structure, tracking.amplitude, tracking.delay, tracking.draws),
        scope=scope_of_test(criterion, clean, structure, outcome.error.reference),
        by_response=place_by_response(clean, question, outcome.error.reference, criterion, tracking),
        placement=None if motion is None else _place_test(motion, clean, tracking, outcome.error, question),
        error=outcome.error,
        faults=outcome.effects,
        equation=outcome.equation,
        judgement=turning.limit(verdict, outcome.error.probability),
        turning=turning,
        assumed=(*assumptions, *learned_notes),
        column_doubts=tuple(contradict_columns(recording, tracking)),
    )
    return _add_contradictions(assessment, clean, question)


def _require_judgeable(
    recording: Recording, structure: Structure, stated_values: Mapping[str, StatedValue], *, linear: bool
) -> None:
    require_length(recording, structure.frequency)
    require_drawable(recording, whole_structure(structure))
    require_plausible(recording, stiffness=stiffness_from_mass(structure, stated_values), linear=linear)
    if "mass" in stated_values and not linear:
        lag = stated_values.get("feedback_lag", StatedValue(0.0)).value / MILLI
        sound, *_ = remove_spikes(recording)
        require_unit_of_force(sound, structure, mass=stated_values["mass"].value, feedback_lag=lag)


def _add_contradictions(assessment: Assessment, clean: Recording, question: Question) -> Assessment:
    """Add where the recording contradicts what is stated, which limits the verdict."""
    stated_contradictions = contradict_frequency(clean, assessment.tracking, [question.structure.frequency])
    return assessment.add_contradictions(
        *(doubt for doubt in stated_contradictions if question.linear and not _accepts_frequency(assessment)),
        *contradict_stability(assessment.stability_margin),
        *contradict_motion(assessment.placement),
        *assessment.equation.doubts,
        *contradict_specimen(assessment.error.specimen),
        *(assessment.column_doubts if _depends_on_columns(assessment, clean, question) else ()),
    )


def _accepts_frequency(assessment: Assessment) -> bool:
    """Whether the channels are no likelier with a structure that resonates where the command mainly moves."""
    posterior_error = assessment.error.inferred
    if posterior_error is None:
        return False
    moves = assessment.tracking.plain.equivalent_frequency
    return not favours_frequency(posterior_error.posterior, moves / assessment.structure.frequency)


def _depends_on_columns(assessment: Assessment, clean: Recording, question: Question) -> bool:
    """Tell whether the columns may be swapped, and the verdict would then be another one."""
    if not assessment.column_doubts:
        return False
    swapped_error = error_of_test(replace(clean, command=clean.measured, measured=clean.command), question)
    return word_of_probability(swapped_error.probability) is not word_of_probability(
        assessment.error.probability
    )


def _place_test(
    motion: "Motion", clean: Recording, tracking: TrackingIndex, error: ErrorOfTest, question: Question
) -> "OwnPlacement":
    """Place the test against the boundary of its own ground motion."""
    from reliab.assessment.alignment import align
    from reliab.assessment.own_motion import place_on_own

    alignment = align(clean, error.reference, question.structure, motion)
    return place_on_own(motion, tracking, alignment, question)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Judgement:
    """The error, and the circumstances that could change it."""

    error: ErrorOfTest
    effects: tuple[FaultEffect, ...]
    equation: OwnEquation


def _judge(
    recording: Recording, clean: Recording, faults: tuple[Fault, ...], question: Question
) -> _Judgement:
    """Error of the test, and what its recording shows of the structure."""
    structure, nonlinear, ground = question.structure, "", ShownGround()
    if question.linear:
        ground, nonlinear = _examine_ground(clean, question), looks_nonlinear(clean, structure)
        force = None if nonlinear else recording.force
        recording = replace(recording, ground=ground.evidence(recording.ground), force=force)
    error, effects = error_of_one_with_faults(recording, faults, question)
    if error.inferred is None:
        return _Judgement(error=error, effects=effects, equation=OwnEquation())
    if question.equipment.is_exact:
        equation = compare_with_stated(clean, structure, ground, question.stated, nonlinear=nonlinear)
    else:
        equation = _compare_with_posterior(error.inferred.posterior, ground, question, nonlinear=nonlinear)
    return _Judgement(error=error, effects=effects, equation=equation)


def _compare_with_posterior(
    posterior: TestPosterior, ground: ShownGround, question: Question, *, nonlinear: str
) -> OwnEquation:
    """Compare stated values with what the channels show where no value is exact.

    `nonlinear`: as of `OwnEquation`.
    """
    structure = question.structure
    conflicts = tuple(find_conflicts(posterior, structure, question.stated))
    identification = None
    if ground.identified is not None:
        misfit = ground.identified.misfit
        identification = identify_structure(posterior, structure, question.feedback_lag, misfit)
    return OwnEquation(
        identified=identification,
        wrong=tuple(conflict.option for conflict in conflicts if conflict.option),
        contradictions=tuple(conflict.finding for conflict in conflicts),
        nonlinear=nonlinear,
        notes=ground.notes,
        doubts=(*ground.doubts, *(conflict for conflict in conflicts if conflict.remedy)),
    )


def _examine_ground(clean: Recording, question: Question) -> ShownGround:
    stated_values = question.stated
    return examine_ground(
        clean,
        question.structure,
        mass=stated_values["mass"].value if "mass" in stated_values else None,
        feedback_lag=question.feedback_lag,
    )


def _take_shown_damping(question: Question, posterior: TestPosterior) -> tuple[Question, tuple[str, ...]]:
    """Take the damping ratio that the channels show, of which nothing was stated, and say so."""
    ratio = damping_from_channels(posterior, question.structure)
    structure = replace(question.structure, damping_ratio=ratio.value)
    stated_values = {**question.stated, "xi": ratio}
    return replace(question, structure=structure, stated=stated_values, damping_shown=True), (
        _shows_ratio(ratio),
    )


def _shows_ratio(ratio: StatedValue) -> str:
    size = f"{significant(ratio.value, 2)} ± {significant(ratio.deviation, 1)}"
    return (
        f"No damping ratio was stated; the recording shows {size}, where any from 0.005 to 0.1 was possible."
    )


def _broaden_damping(question: Question) -> Question:
    """Take a damping ratio that nobody stated as one that lies anywhere from 0.5 to 10 %."""
    ratio = question.structure.damping_ratio
    return replace(question, stated={**question.stated, "xi": StatedValue(ratio, _ANY_RATIO * ratio)})
