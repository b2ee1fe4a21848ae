"""Boundaries of RMS^R of one structure under many ground motions, traced together.

What depends on the actuator alone is computed for the actuators of all motions at once; the error under each
motion is then a quadratic form (`simulation/linear_loop/pole_plane`). An actuator and motion for which that
is not precise enough are simulated. The reduction to the dominant pole is checked at the points of the
resulting contours; a motion for which it is not accurate enough there is traced separately
(`motion_boundary`).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reliab.boundary.contour import Contour, trace_contours
from reliab.boundary.motion_boundary import motion_contours
from reliab.simulation import Engine, Loop
from reliab.simulation.linear_loop import Cells, block_length
from reliab.simulation.linear_loop.pole_plane import mean_squares
from reliab.vocabulary import Metric, Side


def suite_contours(
    loops: Sequence[Loop], thresholds: Sequence[float], side: Sequence[Side]
) -> list[list[Contour]]:
    """Contours of equal RMS^R of one structure under many ground motions.

    Parameters
    ----------
    loops : sequence of Loop
        The same structure under each motion.
    thresholds : sequence of float
        Errors on the contours [-].
    side : sequence of Side
        Side of each contour.

    Returns
    -------
    list of list of Contour
        For each motion the contour of each threshold, as `motion_contours` gives them.
    """
    together = [place for place, loop in enumerate(loops) if _is_regular(loop)]
    contours: dict[int, list[Contour]] = {}
    if together:
        suite = _Suite(loops=[loops[place] for place in together], contours_of_motion=len(thresholds))
        traced = trace_contours(
            suite.error,
            np.tile(np.asarray(thresholds, dtype=np.float64), len(together)),
            loops[0].structure,
            side=list(side) * len(together),
        )
        for rank, place in enumerate(together):
            of_motion = traced[rank * len(thresholds) : (rank + 1) * len(thresholds)]
            if _is_reducible(loops[place], of_motion):
                contours[place] = of_motion
    return [
        contours[place] if place in contours else motion_contours(loop, thresholds, Metric.RMS, side=side)
        for place, loop in enumerate(loops)
    ]


@dataclass(frozen=True, kw_only=True)
class _Suite:
    """Loops of one structure, each with the same number of contours."""

    loops: Sequence[Loop]
    contours_of_motion: int

    def error(
        self, amplitude: NDArray[np.float64], delay: NDArray[np.float64], contour: NDArray[np.int64]
    ) -> NDArray[np.float64]:
        """RMS^R of actuators, each under the motion of its contour."""
        cells = Cells(structure=self.loops[0].structure, gain=amplitude, delay=delay)
        motion = contour // self.contours_of_motion
        squares, known = mean_squares(
            [loop.responses for loop in self.loops], cells.expansions(self.loops[0].blocks.step), motion
        )
        for place in np.unique(motion[~known]):
            which = np.flatnonzero(~known & (motion == place))
            loop = self.loops[place]
            rest = loop.cells(gain=amplitude[which], delay=delay[which])
            squares[which] = loop.deviation(rest).mean_square
        peaks = np.array([loop.blocks.ideal_peak for loop in self.loops])
        return np.asarray(np.sqrt(squares) / peaks[motion])


def _is_regular(loop: Loop) -> bool:
    """Whether a loop may be solved by its dominant pole, in blocks of the length that suits the structure."""
    by_pole = loop.engine in (Engine.AUTOMATIC, Engine.POLE)
    return by_pole and loop.blocks.step == block_length(loop.structure)


def _is_reducible(loop: Loop, contours: Sequence[Contour]) -> bool:
    """Whether the reduction to the dominant pole is accurate enough at all points of contours."""
    gain = np.concatenate([contour.amplitude for contour in contours])
    delay = np.concatenate([contour.delay for contour in contours])
    return gain.size == 0 or bool(loop.reducible(loop.cells(gain=gain, delay=delay)).all())
