"""Boundaries of one structure, traced by solving the loop for each actuator, under one ground motion or many.

For RMS^R under many motions, what depends on the actuator alone is computed for the actuators of all motions
at once; the error under each motion is then a quadratic form (`simulation/linear_loop/pole_plane`). An
actuator and motion for which that is not precise enough are simulated. The reduction to the dominant pole is
checked at the points of the resulting contours; a motion for which it is not accurate enough there is traced
by itself.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.vocabulary import Metric, Side
from reliab.simulation.engine import Engine, Loop
from reliab.simulation.excitation import Deviation
from reliab.simulation.linear_loop.blocks import block_length
from reliab.simulation.linear_loop.cells import Cells
from reliab.simulation.linear_loop.pole_plane import mean_squares
from reliab.structures.structure import Structure
from reliab.tracking.boundary.contour import AMPLITUDE_STEP, Contour, trace_contours
from reliab.tracking.indices.response_error import relative_error


class SolvedLoop(Protocol):
    """A loop under one ground motion that can be solved for any actuator, with effects or without."""

    @property
    def structure(self) -> Structure:
        """The structure under test."""

    def cells(self, *, gain: object, delay: object) -> Cells:
        """Actuators of given gains [-] and delays [s], negative for a lead."""

    def deviation(self, cells: Cells) -> Deviation:
        """Deviation of the measured displacement from the exact response."""

    def rest_deviation(self) -> Deviation:
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

    `thresholds`: errors on the contours [-], 5 % by default.
    `metric`: RMS^R (default) or MTE^R.
    `amplitude_step`: step of the amplitude [-], the paper's 0.001 by default; at least eleven points are
    found.
    `side`: side of all contours, or of each; actuators that are late by default.
    Returns amplitude [-] and delay [s], negative for leads, along the contour of each threshold; gain and
    delay of the actuator alone where the loop has further effects.
    """

    def error(amplitude: Array, delay: Array, _: NDArray[np.int64]) -> Array:
        return relative_error(loop.deviation(loop.cells(gain=amplitude, delay=delay)), metric)

    levels = np.asarray(thresholds, dtype=np.float64)
    return trace_contours(error, levels, loop.structure, amplitude_step=amplitude_step, side=side)


def suite_contours(
    loops: Sequence[Loop], thresholds: Sequence[float], side: Sequence[Side]
) -> list[list[Contour]]:
    """Contours of equal RMS^R of one structure under many ground motions.

    `loops`: the same structure under each motion; `thresholds`: errors on the contours [-]. Returns for each
    motion the contour of each threshold, as `motion_contours` gives them.
    """
    regular = [place for place, loop in enumerate(loops) if _is_regular(loop)]
    contours: dict[int, list[Contour]] = {}
    if regular:
        suite = _Suite(loops=[loops[place] for place in regular], contours_of_motion=len(thresholds))
        suite_traces = trace_contours(
            suite.error,
            np.tile(np.asarray(thresholds, dtype=np.float64), len(regular)),
            loops[0].structure,
            side=list(side) * len(regular),
        )
        for rank, place in enumerate(regular):
            motion_traces = suite_traces[rank * len(thresholds) : (rank + 1) * len(thresholds)]
            if _is_reducible(loops[place], motion_traces):
                contours[place] = motion_traces
    return [
        contours[place] if place in contours else motion_contours(loop, thresholds, Metric.RMS, side=side)
        for place, loop in enumerate(loops)
    ]


@dataclass(frozen=True, kw_only=True)
class _Suite:
    """Loops of one structure, each with the same number of contours."""

    loops: Sequence[Loop]
    contours_of_motion: int

    def error(self, amplitude: Array, delay: Array, contour: NDArray[np.int64]) -> Array:
        """RMS^R of actuators, each under the motion of its contour."""
        cells = Cells(structure=self.loops[0].structure, gain=amplitude, delay=delay)
        motion = contour // self.contours_of_motion
        squares, precise = mean_squares(
            [loop.responses for loop in self.loops], cells.expansions(self.loops[0].blocks.step), motion
        )
        for place in np.unique(motion[~precise]):
            motion_cells = np.flatnonzero(~precise & (motion == place))
            loop = self.loops[place]
            cells_of_motion = loop.cells(gain=amplitude[motion_cells], delay=delay[motion_cells])
            squares[motion_cells] = loop.deviation(cells_of_motion).mean_square
        peaks = np.array([loop.blocks.ideal_peak for loop in self.loops])
        return np.asarray(np.sqrt(squares) / peaks[motion])


def _is_regular(loop: Loop) -> bool:
    """Whether a loop may be solved by its dominant pole, in blocks of the length that suits the structure."""
    has_pole_engine = loop.engine in (Engine.AUTOMATIC, Engine.POLE)
    return has_pole_engine and loop.blocks.step == block_length(loop.structure)


def _is_reducible(loop: Loop, contours: Sequence[Contour]) -> bool:
    """Whether the reduction to the dominant pole is accurate enough at all points of contours."""
    gain = np.concatenate([contour.amplitude for contour in contours])
    delay = np.concatenate([contour.delay for contour in contours])
    return gain.size == 0 or bool(loop.reducible(loop.cells(gain=gain, delay=delay)).all())
