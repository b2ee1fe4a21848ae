"""Engine `pole`: deviations of many cells stepped side by side under shared drives (`shared_drives`).

The deviation y of a cell obeys a recursion of two states. It is stepped with its increment d ::

    d₊ = gd − βy + w,   y₊ = y + d₊,     g = |E|²,   β = |1 − E|²

in single precision, since β keeps the digits that 2Re E would lose; squares are summed up in double
precision. g is near one: in a pass of eight blocks it is rounded four times, so that the product is right.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reliab.compiled import compiled
from reliab.simulation.deviation import Deviation, refined_peak
from reliab.simulation.linear_loop.blocks import Blocks
from reliab.simulation.linear_loop.drive_kernel import LANES, PASS_GAINS, track
from reliab.simulation.linear_loop.pole_recursion import fill_lanes
from reliab.simulation.linear_loop.shared_drives import SharedDrives

_LARGEST_GROWTH = 30.0  # as an exponent, beyond which squares may overflow
_MOST_BLOCKS = 2**24  # beyond which the number of a block is not exact in single precision


@dataclass(frozen=True, kw_only=True, eq=False)
class DrivenCells:
    """Cells whose deviations are responses to shared drives."""

    place: NDArray[np.intp]  # Which cells of a recursion, shape (n,)
    # Of `drive_kernel.track`, the weights of the drives divided by `size`, shape (11, n)
    coefficients: NDArray[np.float32]
    size: NDArray[np.float64]  # Norm of the weights, shape (n,)
    # Growth of free vibration in one block, as an exponent, shape (n,); negative where it decays
    growth: NDArray[np.float64]


def driven_cells(drives: SharedDrives, coefficients: NDArray[np.float64]) -> DrivenCells:
    """Cells whose drives are sums of the shared ones to within their tolerance."""
    weights, precise = drives.weights(coefficients)
    place = np.flatnonzero(precise)
    weights, (c1, c2) = weights[:, place], coefficients[:2, place]
    size = np.sqrt((weights**2).sum(axis=0))
    size[size == 0.0] = 1.0
    gains = np.empty((PASS_GAINS, place.size), dtype=np.float32)
    rest = np.zeros(place.size)
    for gain in gains:  # what one lacks the next makes up for
        gain[:] = -c2 + rest
        rest += -c2 - gain
    single = np.concatenate([(1.0 - c1 - c2)[np.newaxis], gains, weights / size]).astype(np.float32)
    return DrivenCells(place=place, coefficients=single, size=size, growth=0.5 * np.log(-c2))


@dataclass(frozen=True, kw_only=True, eq=False)
class DrivenRecord:
    """Shared drives of a structure under one record."""

    # Drives in each block in units of `scale`, in single precision, shape (blocks, drives)
    drives: NDArray[np.float32]
    scale: float  # Largest drive [m]

    @classmethod
    def of(cls, blocks: Blocks, drives: SharedDrives) -> "DrivenRecord":
        """Drives under the record of some blocks."""
        single, scale = in_units(drives.histories(blocks))
        return cls(drives=single, scale=scale)

    def bounded(self, cells: DrivenCells) -> NDArray[np.bool_]:
        """Whether single precision holds the deviations, shape (cells,)."""
        blocks = self.drives.shape[0]
        calm = cells.growth * blocks <= _LARGEST_GROWTH
        return np.asarray(calm & bool(blocks < _MOST_BLOCKS and np.isfinite(self.scale)))


@compiled
def in_units(histories: NDArray[np.float64]) -> tuple[NDArray[np.float32], float]:
    """Drives in single precision in units of the largest, and that unit."""
    scale = 0.0
    for i in range(histories.shape[0]):
        for j in range(histories.shape[1]):
            drive = abs(histories[i, j])
            scale = max(scale, drive) if np.isfinite(drive) else np.inf
    scale = scale if scale > 0.0 else 1.0
    single = np.empty(histories.shape, dtype=np.float32)
    for i in range(histories.shape[0]):
        for j in range(histories.shape[1]):
            single[i, j] = histories[i, j] / scale
    return single, scale


@dataclass(frozen=True, kw_only=True, eq=False)
class Stepped:
    """What `drive_kernel.track` finds of all driven cells, filled up to whole lanes."""

    squares: NDArray[np.float64]  # squares, around, last: As `drive_kernel.track` returns them
    around: NDArray[np.float64]
    last: NDArray[np.float64]

    @classmethod
    def of(cls, blocks: Blocks, record: DrivenRecord, cells: DrivenCells) -> "Stepped":
        """Step the cells through the window."""
        filled = fill_lanes(cells.coefficients, LANES)
        squares, around, last = track(record.drives, blocks.before, blocks.end, filled, np.float32(1.0))
        return cls(squares=squares, around=around, last=last)


def deviation(
    blocks: Blocks, record: DrivenRecord, cells: DrivenCells, which: NDArray[np.bool_], stepped: Stepped
) -> tuple[Deviation, NDArray[np.bool_]]:
    """Deviation of the measured displacement from the exact response, for many cells.

    Returns `faint`: whether a deviation stays below its drive, as under a record of high frequencies only,
    shape (cells,); single precision is then not enough.
    """
    unit, asked = record.scale * cells.size[which], np.flatnonzero(which)
    left, middle, right = stepped.around[:, asked]
    peak = np.fmax(refined_peak(left, middle, right), stepped.last[asked])
    mean_square = unit**2 * stepped.squares[asked] / blocks.intervals
    strayed = Deviation(mean_square=mean_square, peak=unit * peak, ideal_peak=blocks.ideal_peak)
    return strayed, (peak > 0.0) & (peak < 1.0)
