"""A test against the boundary of its own ground motion, over the stretch of the record that it saw."""

from dataclasses import dataclass

import numpy as np

from reliab.assessment.alignment import Alignment, Padded
from reliab.assessment.error_of_test import Question
from reliab.assessment.own_boundary import OwnBoundary
from reliab.assessment.tracking_index import LEVEL, TrackingIndex
from reliab.motions import Motion
from reliab.simulation import Excitation
from reliab.vocabulary import Side

_DRAWS = 200


@dataclass(frozen=True, kw_only=True, eq=False)
class OwnPlacement:
    """A test against the boundary of its own ground motion."""

    motion: str  # The ground motion
    alignment: Alignment  # Where in its record the test began
    window: tuple[float, float]  # Begin and end of the window of the error on the record's time axis [s]
    error: float  # Error of a test with this A and d under this motion [-]
    error_interval: tuple[float, float]  # Its 95 % interval
    index: float  # 1 on the boundary, growing with the square of the distance
    index_interval: tuple[float, float]  # Its 95 % interval, the index growing with the square of the error
    # Probability that the error stays below the threshold, over what noise leaves open of A and d
    probability: float
    a: float  # a, b: Ellipse inscribed in the boundary on the test's side, lag or lead, [-] and [ms²]
    b: float


def place_on_own(
    motion: Motion,
    tracking: TrackingIndex,
    alignment: Alignment,
    question: Question,
) -> OwnPlacement:
    """Place a test against its own ground motion's boundary."""
    excitation, bounds = _excitation(motion, alignment)
    boundary = OwnBoundary(
        excitation=excitation,
        structure=question.structure,
        threshold=question.threshold,
        metric=question.metric,
    )
    error = float(boundary.error(np.array([tracking.amplitude]), np.array([tracking.delay]))[0])
    index = boundary.index(tracking.amplitude, tracking.delay)
    errors = boundary.error(*tracking.draws[:, :_DRAWS])
    low, high = np.quantile(errors, [0.5 * (1.0 - LEVEL), 0.5 * (1.0 + LEVEL)]).tolist()
    a, b = boundary.ellipse(Side.LEAD if tracking.delay < 0.0 else Side.LAG)
    return OwnPlacement(
        motion=motion.name,
        alignment=alignment,
        window=bounds,
        error=error,
        error_interval=(low, high),
        index=index,
        index_interval=(index * (low / error) ** 2, index * (high / error) ** 2) if error else (0.0, 0.0),
        probability=float(np.mean(errors <= question.threshold)),
        a=a,
        b=b,
    )


def _excitation(motion: Motion, alignment: Alignment) -> tuple[Excitation, tuple[float, float]]:
    """Ground acceleration with the stretch that the test saw, and that stretch in the record [s]."""
    begin, end = alignment.begin, alignment.end
    record = Padded.around(motion, end - begin)
    if alignment.from_rest:
        record = record.cut(begin + record.before, end + record.before)
    seen = max(begin + record.before, 0.0), end + record.before
    return (
        Excitation(acceleration=record.acceleration, time_step=record.time_step, window=seen),
        (begin, end),
    )
