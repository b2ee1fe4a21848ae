"""Methods that judge a test: its rebuilt error, and A and d with criteria or the motion's own boundary."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from reliab.assessment.default_criterion import default_criterion
from reliab.assessment.placement import scale_limits
from reliab.assessment.rebuild import RebuiltError
from reliab.assessment.verdict import Word, word_of_probability
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.vocabulary import MILLI, Metric, Side
from reliab.criterion.criterion import Criterion
from reliab.criterion.derivation import published_criterion
from reliab.criterion.laws.registry import MANY_MOTION_LAWS
from reliab.simulation.engine import Loop
from reliab.simulation.excitation import Excitation
from reliab.structures.structure import Structure
from reliab.tracking.indices.response_error import relative_error
from reliab.tracking.indices.tracking import FrequencyEvaluation, frequency_evaluation

REBUILT: Final = "rebuilt error"
CERTAIN: Final = "rebuilt error, verdict reliable"
WITH_MODEL: Final = "rebuilt error with the specimen's model"
OWN_BOUNDARY: Final = "own boundary of the motion"
CRITERION: Final = "criterion (dirichlet)"

_PRINTED = ("guo_2017_15", "guo_2017_18")
_NO_LEAD = -1e-5  # s


@dataclass(frozen=True, kw_only=True)
class Question:
    """What is asked of every test."""

    threshold: float  # Error up to which a test is good [-]
    metric: Metric  # Which error
    confidence: float  # Share of the population's ground motions that the criterion states [-]


@dataclass(frozen=True, kw_only=True)
class Judgement:
    """The verdict of one method on a test."""

    judge: str  # Who
    accepted: bool  # Whether the test is called good
    # estimate, low, high: Error that the judge states, with its 90 % interval [-]; NaN where it states none
    estimate: float = np.nan
    low: float = np.nan
    high: float = np.nan


def judge_by_rebuilt_error(error: RebuiltError, question: Question, judge: str = REBUILT) -> Judgement:
    """Accept a test whose rebuilt error stays below the threshold."""
    stated = error.estimate(question.metric)
    return Judgement(
        judge=judge,
        accepted=stated.value <= question.threshold,
        estimate=stated.value,
        low=stated.low,
        high=stated.high,
    )


def judge_by_verdict(error: RebuiltError, question: Question, *, looks_nonlinear: bool) -> Judgement:
    """Accept a test as `reliab assess` does: below the threshold with 95 % probability, and no doubt."""
    word = word_of_probability(error.probability(question.threshold, question.metric))
    return Judgement(judge=CERTAIN, accepted=word is Word.RELIABLE and not looks_nonlinear)


@dataclass(frozen=True, kw_only=True)
class ByIndices:
    """Methods that use only A and d of a test, its structure and its ground motion."""

    excitation: Excitation  # The ground motion that the test saw
    structure: Structure  # The structure as the laboratory states it
    criteria: Mapping[str, Criterion]  # Criteria by name
    question: Question  # What is asked

    @classmethod
    def from_excitation(
        cls, excitation: Excitation, structure: Structure, question: Question, learned_without: str | None
    ) -> "ByIndices":
        """Take the printed laws where they hold, and the shipped criterion for tests of this length."""
        criteria = {}
        for name in _PRINTED:
            law = MANY_MOTION_LAWS[name]
            try:
                law.validity.require_error(question.threshold, question.metric)
                law.validity.require(structure.frequency, structure.damping_ratio)
            except InputError:
                continue
            criteria[name] = published_criterion(name)
        criteria[CRITERION] = default_criterion(
            structure.frequency,
            structure.damping_ratio,
            question.threshold,
            question.confidence,
            metric=question.metric,
            excluded_event=learned_without,
            duration=(excitation.acceleration.size - 1) * excitation.time_step,
        )
        return cls(excitation=excitation, structure=structure, criteria=criteria, question=question)

    @cached_property
    def _loop(self) -> Loop:
        return Loop(excitation=self.excitation, structure=self.structure)

    def judge(self, command: Array, measured: Array, time_step: float) -> Iterator[Judgement]:
        """Judge a test by A and d of its histories.

        `command`, `measured` [m]; `time_step` [s].
        """
        index = frequency_evaluation(command, measured, time_step)
        for name, criterion in self.criteria.items():
            yield Judgement(judge=name, accepted=self._accepts(criterion, index))
        cells = self._loop.cells(gain=index.amplitude, delay=index.equivalent_delay)
        error = float(relative_error(self._loop.deviation(cells), self.question.metric)[0])
        stated = error if np.isfinite(error) else np.inf  # the loop of A and d runs away
        yield Judgement(judge=OWN_BOUNDARY, accepted=stated <= self.question.threshold, estimate=stated)

    def _accepts(self, criterion: Criterion, index: FrequencyEvaluation) -> bool:
        delay = index.equivalent_delay
        side = Side.LEAD if delay < 0.0 else Side.LAG
        if not criterion.knows_leads:
            if delay < _NO_LEAD:
                return False
            side = Side.LAG
        a, b, _ = scale_limits(criterion, self.structure, side)
        if not (a > 0.0 and b > 0.0):
            return False
        return (index.amplitude - 1.0) ** 2 / a + (MILLI * delay) ** 2 / b <= 1.0
