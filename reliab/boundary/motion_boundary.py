"""The boundary of one ground motion, traced by solving the loop for each actuator."""

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from reliab.boundary.contour import AMPLITUDE_STEP, Contour, trace_contours
from reliab.indices import relative_error
from reliab.simulation import Deviation
from reliab.simulation.linear_loop import Cells
from reliab.structures import Structure
from reliab.vocabulary import Metric, Side


class SolvedLoop(Protocol):
    """A loop under one ground motion that can be solved for any actuator, with effects or without."""

    @property
    def structure(self) -> Structure:
        """The structure under test."""

    def cells(self, *, gain: object, delay: object) -> Cells:
        """Actuators of given gains [-] and delays [s], negative for a lead."""

    def deviation(self, cells: Cells) -> Deviation:
        """Deviation of the measured displacement from the exact response."""

    def at_rest(self) -> Deviation:
        """Deviation of an actuator that does not move."""


def motion_contours(
    loop: SolvedLoop,
    thresholds: Sequence[float] = (0.05,),
    metric: Metric = Metric.RMS,
    *,
    amplitude_step: float = AMPLITUDE_STEP,
    side: Side | Sequence[Side] = Side.LAG,
) -> list[Contour]:
    """Contours of equal error of one ground motion and one structure.

    Parameters
    ----------
    loop : Loop or EffectLoop
        Structure, record and window.
    thresholds : sequence of float, optional
        Errors on the contours [-], 5 % by default.
    metric : Metric, optional
        RMS^R (default) or MTE^R.
    amplitude_step : float, optional
        Step of the amplitude [-], the paper's 0.001 by default; at least eleven points are found.
    side : Side or sequence of Side, optional
        Side of all contours, or of each; actuators that are late by default.

    Returns
    -------
    list of Contour
        Amplitude [-] and delay [s], negative for leads, along the contour of each threshold; gain and delay
        of the actuator alone where the loop has further effects.
    """

    def error(
        amplitude: NDArray[np.float64], delay: NDArray[np.float64], _: NDArray[np.int64]
    ) -> NDArray[np.float64]:
        return relative_error(loop.deviation(loop.cells(gain=amplitude, delay=delay)), metric)

    levels = np.asarray(thresholds, dtype=np.float64)
    return trace_contours(error, levels, loop.structure, amplitude_step=amplitude_step, side=side)
