"""Check of the stated structure by the test's own equation of motion.

Several causes look alike in it. A damping ratio, a skew between command and measured displacement, and a lag
of the fed-back force have one and the same effect on the equation, and none of the same size on the error.
The same holds for the velocity term of a recorded force: skew of its channel, a dashpot in the specimen, or a
force that comes late. Each cause is therefore a time [s], and the error is computed under all of them.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from reliab.assessment.budget.corrections import without_skew
from reliab.assessment.contradictions import Contradiction
from reliab.assessment.error_of_test import ErrorOfTest, Question, error_of_test
from reliab.assessment.rebuilt_error.identification import Identification, Identified, fit_spring
from reliab.assessment.rebuilt_error.kernel import Kernel
from reliab.assessment.rebuilt_error.specimen_check import examine_specimen
from reliab.assessment.recorded_ground import examine_ground
from reliab.core.arrays import Array
from reliab.core.significant_digits import percent, significant
from reliab.core.stated_value import StatedValue
from reliab.core.vocabulary import MILLI
from reliab.recordings.recording import Recording
from reliab.structures.structure import Structure

_SIGNIFICANT = 3.0  # standard errors

_FEWEST_PERIODS = 5.0
_AGREES = 2.0  # stated standard deviations
_LEAST = 0.02  # of the damping ratio, below which nothing is said of it; it moves the error by about 0.5 %
_BY_DEFAULT = {"experimental_fraction": 1.0, "feedback_lag": 0.0}  # what is taken where nobody states it
_QUANTITIES = {
    "frequency": ("f", "a natural frequency", " Hz", 1.0),
    "damping_ratio": ("xi", "a damping ratio", "", 1.0),
    "experimental_fraction": ("alpha", "a share of the stiffness in the laboratory", "", 1.0),
    "feedback_lag": ("feedback_lag", "a lag of the fed-back force", " ms", 1e3),
}


@dataclass(frozen=True, kw_only=True)
class Explanation:
    """Causes that together explain what a test shows; 0 where a cause plays no part."""

    damping: float = 0.0  # 2Δξ/(αω₀) [s], of a damping ratio that is Δξ higher than stated
    skew: float = 0.0  # Time by which the measured displacement was recorded later than the command [s]
    feedback_lag: float = 0.0  # Time by which the force was fed back later than stated [s]
    dashpot: float = 0.0  # Damping of the specimen over its stiffness [s], a part of the whole structure's

    def __add__(self, further: "Explanation") -> "Explanation":
        """Both together."""
        return Explanation(
            damping=self.damping + further.damping,
            skew=self.skew + further.skew,
            feedback_lag=self.feedback_lag + further.feedback_lag,
            dashpot=self.dashpot + further.dashpot,
        )

    def damping_ratio(self, structure: Structure) -> float:
        """Damping ratio of the whole structure."""
        return structure.damping_ratio + self.damping * ratio_per_second(structure)

    def spoken(self, structure: Structure) -> str:
        """Say what it is: "a skew of 0.98 ms between command and measured displacement"."""
        parts = []
        if self.damping:
            parts.append(f"a damping ratio of {self.damping_ratio(structure):.4g}")
        if self.skew:
            parts.append(
                f"a skew of {significant(abs(MILLI * self.skew), 2)} ms between command and measured "
                "displacement"
            )
        if self.feedback_lag:
            parts.append(
                f"a force that is fed back {significant(abs(MILLI * self.feedback_lag), 2)} ms "
                f"{'later' if self.feedback_lag > 0.0 else 'earlier'}"
            )
        if self.dashpot:
            parts.append("damping of the specimen")
        return " with ".join(parts) or "a skew of the force's channel alone"


def ratio_per_second(structure: Structure) -> float:
    """Damping ratio that a velocity term of one second over the specimen's stiffness makes, αω₀/2 [1/s]."""
    return 0.5 * structure.experimental_fraction * structure.circular_frequency


@dataclass(frozen=True, kw_only=True)
class VelocityTerm:
    """A velocity term of an equation over the specimen's stiffness, beside what was stated."""

    value: float  # value, deviation: The term and its standard error [s]
    deviation: float
    least: float  # Smallest one that matters [s]

    @property
    def matters(self) -> bool:
        """Whether it differs from 0 significantly and not negligibly."""
        return abs(self.value) > max(_SIGNIFICANT * self.deviation, self.least)

    def without(self, further: "VelocityTerm") -> "VelocityTerm":
        """Take away another term that is a part of it."""
        deviation = float(np.hypot(self.deviation, further.deviation))
        return replace(self, value=self.value - further.value, deviation=deviation)


def explain(
    of_equation: VelocityTerm | None, of_force: VelocityTerm | None, stated_lag: float
) -> tuple[Explanation, ...]:
    """List what may have caused the velocity terms of a test: single causes, or pairs of them.

    `stated_lag` [s].

    >>> seen = VelocityTerm(value=0.001, deviation=1e-5, least=1e-4)
    >>> [(each.damping, each.skew) for each in explain(seen, None, 0.0)]
    [(0.001, 0.0), (0.0, 0.001)]
    >>> [(each.dashpot, each.skew) for each in explain(seen, seen, 0.0)]
    [(0.0, 0.001), (0.001, 0.0)]
    """
    if of_force is None or not of_force.matters:
        return _of_equation(of_equation, stated_lag)
    late = of_force.value
    if of_equation is None:
        return (Explanation(), *_of_force(late, damping=0.0))
    if not of_equation.matters:  # command and measured displacement agree: the force's channel, or a dashpot
        return (Explanation(), *([Explanation(dashpot=late)] if late > 0.0 else []))
    beside = _of_equation(of_equation.without(of_force), stated_lag)
    causes = _of_force(late, damping=max(late, 0.0))
    if not beside:
        return causes
    return (
        *_of_equation(of_equation, stated_lag),
        *(cause + further for cause, further in product(beside, causes)),
    )


def _of_equation(term: VelocityTerm | None, stated_lag: float) -> tuple[Explanation, ...]:
    """Damping ratio, skew, and lag of the force where that is not negative."""
    if term is None or not term.matters:
        return ()
    late = (Explanation(feedback_lag=-term.value),) if stated_lag - term.value >= 0.0 else ()
    return (Explanation(damping=term.value), Explanation(skew=term.value), *late)


def _of_force(late: float, damping: float) -> tuple[Explanation, ...]:
    """Skew, and a dashpot with what it adds to the stated damping or, where the force is late, its lag."""
    if late < 0.0:
        return (Explanation(skew=late), Explanation(feedback_lag=-late))
    return (Explanation(skew=late), Explanation(dashpot=late, damping=damping))


def error_under(explanation: Explanation, recording: Recording, question: Question) -> ErrorOfTest:
    """Rebuild the error of a test as if an explanation held."""
    structure = question.structure
    lag = question.stated.get("feedback_lag", StatedValue(0.0))
    later = replace(lag, value=lag.value + MILLI * explanation.feedback_lag)
    changed = replace(
        question,
        structure=replace(structure, damping_ratio=explanation.damping_ratio(structure)),
        stated={**question.stated, "feedback_lag": later},
    )
    error = error_of_test(
        without_skew(recording, explanation.skew), changed, specimen_damping=explanation.dashpot
    )
    return replace(error, under=explanation.spoken(structure))


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
    doubts: tuple[Contradiction, ...] = ()  # Where that contradicts the test

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
    mass = stated["mass"].value if "mass" in stated else None
    ground = examine_ground(recording, structure, mass=mass, feedback_lag=seconds)
    identified = ground.identified
    if identified is None:
        explanations = explain(None, of_force, seconds)
        return OwnEquation(
            contradictions=tuple(_said(of_force, explanations, structure)),
            explanations=explanations,
            nonlinear=nonlinear,
            notes=ground.notes,
            doubts=ground.doubts,
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
        notes=ground.notes,
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
        f"{stated:.4g}{unit} was {'taken' if stated == _BY_DEFAULT.get(name) else 'stated'}."
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
