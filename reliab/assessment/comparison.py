"""Tests of one structure and rig ranked by their errors, such as one test with each compensator.

What is not known of structure and sensors is the same in all of them, so that draws of it are paired: errors
that rise and fall together leave their difference certain even where neither of them is.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Final

import numpy as np

from reliab.assessment.assessment import Assessment
from reliab.assessment.error_of_test import ErrorOfTest
from reliab.assessment.frame_assessment import ActuatorOfTest, FrameAssessment
from reliab.assessment.judged_test import plot_errors
from reliab.assessment.rebuilt_error.spread import ENDS, LEVEL, Estimate, weighted_quantiles
from reliab.assessment.verdict import Word
from reliab.core.arrays import Array
from reliab.core.columns import Columns
from reliab.core.errors import InputError
from reliab.core.plain_values import Keys, PlainResult, ResultWithRows, same_names
from reliab.core.significant_digits import percent_with_interval, significant
from reliab.core.vocabulary import Metric
from reliab.signals.spectra import cross_correlate

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from reliab.assessment.tracking_index import TrackingIndex

_FEWEST: Final = 2
_LARGEST_PROBABILITY: Final = 0.99  # of an order that only the tests themselves show
_COMMON_ASSUMPTION: Final = (
    "All tests are assumed to be of one rig: what is unknown, such as the skew of the channels, is the "
    "same in all of them. State in the header of a test what differs in it."
)
_COLUMNS: Final = (
    *("rank", "file", "A", "d_ms", "verdict", "probability"),
    *("rms", "mte", "rms_low", "rms_high", "mte_low", "mte_high"),
    *("difference_value", "difference_low", "difference_high", "probability_larger"),
)
_OTHER_MOTION: Final = 0.3  # of the exact response's RMS, by which that of another test differs
_EVEN: Final = 0.5
_WIDER_STEP: Final = 1e-6  # relative difference of two time steps that are the same


@dataclass(frozen=True, kw_only=True, eq=False)
class RankedTest(PlainResult):
    """A test in its place among others."""

    keys: ClassVar[Keys] = {
        **same_names("rank", "file"),
        **{name: f"assessment.error.{name}" for name in ("rms", "mte")},
        **same_names("difference", "probability_larger"),
        "A": "tracking.amplitude",
        "d_ms": "tracking.delay",
        **{name: f"assessment.{name}" for name in ("verdict", "probability")},
    }

    rank: int  # From 1 on

    file: str  # The test
    assessment: Assessment | FrameAssessment  # What is found about it
    error: Estimate  # Its error with the 90 % interval [-]
    # By how much its error exceeds that of the first test: median and 90 % interval [-]; None for the first
    difference: Estimate | None
    probability_larger: float | None  # That it is larger than that of the first test; None for the first

    @property
    def tracking(self) -> "TrackingIndex | ActuatorOfTest":
        """A and d, of several actuators those of the one that tracks worst."""
        if isinstance(self.assessment, FrameAssessment):
            return self.assessment.worst_actuator
        return self.assessment.tracking


def _interval(size: Mapping[str, Any] | None) -> str:
    return "" if size is None else percent_with_interval(**size)


@dataclass(frozen=True, kw_only=True, eq=False)
class Comparison(ResultWithRows):
    """Tests ranked by their errors."""

    rows_in = "tests"
    table_columns: ClassVar[Columns] = {
        "Test": ("file", ""),
        "RMS error (90 % interval)": ("rms", _interval),
        "Largest error (90 % interval)": ("mte", _interval),
        "More than the first": ("difference", _interval),
        "Probability of that": ("probability_larger", lambda p: "" if p is None else significant(p, 3)),
        "A": ("A", ".4f"),
        "d [ms]": ("d_ms", ".3f"),
        "Verdict": ("verdict", lambda word: Word(word).phrase, "left"),
    }

    metric: Metric  # Which error
    threshold: float  # Error with which each test is compared [-]
    tests: tuple[RankedTest, ...]  # The one whose error is probably smallest first
    faults: Mapping[str, str]  # By file, why others could not be judged
    notes: tuple[str, ...]  # What limits the comparison, in sentences
    assumed: str = _COMMON_ASSUMPTION  # What is taken to be the same in all tests, in a sentence

    def to_dataframe(self) -> "pd.DataFrame":
        """Put the ranking into a table, one row for each test."""
        names = {"rms_value": "rms", "mte_value": "mte"}
        return super().to_dataframe().rename(columns=names)[list(_COLUMNS)]

    def plot(self, axes: "Axes | None" = None) -> "Axes":
        """Draw the error of each test with its 90 % interval [%], the smallest above, and the threshold."""
        return plot_errors({test.file: test.error for test in self.tests}, self.metric, self.threshold, axes)


def rank_tests(
    assessments: Mapping[str, Assessment | FrameAssessment], faults: Mapping[str, str] | None = None
) -> Comparison:
    """Rank tests of one structure and rig by their errors, the smallest first; fewer than two are refused.

    `assessments`: by file, what was found about each, with one metric and threshold; `faults`: why others
    were not judged.
    """
    if len(assessments) < _FEWEST:
        raise InputError(
            "Comparing needs at least two tests that can be judged",
            value=len(assessments),
            remedy=" ".join((faults or {}).values()).removesuffix(".") or "Name another test",
        )
    metric, threshold = next(
        (assessment.error.metric, assessment.error.threshold) for assessment in assessments.values()
    )
    order = _order_files({file: assessment.error for file, assessment in assessments.items()}, metric)
    first = assessments[order[0]].error
    tests = tuple(
        _rank_test(rank, file, assessments[file], first, metric) for rank, file in enumerate(order, start=1)
    )
    return Comparison(
        metric=metric,
        threshold=threshold,
        tests=tests,
        faults=dict(faults or {}),
        notes=tuple(_notes(tests)),
    )


def _rank_test(
    rank: int, file: str, assessment: Assessment | FrameAssessment, first: ErrorOfTest, metric: Metric
) -> RankedTest:
    error = assessment.error
    difference = probability = None
    if error is not first:
        differences, weights = subtract_errors(error, first, metric)
        low, middle, high = weighted_quantiles(differences, weights, ENDS[0], _EVEN, ENDS[1])
        difference = Estimate(value=middle, low=low, high=high)
        probability = _probability_larger(differences, weights)
    return RankedTest(
        rank=rank,
        file=file,
        assessment=assessment,
        error=error.estimate(metric),
        difference=difference,
        probability_larger=probability,
    )


def _order_files(errors: Mapping[str, ErrorOfTest], metric: Metric) -> list[str]:
    """Order tests so that each is probably better than those after it.

    By the number of tests that it is probably better than, then by the sum of these probabilities: errors
    that what is unknown moves together may be ordered otherwise than their values.
    """
    better = {
        file: [
            _probability_larger(*subtract_errors(rival, error, metric))
            for rival in errors.values()
            if rival is not error
        ]
        for file, error in errors.items()
    }
    return sorted(errors, key=lambda file: (-sum(p > _EVEN for p in better[file]), -sum(better[file])))


def _probability_larger(differences: Array, weights: Array) -> float:
    """Probability that a difference is positive, equal errors counting half."""
    positive = float(weights[differences > 0.0].sum() + _EVEN * weights[differences == 0.0].sum())
    larger = (positive + _EVEN) / (weights.size + 1.0)
    return min(max(larger, 1.0 - _LARGEST_PROBABILITY), _LARGEST_PROBABILITY)


def subtract_errors(error: ErrorOfTest, first: ErrorOfTest, metric: Metric) -> tuple[Array, Array]:
    """Subtract two errors in draws of what is unknown; return that with its weights, each shape (draws,).

    Draws are paired where the same quantities are unknown in both tests; else one of them is shuffled, as if
    they had nothing in common. A pair has the geometric mean of the weights of its two draws, so that kinds
    of draws, such as specimens that yielded, keep their share of the probability.
    """
    draws, first_draws = error.rebuilt.draws, first.rebuilt.draws
    errors, firsts = draws.errors(metric), first_draws.errors(metric)
    weights, first_weights = draws.weights, first_draws.weights
    count = min(errors.size, firsts.size)
    order = np.arange(count)
    if not _have_in_common(error, first):
        order = np.random.default_rng(0).permutation(count)
    joint = np.sqrt(weights[:count] * first_weights[order])
    return errors[:count] - firsts[order], joint / joint.mean()


def _have_in_common(error: ErrorOfTest, first: ErrorOfTest) -> bool:
    """Whether the same quantities are unknown in both, so that draws of them can be paired."""
    unknown = [list(test.rebuilt.inferred.posterior.means) for test in (error, first)]
    return unknown[0] == unknown[1]


def _notes(tests: Sequence[RankedTest]) -> list[str]:
    """Say where tests differ in more than their errors."""
    reference = tests[0].assessment.error.reference
    step = tests[0].assessment.recording.time_step
    other_files = [
        test.file
        for test in tests[1:]
        if abs(test.assessment.recording.time_step / step - 1.0) > _WIDER_STEP
        or _differs(test.assessment.error.reference, reference)
    ]
    notes = []
    if other_files:
        notes.append(
            f"The exact responses of {', '.join(other_files)} and of {tests[0].file} differ: these tests had "
            "different ground motions or scales, and the order of their errors does not depend on their "
            "compensators alone."
        )
    first = tests[0].assessment.error
    unlike_files = [test.file for test in tests[1:] if not _have_in_common(test.assessment.error, first)]
    if unlike_files:
        notes.append(
            f"Other quantities are unknown in {', '.join(unlike_files)} than in {tests[0].file}: no unknown "
            "property is assumed to be common to these tests, and their differences are less certain."
        )
    smaller = [test.file for test in tests[1:] if test.error.value < tests[0].error.value]
    if smaller:
        notes.append(
            f"The value of {', '.join(smaller)} is smaller than that of {tests[0].file}, whose error is "
            "probably the smaller one: what is unknown acts on them differently."
        )
    second = tests[1]
    if second.probability_larger is not None and second.probability_larger < 0.5 + 0.5 * LEVEL:
        notes.append(
            f"{tests[0].file} and {second.file} cannot be told apart: the probability that the first has the "
            f"smaller error is {significant(second.probability_larger, 2)}."
        )
    return notes


def _differs(response: Array, reference: Array) -> bool:
    """Whether two responses are those of different motions, whenever their recordings began [m]."""
    products = cross_correlate(response, reference)
    squares = float(np.sum(reference**2)), float(np.sum(response**2))
    variance = squares[0] + squares[1] - 2.0 * float(products.max())
    return variance > _OTHER_MOTION**2 * min(squares)
