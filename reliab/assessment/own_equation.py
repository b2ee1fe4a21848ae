"""What a test shows of its structure, compared with what was stated.

A linear specimen's force is f = k x + c x'. Where the displacement was recorded late by s against the force,
x(t) = x_r(t + s), the force is k x_r + k s x_r' to first order. Thus c/k is a time, and whether it is a skew
between the two channels, a dashpot in the specimen or a force that comes late (c/k < 0), they cannot tell.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from reliab.assessment.conflicts import (
    Identification,
    IdentifiedParameter,
    find_conflicts,
    identify_exact,
    identify_structure,
)
from reliab.assessment.inference.posterior import TestPosterior
from reliab.assessment.rebuilt_error.kernel import SmoothingKernel, fit_equation
from reliab.assessment.rebuilt_error.noise import estimate_noise
from reliab.assessment.rebuilt_error.specimen_check import examine_specimen
from reliab.assessment.recorded_ground import ShownGround
from reliab.assessment.verdict import Contradiction
from reliab.core.arrays import Array
from reliab.core.significant_digits import percent, significant
from reliab.core.stated_value import StatedValue
from reliab.core.vocabulary import MILLI
from reliab.recordings.coupled_recording import CoupledRecording
from reliab.recordings.recording import Recording
from reliab.structures.structure import Structure

_FEWEST_PERIODS = 5.0
_CLEAR = 10.0  # standard errors: a stiffness that is less certain is none
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

    @property
    def all_contradictions(self) -> tuple[str, ...]:
        """Where the test contradicts what was stated, and a linear specimen, in sentences."""
        return *self.contradictions, *filter(None, [self.nonlinear])


def compare_with_stated(
    posterior: TestPosterior,
    recording: Recording | CoupledRecording,
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
    identification = identify_exact(posterior, structure, ground.misfit or 0.0) if ground.fits else None
    estimates = {
        _QUANTITIES[name][0]: _sentence(name, getattr(identification, name))
        for name in (() if identification is None else identification.disagreements())
        if not _agrees(
            getattr(identification, name), stated_values.get(_QUANTITIES[name][0]), _QUANTITIES[name][-1]
        )
    }
    ground_alone = identification is not None and identification.feedback_lag is None
    # else the displacement itself was compared with the ground
    if isinstance(recording, Recording) and not (nonlinear or ground_alone):
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


def compare_with_posterior(
    posterior: TestPosterior,
    structure: Structure,
    ground: ShownGround,
    stated_values: Mapping[str, StatedValue],
    *,
    nonlinear: str,
) -> OwnEquation:
    """Compare stated values with what the channels show where no value is exact.

    `nonlinear`: as of `OwnEquation`.
    """
    conflicts = tuple(find_conflicts(posterior, structure, stated_values))
    return OwnEquation(
        identified=identify_structure(posterior, structure, ground.misfit or 0.0) if ground.fits else None,
        wrong=tuple(conflict.option for conflict in conflicts if conflict.option),
        contradictions=tuple(conflict.finding for conflict in conflicts),
        nonlinear=nonlinear,
        notes=ground.notes,
        doubts=(*ground.doubts, *(conflict for conflict in conflicts if conflict.remedy)),
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


@dataclass(frozen=True, kw_only=True)
class Spring:
    """A specimen's spring by its recorded force."""

    stiffness: float  # k, in units of force over metres
    # late, late_deviation: c/k with its standard error [s]: time by which the displacement was recorded later
    # than the force
    late: float
    late_deviation: float


def fit_spring(measured_displacement: Array, force: Array, kernel: SmoothingKernel) -> Spring:
    """Fit k and c to a recorded force.

    `measured_displacement` [m].

    >>> time = np.arange(0.0, 30.0, 0.005)
    >>> force = 40.0 * np.sin(6.0 * time) * np.sin(0.1 * time)
    >>> recorded = np.sin(6.0 * (time - 0.002)) * np.sin(0.1 * (time - 0.002))
    >>> spring = fit_spring(recorded, force, SmoothingKernel.from_frequency(1.0, 0.005))
    >>> round(spring.stiffness, 2), round(1e3 * spring.late, 3)
    (40.0, 2.0)
    """
    columns = np.stack(
        [
            kernel.smooth_derivative(measured_displacement, 0),
            kernel.smooth_derivative(measured_displacement, 1),
        ]
    )
    columns = np.vstack([columns, np.ones(columns.shape[1])])
    (stiffness, damping, _), covariance, _ = fit_equation(columns, kernel.smooth_derivative(force, 0), kernel)
    follows = stiffness > _CLEAR * np.sqrt(covariance[0, 0])
    return Spring(
        stiffness=float(stiffness),
        late=float(damping / stiffness) if follows else 0.0,
        late_deviation=float(np.sqrt(covariance[1, 1]) / stiffness) if follows else 0.0,
    )


def _skew_of_force(recording: Recording, structure: Structure, tolerated_skew: float) -> str:
    """Say that force and measured displacement are not of one time, or nothing; `tolerated_skew` [ms]."""
    force = _force_of_specimen(recording, structure)
    if force is None:
        return ""
    kernel = SmoothingKernel.from_frequency(structure.frequency, recording.time_step)
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
