"""Solution of a whole grid for one ground motion: the unit of work, of resuming and of distribution."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.vocabulary import Metric
from reliab.motions.motion import Motion
from reliab.simulation.excitation import Excitation
from reliab.simulation.linear_loop.cells import Cells
from reliab.simulation.linear_loop.tracking_sums import QuadraturePair, TrackedCells, tracking_sums
from reliab.structures.structure import Structure, critical_delay
from reliab.sweep.grid import Grid
from reliab.sweep.request import SweepRequest, excitation_of, loop_of
from reliab.tracking.indices.frequency_evaluation import evaluate_sums
from reliab.tracking.indices.response_error import relative_error
from reliab.tracking.indices.window import Window

_NODES = 4  # along each axis, at which the index is summed; A/k_p and d/τ vary little between
_SHORTEST = 0.1  # of the longest delay; d/τ of shorter ones is that of this one
_CENTRAL = 2.0  # damping ratios of amplitude error within which the nodes lie


@dataclass(frozen=True, kw_only=True)
class MotionResults:
    """Results of one ground motion and one window over (f, xi, kp, tau), or (f, xi, alpha, kp, tau)."""

    rms: NDArray[np.float32]  # rms, mte: Errors of the whole test [-]
    mte: NDArray[np.float32]
    A: NDArray[np.float32]  # Amplitude of the evaluation index [-]
    d: NDArray[np.float32]  # Equivalent delay [s]
    stable: NDArray[np.bool_]  # Whether the delay is below the critical delay
    # RMS^R of an actuator that does not move [-], over the structures; its MTE^R is 1
    rms_at_rest: NDArray[np.float32]


VARIABLES = ("rms", "mte", "A", "d", "stable", "rms_at_rest")


@lru_cache(maxsize=256)
def _cells(grid: Grid, structure: Structure) -> Cells:
    """Cells of a structure, computed once for all motions."""
    return grid.cells(structure)


def solve_motion(motion: Motion, request: SweepRequest) -> list[MotionResults]:
    """Simulate one ground motion for all structures and actuators."""
    return [_solve_window(motion, request, window) for window in request.windows]


def _solve_window(motion: Motion, request: SweepRequest, window: Window) -> MotionResults:
    excitation = excitation_of(motion, window)
    pair = QuadraturePair.from_excitation(excitation)
    tables = [_solve_structure(excitation, pair, request, structure) for structure in request.structures]
    shape = tuple(map(len, request.structure_axes.values()))
    columns = {
        name: np.stack([table[name] for table in tables]).reshape(shape + tables[0][name].shape)
        for name in VARIABLES
    }
    return MotionResults(**columns)


def _solve_structure(
    excitation: Excitation,
    pair: QuadraturePair,
    request: SweepRequest,
    structure: Structure,
) -> dict[str, NDArray[np.generic]]:
    cells = _cells(request.grid, structure)
    shape = (request.grid.gains(structure).size, request.grid.delays(structure).size)
    loop = loop_of(request.model, excitation, structure, request.engine)
    deviation = loop.deviation(cells)
    amplitude, delay = _evaluate(pair, request.grid, structure)
    with np.errstate(over="ignore"):  # a violently unstable cell becomes infinite on disk
        return {
            "rms": relative_error(deviation, Metric.RMS).reshape(shape).astype(np.float32),
            "mte": relative_error(deviation, Metric.MTE).reshape(shape).astype(np.float32),
            "A": amplitude.astype(np.float32),
            "d": delay.astype(np.float32),
            "stable": cells.stable.reshape(shape),
            "rms_at_rest": relative_error(loop.rest_deviation(), Metric.RMS)[0].astype(np.float32),
        }


def _evaluate(pair: QuadraturePair, grid: Grid, structure: Structure) -> tuple[Array, Array]:
    """Amplitude [-] and equivalent delay [s] over the grid, from sums at a few of its nodes.

    Lags and leads have separate nodes. Beyond the critical delay, and beyond twice the damping ratio of
    amplitude error, the shares A/k_p and d/τ are those of the last node.
    """
    gains, delays = grid.gains(structure), grid.delays(structure)
    amplitude, equivalent = np.empty((2, gains.size, delays.size))
    cells, sides = _nodes(grid, structure)
    statistics = evaluate_sums(tracking_sums(pair, cells))
    units = (cells.gain, gains[:, np.newaxis]), (cells.delay, delays)
    for table, values, (node_unit, grid_unit) in zip((amplitude, equivalent), statistics, units, strict=True):
        for side in sides:
            table[:, side.columns] = (
                side.gain_weights @ (values / node_unit)[side.cells] @ side.delay_weights.T
            )
        np.multiply(table, grid_unit, out=table)
    return amplitude, equivalent


@dataclass(frozen=True, kw_only=True)
class _Nodes:
    """Cells of one side at which the evaluation index is computed, and the weights that interpolate it."""

    cells: NDArray[np.intp]  # Which cells, shape (gain nodes, delay nodes)
    columns: slice  # Delays of the grid that they serve
    # over_gain, over_delay: Weights of the nodes along each axis, shapes (kp, gain nodes) and (tau, delay
    # nodes)
    gain_weights: Array
    delay_weights: Array


@lru_cache(maxsize=256)
def _nodes(grid: Grid, structure: Structure) -> tuple[TrackedCells, list[_Nodes]]:
    """Nodes of the lags, including the actuator without delay, and of the leads if the grid has any."""
    gains, delays = grid.gains(structure), grid.delays(structure)
    central = np.abs(np.log(gains)) <= _CENTRAL * structure.damping_ratio
    gain_nodes = _evenly(gains[central])
    leads = int(np.searchsorted(delays, 0.0))
    late = delays[(delays > 0.0) & (delays < critical_delay(structure))]
    sides = [(slice(leads, None), _evenly(_distinct(late)))]
    if leads:
        sides.append((slice(0, leads), _evenly(_distinct(delays[:leads]))))
    delay_nodes = np.concatenate([side_nodes for _, side_nodes in sides])
    gain, delay = np.meshgrid(gain_nodes, delay_nodes, indexing="ij")
    places, ends = np.arange(gain.size).reshape(gain.shape), np.cumsum([side.size for _, side in sides])
    nodes = [
        _Nodes(
            cells=places[:, end - side_nodes.size : end],
            columns=columns,
            gain_weights=_polynomial_weights(gain_nodes, gains),
            delay_weights=_polynomial_weights(side_nodes, delays[columns]),
        )
        for (columns, side_nodes), end in zip(sides, ends.tolist(), strict=True)
    ]
    return TrackedCells(structure=structure, gain=gain.ravel(), delay=delay.ravel()), nodes


def _distinct(delays: Array) -> Array:
    """Leave out delays so short that the error of the sums, some 10 µs, is not small against them."""
    return np.asarray(delays[np.abs(delays) >= _SHORTEST * np.abs(delays).max()])


def _evenly(values: Array) -> Array:
    """Choose a few of the values, as evenly spaced as possible."""
    even = np.linspace(values[0], values[-1], _NODES)
    nearest = np.unique(np.argmin(np.abs(values[:, np.newaxis] - even), axis=0))
    return np.asarray(values[nearest])


def _polynomial_weights(nodes: Array, values: Array) -> Array:
    """Weights of the polynomial through the nodes, constant beyond them; shape (values, nodes)."""
    powers = np.polynomial.chebyshev.chebvander
    centre, half = 0.5 * (nodes[0] + nodes[-1]), 0.5 * (nodes[-1] - nodes[0]) or 1.0
    scaled_values = (np.clip(values, nodes[0], nodes[-1]) - centre) / half
    node_powers = powers((nodes - centre) / half, nodes.size - 1)
    return np.asarray(powers(scaled_values, nodes.size - 1) @ np.linalg.inv(node_powers), dtype=np.float64)
