"""What a test shows of its structure, compared with what was stated."""

from collections.abc import Mapping
from dataclasses import dataclass

from reliab.assessment.contradictions import Contradiction
from reliab.assessment.rebuilt_error.identification import Identification, IdentifiedParameter, fit_spring
from reliab.assessment.rebuilt_error.kernel import Kernel
from reliab.assessment.rebuilt_error.noise import estimate_noise
from reliab.assessment.rebuilt_error.specimen_check import examine_specimen
from reliab.assessment.recorded_ground import ShownGround
from reliab.core.arrays import Array
from reliab.core.significant_digits import percent, significant
from reliab.core.stated_value import StatedValue
from reliab.core.vocabulary import MILLI
from reliab.recordings.recording import Recording
from reliab.structures.structure import Structure

_FEWEST_PERIODS = 5.0
_AGREES = 2.0  # stated standard deviations
_SIGNIFICANT = 3.0  # standard errors
_LEAST_SKEW = 0.1  # ms
_REMEDY = "Correct it, or state how uncertain it is: the error is then inferred with what the test shows."
_QUANTITIES = {
    "frequency": ("f", "a natural frequency", " Hz", 1.0),
    "damping_ratio": ("xi", "a damping ratio", "", 1.0),
    "experimental_fraction": ("alpha", "a share of the stiffness in the laboratory", "", 1.0),
    "feedback_lag": ("feedback_lag", "a lag of the fed-back force", " ms", 1e3),
}


@dataclass(frozen=True, kw_only=True)
class OwnEquation:
    """What the test shows about its structure."""

    # Frequency, damping ratio and, with a recorded force, share and lag; None where the ground acceleration
    # is not recorded or does not belong to the test
    identified: Identification | None = None
    # Names of stated values that the test contradicts: "f", "xi", "alpha", "feedback_lag"
    wrong: tuple[str, ...] = ()
    contradictions: tuple[str, ...] = ()  # The same in sentences
    nonlinear: str = ""  # A sentence, where the recorded force shows a nonlinear specimen; else empty
    notes: tuple[str, ...] = ()  # What was found about the recorded ground acceleration, in sentences
    doubts: tuple[Contradiction, ...] = ()  # Where it contradicts the test, or the test what was stated


def compare_with_stated(
    recording: Recording,
    structure: Structure,
    ground: ShownGround,
    stated_values: Mapping[str, StatedValue],
    *,
    nonlinear: str,
) -> OwnEquation:
    """Compare what ground acceleration and force show with the values stated as exact, or nearly so.

    A quantity of the structure and one of the channels can look alike, so that a value that differs is told,
    and the verdict left open, but none is replaced. `nonlinear`: as of `OwnEquation`.
    """
    identification = ground.identified
    estimates = {
        _QUANTITIES[name][0]: _sentence(name, getattr(identification, name))
        for name in (() if identification is None else identification.disagreements())
        if not _agrees(
            getattr(identification, name), stated_values.get(_QUANTITIES[name][0]), _QUANTITIES[name][-1]
        )
    }
    ground_alone = identification is not None and identification.feedback_lag is None
    if not (nonlinear or ground_alone):  # else the displacement itself was compared with the ground
        lag = stated_values.get("feedback_lag", StatedValue(0.0)).deviation
        if sentence := _skew_of_force(recording, structure, lag):
            estimates["skew"] = sentence
    doubts = (
        Contradiction(finding=sentence, remedy=_REMEDY, of_structure=True) for sentence in estimates.values()
    )
    return OwnEquation(
        identified=identification,
        wrong=tuple(estimates),
        contradictions=tuple(estimates.values()),
        nonlinear=nonlinear,
        notes=ground.notes,
        doubts=(*ground.doubts, *doubts),
    )


def looks_nonlinear(recording: Recording, structure: Structure) -> str:
    """Say that the recorded force is that of a nonlinear specimen; empty where it is not."""
    force = _force_of_specimen(recording, structure)
    if force is None:
        return ""
    noise = estimate_noise(recording.command, recording.measured, recording.time_step)
    smooth_displacement = noise.smooth(recording.measured)
    check = examine_specimen(smooth_displacement, force, recording.time_step, structure.frequency)
    if not check.nonlinear:
        return ""
    share = percent(check.share, decimals=1)
    return (
        f"The specimen looks nonlinear: {share} of its force follows no spring, dashpot or mass. The error "
        "was computed for a linear specimen."
    )


def _force_of_specimen(recording: Recording, structure: Structure) -> Array | None:
    """Return the recorded force [N], shape (n,); None if it has too few periods to show its specimen."""
    return recording.force if recording.duration * structure.frequency >= _FEWEST_PERIODS else None


def _skew_of_force(recording: Recording, structure: Structure, tolerated_skew: float) -> str:
    """Say that force and measured displacement are not of one time, or nothing; `tolerated_skew` [ms]."""
    force = _force_of_specimen(recording, structure)
    if force is None:
        return ""
    kernel = Kernel.from_frequency(structure.frequency, recording.time_step)
    spring = fit_spring(recording.measured, force, kernel)
    late, deviation = MILLI * spring.late, MILLI * spring.late_deviation
    if abs(late) <= max(_SIGNIFICANT * deviation, _AGREES * tolerated_skew, _LEAST_SKEW):
        return ""
    return (
        f"The recorded force is {significant(abs(late), 2)} ± {significant(deviation, 1)} ms "
        f"{'ahead of' if late > 0.0 else 'behind'} the measured displacement: one of the channels has a "
        "skew, the force is fed back late, or the specimen dissipates."
    )


def _agrees(estimate: IdentifiedParameter, stated_value: StatedValue | None, factor: float) -> bool:
    deviation = 0.0 if stated_value is None else stated_value.deviation
    return abs(factor * (estimate.value - estimate.stated)) <= _AGREES * deviation


def _sentence(name: str, estimate: IdentifiedParameter) -> str:
    _, words, unit, factor = _QUANTITIES[name]
    value, deviation, stated_value = (
        factor * number for number in (estimate.value, estimate.deviation, estimate.stated)
    )
    return (
        f"The recording shows {words} of {value:.4g} ± {significant(deviation, 1)}{unit}; "
        f"{stated_value:.4g}{unit} was taken as exact."
    )
