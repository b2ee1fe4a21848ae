"""A test compared with the motions behind its criterion, and the criterion for its own response."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from reliab.arrays import Array
from reliab.assessment.default_criterion import criterion_of_response
from reliab.assessment.placement import Placement, place
from reliab.assessment.tracking_index import TrackingIndex
from reliab.boundary import ellipse_of_response
from reliab.criterion import Criterion, Position, compare_with_scope
from reliab.recordings import Recording
from reliab.structures import Structure
from reliab.vocabulary import Metric


@dataclass(frozen=True, kw_only=True)
class ScopeOfTest:
    """Where a test lies among the motions behind its criterion.

    Attributes
    ----------
    position : Position, optional
        The least favourable of all quantities; None where the criterion does not state its motions.
    sentences : tuple of str
        One for each quantity that is not inside.
    test : mapping of str to float
        The quantities of the test: `length` [s], `cycles`, and `effective_duration` [s] of its response.
    population : mapping of str to sequence of float
        Least value, 5 % and 95 % quantile and greatest value of these over the motions.
    """

    position: Position | None
    sentences: tuple[str, ...]
    test: Mapping[str, float]
    population: Mapping[str, Sequence[float]]

    @property
    def outside(self) -> bool:
        """Whether the criterion says nothing of such tests."""
        return self.position is Position.OUTSIDE

    def to_dict(self) -> dict[str, Any]:
        """Plain values with stable keys."""
        return {
            "position": None if self.position is None else str(self.position),
            "sentences": list(self.sentences),
            "test": dict(self.test),
            "population": {name: list(values) for name, values in self.population.items()},
        }


def scope_of_test(criterion: Criterion, test: Mapping[str, float]) -> ScopeOfTest:
    """Compare the quantities of a test with those of the motions behind a criterion."""
    scope = {name: values for name, values in criterion.provenance.scope.items() if name in test}
    if not scope:
        return ScopeOfTest(position=None, sentences=(), test=test, population={})
    compared = compare_with_scope(scope, test)
    return ScopeOfTest(position=compared.position, sentences=compared.sentences, test=test, population=scope)


def quantities_of_test(recording: Recording, structure: Structure, reference: Array) -> dict[str, float]:
    """Length [s] and number of cycles of a test, and the effective duration [s] of its exact response."""
    shown = ellipse_of_response(reference, recording.time_step, structure)
    return {
        "length": recording.duration,
        "cycles": recording.duration * structure.frequency,
        "effective_duration": shown.effective_duration,
    }


def place_by_response(
    recording: Recording,
    structure: Structure,
    reference: Array,
    criterion: Criterion,
    tracking: TrackingIndex,
) -> Placement | None:
    """Place a test against the motions that ship, carried to its own exact response, shape (n,).

    None where they cannot be carried: for an error other than RMS^R, a partly numerical structure, one beyond
    those that ship, or a response outside of theirs.
    """
    if criterion.metric != Metric.RMS:
        return None
    shown = ellipse_of_response(reference, recording.time_step, structure)
    own = criterion_of_response(
        shown, structure, threshold=criterion.threshold, confidence=criterion.confidence
    )
    if own is None or own.provenance.position == Position.OUTSIDE:
        return None
    return place(own, structure, tracking.amplitude, tracking.delay, tracking.draws)
