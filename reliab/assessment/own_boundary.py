"""The boundary of the test's own ground motion, exact by simulation."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from reliab.boundary import Contour, InscribedEllipse, motion_contours
from reliab.errors import InputError
from reliab.indices import relative_error
from reliab.simulation import Excitation, Loop
from reliab.structures import Structure
from reliab.vocabulary import Metric, Side


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
                "The test must lie on a ray that meets the boundary",
                value=f"A = {amplitude:g}, d = {delay:g} s",
                remedy="Check command and measured displacement",
            )
        root = elementwise.find_root(excess, bracket.bracket)
        return float(np.exp(-2.0 * root.x[0]))
