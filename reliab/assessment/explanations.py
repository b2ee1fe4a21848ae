"""What may explain a test's own equation of motion, where several causes look alike: the error under each.

A damping ratio, a skew between command and measured displacement, and a lag of the fed-back force have one
and the same effect on the equation, and none of the same size on the error. The same holds for the velocity
term of a recorded force: skew of its channel, a dashpot in the specimen, or a force that comes late. Each
cause is therefore a time [s], and all of them are computed.
"""

from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from reliab.assessment.budget import without_skew
from reliab.assessment.error_of_test import ErrorOfTest, Question, error_of_test
from reliab.recordings import Recording
from reliab.significant import significant
from reliab.stated_value import StatedValue
from reliab.structures import Structure
from reliab.vocabulary import MILLI

_SIGNIFICANT = 3.0  # standard errors


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
