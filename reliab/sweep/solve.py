"""One ground motion through a whole grid: the unit of work, of resume and of distribution."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import RectBivariateSpline

from reliab.indices.frequency_evaluation import evaluate_sums
from reliab.indices.response_error import relative_error
from reliab.indices.window import Window
from reliab.loop.cells import Cells
from reliab.loop.engine import Loop
from reliab.loop.excitation import Excitation
from reliab.loop.structure import Structure
from reliab.loop.tracking_sums import QuadraturePair, tracking_sums
from reliab.motions import Motion
from reliab.sweep.grid import Grid
from reliab.sweep.request import SweepRequest
from reliab.vocabulary import Metric

_NODES = 4  # along each axis, at which the evaluation index is summed; it varies little between


@dataclass(frozen=True, kw_only=True)
class MotionResults:
    """Results of one ground motion and one window over (f, xi, kp, tau).

    Attributes
    ----------
    rms, mte : numpy.ndarray
        Errors of the whole test [-].
    A : numpy.ndarray
        Amplitude of the evaluation index [-].
    d : numpy.ndarray
        Equivalent delay [s].
    stable : numpy.ndarray
        Whether the delay is below the critical delay.
    """

    rms: NDArray[np.float32]
    mte: NDArray[np.float32]
    A: NDArray[np.float32]
    d: NDArray[np.float32]
    stable: NDArray[np.bool_]


VARIABLES = ("rms", "mte", "A", "d", "stable")


@lru_cache(maxsize=256)
def _cells(grid: Grid, structure: Structure) -> Cells:
    """Cells of a structure, worked out once for all motions."""
    return grid.cells(structure)


def solve_motion(motion: Motion, request: SweepRequest) -> list[MotionResults]:
    """Simulate one ground motion for all structures and actuators.

    Parameters
    ----------
    motion : Motion
        The ground motion.
    request : SweepRequest
        Structures, grid and windows.

    Returns
    -------
    list of MotionResults
        One for each window.
    """
    return [_solve_window(motion, request, window) for window in request.windows]


def _solve_window(motion: Motion, request: SweepRequest, window: Window) -> MotionResults:
    bounds = window.bounds(motion.acceleration, motion.time_step)
    excitation = Excitation(acceleration=motion.acceleration, time_step=motion.time_step, window=bounds)
    pair = QuadraturePair.of(excitation)
    tables = [_solve_structure(excitation, pair, request, structure) for structure in request.structures]
    shape = (len(request.frequencies), len(request.damping_ratios))
    columns = {
        name: np.stack([table[name] for table in tables]).reshape(shape + tables[0][name].shape)
        for name in VARIABLES
    }
    return MotionResults(**columns)


def _solve_structure(
    excitation: Excitation, pair: QuadraturePair, request: SweepRequest, structure: Structure
) -> dict[str, NDArray[np.generic]]:
    cells = _cells(request.grid, structure)
    shape = (request.grid.gains(structure).size, request.grid.delays(structure).size)
    found = Loop(excitation=excitation, structure=structure, engine=request.engine).deviation(cells)
    amplitude, delay = _evaluate(pair, request.grid, structure)
    with np.errstate(over="ignore"):  # a violently unstable cell becomes infinite on disk
        return {
            "rms": relative_error(found, Metric.RMS).reshape(shape).astype(np.float32),
            "mte": relative_error(found, Metric.MTE).reshape(shape).astype(np.float32),
            "A": amplitude.astype(np.float32),
            "d": delay.astype(np.float32),
            "stable": cells.stable.reshape(shape),
        }


def _evaluate(
    pair: QuadraturePair, grid: Grid, structure: Structure
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Amplitude [-] and equivalent delay [s] over the grid, from sums at a few of its nodes."""
    gains, delays = grid.gains(structure), grid.delays(structure)
    row = np.unique(np.linspace(0, gains.size - 1, _NODES).round().astype(int))
    column = np.unique(np.linspace(1, delays.size - 1, _NODES).round().astype(int))
    gain, delay = np.meshgrid(gains[row], delays[column], indexing="ij")
    amplitude, equivalent = evaluate_sums(tracking_sums(pair, structure, gain.ravel(), delay.ravel()))
    # A/k_p and d/τ are close to one and vary slowly.
    shares = (amplitude.reshape(gain.shape) / gain, equivalent.reshape(gain.shape) / delay)
    over_gain, over_delay = (
        RectBivariateSpline(gains[row], delays[column], share)(gains, delays) for share in shares
    )
    return over_gain * gains[:, np.newaxis], over_delay * delays
