"""A test compared with the motions behind its criterion, and the criterion for its own response."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from reliab.assessment.default_criterion import SOURCE, criterion_of_response
from reliab.assessment.error_of_test import Question
from reliab.assessment.placement import Placement, place
from reliab.assessment.tracking_index import TrackingIndex
from reliab.core.arrays import Array
from reliab.core.plain_values import PlainResult
from reliab.core.vocabulary import Metric
from reliab.criterion.criterion import Criterion
from reliab.criterion.response_measures import ResponseMeasures
from reliab.criterion.scope import Position, compare_with_scope
from reliab.recordings.recording import Recording
from reliab.structures.structure import Structure
from reliab.tracking.boundary.first_order import ellipse_of_response


@dataclass(frozen=True, kw_only=True)
class ScopeOfTest(PlainResult):
    """Where a test lies among the motions behind its criterion."""

    position: Position | None  # Least favourable of all quantities; None where the motions are not stated
    sentences: tuple[str, ...]  # One for each quantity that is not inside
    # `length` [s] and `cycles` of the test; of its response `effective_duration` [s], `frequency_ratio` [-]
    # and `sensitivity` [-]
    test: Mapping[str, float]
    # Least value, 5 % and 95 % quantile and greatest value of these over the motions
    population: Mapping[str, Sequence[float]]

    @property
    def is_outside(self) -> bool:
        """Whether the criterion says nothing of such tests."""
        return self.position is Position.OUTSIDE


def scope_of_test(
    criterion: Criterion, recording: Recording, structure: Structure, reference: Array | None = None
) -> ScopeOfTest:
    """Compare a test with the motions behind a criterion.

    `reference`: exact response of the structure (n,), which is compared too.
    """
    test = {"length": recording.duration, "cycles": recording.duration * structure.frequency}
    if reference is not None:
        ellipse = ellipse_of_response(reference, recording.time_step, structure)
        test_measures = ResponseMeasures.from_response(ellipse, structure, "this test").measure_values
        test |= {name: float(value.item()) for name, value in test_measures.items()}
    return compare_test(criterion, test)


def compare_test(criterion: Criterion, test: Mapping[str, float]) -> ScopeOfTest:
    """Compare the quantities of a test with those of the motions behind a criterion."""
    scope = {name: values for name, values in criterion.provenance.scope.items() if name in test}
    if not scope:
        return ScopeOfTest(position=None, sentences=(), test=test, population={})
    comparison = compare_with_scope(scope, test)
    return ScopeOfTest(
        position=comparison.position, sentences=comparison.sentences, test=test, population=scope
    )


def reasons_without_promise(scope: ScopeOfTest, criterion: Criterion) -> tuple[str, ...]:
    """Why a criterion promises nothing for a test: for its own quantities, or for the criterion's case."""
    if scope.is_outside:
        return scope.sentences
    reason = "The criterion itself is for a case outside of its population."
    if criterion.provenance.position != Position.OUTSIDE:
        reason = "The criterion was asked for a share too small to be promised."
    return (*scope.sentences, reason)


def place_by_response(
    recording: Recording, question: Question, reference: Array, criterion: Criterion, tracking: TrackingIndex
) -> Placement | None:
    """Place a test against the motions that ship, carried to its own exact response, shape (n,).

    None where they cannot be carried: for an error other than RMS^R, a partly numerical or nonlinear
    structure, one beyond those that ship, a criterion of other motions, or a response outside of theirs.
    """
    is_shipped = criterion.provenance.source == SOURCE and criterion.promise is not None
    if not is_shipped or question.metric != Metric.RMS or not question.linear:
        return None
    structure = question.structure
    ellipse = ellipse_of_response(reference, recording.time_step, structure)
    own_criterion = criterion_of_response(
        ellipse,
        structure,
        threshold=criterion.threshold,
        confidence=criterion.confidence,
        tracking=(tracking.amplitude, tracking.delay),
    )
    if own_criterion is None or own_criterion.provenance.position == Position.OUTSIDE:
        return None
    return place(own_criterion, structure, tracking.amplitude, tracking.delay, tracking.draws)
