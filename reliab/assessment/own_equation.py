"""Check of the stated structure by the test's own equation of motion."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from reliab.arrays import Array
from reliab.assessment.explanations import (
    Explanation,
    VelocityTerm,
    explain,
    ratio_per_second,
)
from reliab.assessment.rebuilt_error.identification import Identification, Identified, identify
from reliab.assessment.rebuilt_error.kernel import Kernel
from reliab.assessment.rebuilt_error.specimen_check import examine_specimen
from reliab.assessment.rebuilt_error.specimen_spring import fit_spring
from reliab.recordings import Recording
from reliab.significant import percent, significant
from reliab.stated_value import StatedValue
from reliab.structures import Structure
from reliab.vocabulary import MILLI

_LARGEST_MISFIT = 0.3
"""Largest residual over ground acceleration; above it the channel is not this test's ground motion."""

_FEWEST_PERIODS = 5.0
_AGREES = 2.0  # stated standard deviations
_LEAST = 0.02  # of the damping ratio, below which nothing is said of it; it moves the error by about 0.5 %
_TOO_SHORT = "The test is too short for its structure to be identified from the recorded ground acceleration."
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
    # What the test shows beside its frequency and share, by each of the causes that cannot be told apart
    explanations: tuple[Explanation, ...] = ()
    nonlinear: str = ""  # A sentence, where the recorded force shows a nonlinear specimen; else empty
    notes: tuple[str, ...] = ()  # What was found about the recorded ground acceleration, in sentences

    def structure(self, stated: Structure) -> Structure:
        """Structure with the identified frequency and share, where they contradict the stated ones.

        Damping ratio and feedback lag have the same effect on a test, and stay as stated.
        """
        if self.identified is None:
            return stated
        share = self.identified.experimental_fraction
        return Structure(
            frequency=self.identified.frequency.value if "f" in self.wrong else stated.frequency,
            damping_ratio=stated.damping_ratio,
            experimental_fraction=min(share.value, 1.0)
            if share is not None and "alpha" in self.wrong
            else stated.experimental_fraction,
        )


def examine_equation(
    recording: Recording,
    structure: Structure,
    stated: Mapping[str, StatedValue],
    smoothed: Array,
) -> OwnEquation:
    """Compare a test with the values stated for it.

    `stated` [kg]; `smoothed` [m].
    Returns what was found; nothing where neither ground acceleration nor force is recorded.
    """
    nonlinear = _nonlinear(recording, structure, smoothed)
    lag = stated.get("feedback_lag", StatedValue(0.0))
    seconds = lag.value / MILLI
    of_force = None if nonlinear else _term_of_force(recording, structure, lag)
    identified, notes = _identified(recording, structure, stated, seconds)
    if identified is None:
        explanations = explain(None, of_force, seconds)
        return OwnEquation(
            contradictions=tuple(_said(of_force, explanations, structure)),
            explanations=explanations,
            nonlinear=nonlinear,
            notes=notes,
        )
    estimates = {
        _QUANTITIES[name][0]: (name, getattr(identified, name))
        for name in identified.disagreements()
        if not _within(getattr(identified, name), stated.get(_QUANTITIES[name][0]), _QUANTITIES[name][-1])
    }
    explanations = explain(_term_of_equation(identified, structure, stated, of_force), of_force, seconds)
    return OwnEquation(
        identified=identified,
        wrong=tuple(estimates),
        contradictions=(
            *(_sentence(name, value) for name, value in estimates.values()),
            *_said(of_force, explanations, structure),
        ),
        explanations=explanations,
        nonlinear=nonlinear,
        notes=notes,
    )


def doubts_of_ground(recording: Recording, structure: Structure, mass: float) -> tuple[str, ...]:
    """Say whether the recorded ground acceleration is reversed, or not this test's; `mass` [kg]."""
    if recording.ground is None or recording.duration * structure.frequency < _FEWEST_PERIODS:
        return ()
    return _identified(recording, structure, {"mass": StatedValue(mass)}, 0.0)[1]


def _identified(
    recording: Recording, structure: Structure, stated: Mapping[str, StatedValue], lag: float
) -> tuple[Identification | None, tuple[str, ...]]:
    """Identify the structure from the recorded ground acceleration; None with the reason where it is not."""
    if recording.ground is None:
        return None, ()
    if recording.duration * structure.frequency < _FEWEST_PERIODS:
        return None, (_TOO_SHORT,)
    mass = stated["mass"].value if "mass" in stated else None
    force = recording.force / mass if recording.force is not None and mass is not None else None
    candidates = [
        identify(
            recording.command,
            recording.measured,
            sign * recording.ground,
            recording.time_step,
            structure,
            force=force,
            feedback_lag=lag,
        )
        for sign in (1.0, -1.0)
    ]
    identified = min(candidates, key=lambda candidate: candidate.misfit)
    if identified.misfit > _LARGEST_MISFIT:
        return None, (_other_ground(identified.misfit),)
    return identified, () if identified is candidates[0] else (
        "The ground acceleration has the opposite sign.",
    )


def _term_of_force(recording: Recording, structure: Structure, lag: StatedValue) -> VelocityTerm | None:
    if recording.force is None or recording.duration * structure.frequency < _FEWEST_PERIODS:
        return None
    kernel = Kernel.of_frequency(structure.frequency, recording.time_step)
    spring = fit_spring(recording.measured, recording.force, kernel)
    least = _LEAST * structure.damping_ratio / ratio_per_second(structure)
    tolerated = _AGREES * lag.deviation / MILLI
    return VelocityTerm(value=spring.late, deviation=spring.late_deviation, least=max(least, tolerated))


def _term_of_equation(
    identified: Identification,
    structure: Structure,
    stated: Mapping[str, StatedValue],
    of_force: VelocityTerm | None,
) -> VelocityTerm:
    """Damping that is not stated, as a time; with the force in the equation its term is added to it."""
    ratio, per_second = identified.damping_ratio, ratio_per_second(structure)
    tolerated = [
        _LEAST * structure.damping_ratio / per_second,
        _AGREES * stated.get("xi", StatedValue(0.0)).deviation / per_second,
        _AGREES * stated.get("feedback_lag", StatedValue(0.0)).deviation / MILLI,
    ]
    term = VelocityTerm(
        value=(ratio.value - ratio.stated) / per_second,
        deviation=ratio.deviation / per_second,
        least=max(tolerated),
    )
    if identified.feedback_lag is None or of_force is None:
        return term
    return term.without(replace(of_force, value=-of_force.value))


def _said(
    of_force: VelocityTerm | None, explanations: tuple[Explanation, ...], structure: Structure
) -> Iterator[str]:
    """Say what the recorded force shows, and what may have caused it and the damping ratio."""
    if of_force is not None and of_force.matters:
        size, deviation = (MILLI * number for number in (abs(of_force.value), of_force.deviation))
        where = "ahead of" if of_force.value > 0.0 else "behind"
        shift = f"{significant(size, 2)} ± {significant(deviation, 1)} ms"
        yield f"The recorded force is {shift} {where} the measured displacement."
    if explanations:
        causes = ", or ".join(explanation.spoken(structure) for explanation in explanations)
        yield f"The cause may be {causes}{': the test cannot tell which' if len(explanations) > 1 else ''}."


def _within(estimate: Identified, stated: StatedValue | None, factor: float) -> bool:
    deviation = 0.0 if stated is None else stated.deviation
    return abs(factor * (estimate.value - estimate.stated)) <= _AGREES * deviation


def _sentence(name: str, estimate: Identified) -> str:
    _, words, unit, factor = _QUANTITIES[name]
    value, deviation, stated = (
        factor * number for number in (estimate.value, estimate.deviation, estimate.stated)
    )
    return (
        f"The test's own equation of motion shows {words} of {value:.4g} ± "
        f"{significant(deviation, 1)}{unit}; "
        f"{stated:.4g}{unit} was stated."
    )


def _other_ground(misfit: float) -> str:
    return (
        "The recorded ground acceleration does not belong to this test (the equation of motion leaves "
        f"{percent(misfit, decimals=0)} of it unexplained): check channel and unit. The structure was "
        "not identified from it."
    )


def _nonlinear(recording: Recording, structure: Structure, smoothed: Array) -> str:
    periods = recording.duration * structure.frequency
    if recording.force is None or periods < _FEWEST_PERIODS:
        return ""
    nonlinearity = examine_specimen(smoothed, recording.force, recording.time_step, structure.frequency)
    if not nonlinearity.nonlinear:
        return ""
    return (
        f"The specimen looks nonlinear: {percent(nonlinearity.share, decimals=1)} of its force follows "
        "no spring, dashpot "
        "or mass. The error was computed for a linear specimen."
    )
