"""A test among the motions behind its criterion: in the (A, d) plane, and by its length and response."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from reliab.assessment.default_criterion import SOURCE, criterion_of_response
from reliab.assessment.error_of_test import Question
from reliab.assessment.tracking_index import TrackingIndex
from reliab.core.arrays import Array
from reliab.core.plain_values import PlainResult
from reliab.core.vocabulary import Metric, Side
from reliab.criterion.criterion import Criterion
from reliab.criterion.laws.law import Validity
from reliab.criterion.response_measures import ResponseMeasures
from reliab.criterion.scope import Position, compare_with_scope
from reliab.recordings.recording import Recording
from reliab.structures.structure import Structure
from reliab.tracking.boundary.first_order import ellipse_of_response

LARGEST_PROBABILITY: Final = 0.99
"""Largest probability stated for a population of ground motions: higher ones were not validated."""

_DRAWS = 200


def cap_probability(probability: float | None) -> float | None:
    """Probability limited to the range that was validated; None where it is not known.

    >>> cap_probability(1.0), cap_probability(0.4), cap_probability(None)
    (0.99, 0.4, None)
    """
    if probability is None:
        return None
    return min(max(probability, 1.0 - LARGEST_PROBABILITY), LARGEST_PROBABILITY)


@dataclass(frozen=True, kw_only=True)
class Placement:
    """A test against a criterion."""

    # a, b: Limits [-] and [ms²] of the structure, on the test's side where the criterion has limits for it
    a: float
    b: float
    # (A − 1)²/a + d²/b; the test is accepted up to 1. None where the test leads and the criterion has no
    # limits for leads
    index: float | None
    index_interval: tuple[float, float] | None  # 95 % interval of the index; None likewise
    # Probability that the error stays below the threshold, over ground motions and over what noise leaves
    # open of A and d; None where no motions stand behind the criterion
    probability: float | None
    # Structure [Hz, -] from which the criterion was carried over, if the test's lies outside
    carried_from: tuple[float, float] | None

    @property
    def amplitude_limit(self) -> float:
        """Tolerable |A − 1| [-] without delay."""
        return float(np.sqrt(self.a))

    @property
    def delay_limit_ms(self) -> float:
        """Tolerable delay [ms] without amplitude error."""
        return float(np.sqrt(self.b))

    @property
    def accepted(self) -> bool | None:
        """Whether the test is accepted; None where it has no index."""
        return None if self.index is None else self.index <= 1.0

    @property
    def capped_probability(self) -> float | None:
        """Probability as far as it was validated."""
        return cap_probability(self.probability)

    @property
    def is_carried(self) -> bool:
        """Whether the criterion was carried over from another structure."""
        return self.carried_from is not None


@dataclass(frozen=True, kw_only=True)
class _NearestStructure:
    """The nearest valid structure, and the scaling of errors from one structure to the other."""

    frequency: float
    damping_ratio: float
    amplitude_factor: float
    delay_factor: float

    @classmethod
    def clip(cls, validity: Validity, structure: Structure) -> "_NearestStructure":
        """Clip a structure; errors keep their dimensionless size, (A − 1)/ξ and dω₀/ξ."""
        f = float(np.clip(structure.frequency, *validity.frequency))
        xi = float(np.clip(structure.damping_ratio, *validity.damping_ratio))
        factor = xi / structure.damping_ratio
        return cls(
            frequency=f,
            damping_ratio=xi,
            amplitude_factor=factor,
            delay_factor=factor * structure.frequency / f,
        )

    def errors(
        self, amplitude: NDArray[np.float64], delay: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], float, float]:
        """Return A [-], d [s] and the structure [Hz, -] as criteria take them."""
        scaled_errors = 1.0 + self.amplitude_factor * (amplitude - 1.0), self.delay_factor * delay
        return *scaled_errors, self.frequency, self.damping_ratio


def place(
    criterion: Criterion, structure: Structure, amplitude: float, delay: float, draws: NDArray[np.float64]
) -> Placement:
    """Place a test against a criterion."""
    nearest = _NearestStructure.clip(criterion.law.validity, structure)
    side = Side.LEAD if delay < 0.0 else Side.LAG
    knows_leads = criterion.knows_leads
    if not knows_leads and float(np.quantile(draws[1], 0.975)) < 0.0:
        a, b, carried_from = scale_limits(criterion, structure)
        return Placement(
            a=a, b=b, index=None, index_interval=None, probability=None, carried_from=carried_from
        )
    if not knows_leads:  # no lead that noise does not explain: the limits for lags begin at d = 0
        delay, side = max(delay, 0.0), Side.LAG
        draws = np.stack([draws[0], np.maximum(draws[1], 0.0)])
    a, b, carried_from = scale_limits(criterion, structure, side)
    index = criterion.index(*nearest.errors(np.array([amplitude]), np.array([delay])))
    spread = criterion.index(*nearest.errors(draws[0], draws[1]))
    low, high = np.quantile(spread, [0.025, 0.975]).tolist()
    return Placement(
        a=a,
        b=b,
        index=float(index[0]),
        index_interval=(low, high),
        probability=_probability(criterion, structure, draws[:, :_DRAWS]),
        carried_from=carried_from,
    )


def scale_limits(
    criterion: Criterion, structure: Structure, side: Side = Side.LAG
) -> tuple[float, float, tuple[float, float] | None]:
    """Limits of any structure, scaled from the nearest structure for which the criterion is valid.

    Returns a [-] and b [ms²], of which a/ξ² and bω₀²/ξ² are those of the nearest valid structure, and that
    structure [Hz, -] if it is another one.
    """
    criterion.require_converged()
    nearest = _NearestStructure.clip(criterion.law.validity, structure)
    a, b = (float(limit) for limit in criterion.limits(nearest.frequency, nearest.damping_ratio, side))
    place = nearest.frequency, nearest.damping_ratio
    is_outside = place != (structure.frequency, structure.damping_ratio)
    return a / nearest.amplitude_factor**2, b / nearest.delay_factor**2, place if is_outside else None


def _probability(criterion: Criterion, structure: Structure, draws: NDArray[np.float64]) -> float | None:
    if criterion.population is None:
        return None
    nearest = _NearestStructure.clip(criterion.population.validity, structure)
    return float(np.mean(criterion.probability(*nearest.errors(draws[0], draws[1]))))


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
