"""A test against the boundary of its own ground motion, over the stretch of the record that it saw."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from reliab.assessment.alignment import Alignment, PaddedMotion
from reliab.assessment.error_of_test import Question
from reliab.assessment.placement import Placement
from reliab.assessment.tracking_index import LEVEL, TrackingIndex
from reliab.core.errors import InputError
from reliab.core.vocabulary import Metric, Side
from reliab.motions.motion import Motion
from reliab.simulation.engine import Loop
from reliab.simulation.excitation import Excitation
from reliab.structures.structure import Structure
from reliab.tracking.boundary.contour import Contour
from reliab.tracking.boundary.curves import InscribedEllipse
from reliab.tracking.boundary.suite_boundary import motion_contours
from reliab.tracking.indices.response_error import relative_error

_DRAWS = 200


@dataclass(frozen=True, kw_only=True, eq=False)
class OwnPlacement(Placement):
    """A test against the boundary of its own ground motion."""

    motion: str  # The ground motion
    alignment: Alignment  # Where in its record the test began
    window: tuple[float, float]  # Begin and end of the window of the error on the record's time axis [s]
    error: float  # Error of a test with this A and d under this motion [-]
    error_interval: tuple[float, float]  # Its 95 % interval
    index: float  # 1 on the boundary, growing with the square of the distance
    index_interval: tuple[float, float]  # Its 95 % interval, the index growing with the square of the error
    # `a`, `b`: Ellipse inscribed in the boundary on the test's side, lag or lead; `probability`: over what
    # noise leaves open of A and d
    probability: float
    carried_from: None = None


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
    record = PaddedMotion.around(motion, end - begin)
    if alignment.from_rest:
        record = record.cut(begin + record.before, end + record.before)
    window = max(begin + record.before, 0.0), end + record.before
    return (
        Excitation(acceleration=record.acceleration, time_step=record.time_step, window=window),
        (begin, end),
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class OwnBoundary:
    """The boundary for one ground motion and structure, against which tests are placed."""

    excitation: Excitation  # The ground motion of the test, with the window of the error
    structure: Structure  # The structure
    threshold: float  # Error of the whole test [-]
    metric: Metric  # Which error

    @cached_property
    def _loop(self) -> Loop:
        return Loop(excitation=self.excitation, structure=self.structure)

    def contour(self, side: Side = Side.LAG) -> Contour:
        """Amplitude [-] and delay [s], negative for leads, along one side of the boundary."""
        return motion_contours(self._loop, (self.threshold,), self.metric, side=side)[0]

    def ellipse(self, side: Side = Side.LAG) -> tuple[float, float]:
        """Parameters a [-] and b [ms²] of the ellipse inscribed in one side of the boundary."""
        fit = InscribedEllipse.fit(self.contour(side))
        return fit.a, fit.b

    def error(self, amplitude: NDArray[np.float64], delay: NDArray[np.float64]) -> NDArray[np.float64]:
        """Error of tests with given A [-] and d [s], negative where they lead, shape (tests,)."""
        loop = self._loop
        cells = loop.cells(gain=np.asarray(amplitude), delay=np.asarray(delay))
        return relative_error(loop.deviation(cells), self.metric)

    def index(self, amplitude: float, delay: float) -> float:
        """Index of a test, which is 1 on the boundary and grows with the square of the distance.

        Returns 1/s², the boundary lying at s times the test's distance from the perfect one.
        """
        from scipy.optimize import elementwise

        loop, offset = self._loop, amplitude - 1.0
        if offset == 0.0 and delay == 0.0:
            return 0.0

        def excess(logarithm: NDArray[np.float64]) -> NDArray[np.float64]:
            share = np.exp(logarithm)
            gain = np.maximum(1.0 + share * offset, 1e-3)
            error = relative_error(loop.deviation(loop.cells(gain=gain, delay=share * delay)), self.metric)
            return np.nan_to_num(error, nan=1e3, posinf=1e3) - self.threshold

        bracket = elementwise.bracket_root(excess, np.array([-0.1]), np.array([0.1]))
        if not bool(bracket.success[0]):
            raise InputError(
                "A and d of the test lie in a direction in which this ground motion sets no limit",
                value=f"A = {amplitude:g}, d = {delay:g} s",
                remedy="Check command and measured displacement",
            )
        root = elementwise.find_root(excess, bracket.bracket)
        return float(np.exp(-2.0 * root.x[0]))
