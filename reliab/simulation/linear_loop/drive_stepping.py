"""Engine `pole`: deviations of many cells stepped side by side under shared drives (`shared_drives`).

The deviation y of a cell obeys a recursion of two states. It is stepped with its increment d ::

    d₊ = gd − βy + w,   y₊ = y + d₊,     g = |E|²,   β = |1 − E|²

in single precision, since β keeps the digits that 2Re E would lose; squares are summed up in double
precision. g is near one: in a pass of eight blocks it is rounded four times, so that the product is right.

Cells are stepped in sets of lanes, eight blocks in one pass with the state in registers. Of the peak only the
pass in which it lies is noted, with the state before it, from which it is stepped again at the end.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reliab.arrays import Array
from reliab.compiled import compiled, copy_rows
from reliab.simulation.deviation import Deviation, end_weight, refine_peak
from reliab.simulation.linear_loop.blocks import Blocks
from reliab.simulation.linear_loop.pole_recursion import fill_lanes
from reliab.simulation.linear_loop.shared_drives import DRIVES, SharedDrives

LANES = 128
"""Cells that advance side by side; their state fits the first-level cache."""

PASS_GAINS = 4
"""Factors g of a cell in one pass, each for two blocks."""

_PASS = 8
_PARTS = 8  # passes whose squares are summed in single precision
_COEFFICIENTS = 1 + PASS_GAINS + DRIVES
_STATES = 6  # y, d, and of the peak: modulus, first block of the pass, y and d before it

Row = tuple[float, float, float, float, float, float]
"""Values of the drives in one block, or a cell's weights of them."""

Single = Any
"""A number in single precision; checked as any, since NumPy's is no float."""


@compiled
def _row(drives: NDArray[np.float32], i: int) -> Row:
    return drives[i, 0], drives[i, 1], drives[i, 2], drives[i, 3], drives[i, 4], drives[i, 5]


@compiled
def _step(y: float, d: float, beta: float, g: float, u: Row, w: Row) -> tuple[float, float]:
    """Deviation and increment at the end of a block."""
    drive = u[0] * w[0] + u[1] * w[1] + u[2] * w[2] + u[3] * w[3] + u[4] * w[4] + u[5] * w[5]
    increment = (drive + g * d) - beta * y
    return y + increment, increment


@compiled
def _larger(a: float, b: float) -> float:
    return b if b > a else a  # noqa: FURB136 - the built-in has branches


@compiled
def _highest(p: float, q: float, r: float, s: float) -> float:
    return _larger(_larger(abs(p), abs(q)), _larger(abs(r), abs(s)))


@compiled
def _square(p: float, q: float, r: float, s: float) -> float:
    return (p * p + q * q) + (r * r + s * s)


@compiled
def _note_peak(
    old: tuple[float, float, float, float], new: tuple[float, float, float, float], one: float
) -> tuple[float, float, float, float]:
    """Whichever of two peaks, with pass and state, is higher.

    A factor of one that the compiler does not know keeps it from writing through masks, which some processors
    do very slowly.
    """
    up = new[0] > old[0]
    return (
        one * (new[0] if up else old[0]),
        one * (new[1] if up else old[1]),
        one * (new[2] if up else old[2]),
        one * (new[3] if up else old[3]),
    )


@compiled
def _track_lanes(  # noqa: PLR0915 - one compiled loop
    drives: NDArray[np.float32], before: int, end: float, cells: NDArray[np.float32], one: Single
) -> tuple[NDArray[np.float32], Array, NDArray[np.float32]]:
    """Step one set of lanes from rest through the window: states, sums of squares, last moduli.

    Vector instructions need arrays that are made here, so that they cannot overlap, and pieces that
    take and return numbers only.
    """
    k = np.empty((_COEFFICIENTS, LANES), dtype=np.float32)
    copy_rows(cells, k)
    s = np.zeros((_STATES, LANES), dtype=np.float32)
    squares_of_pass, squares = np.zeros(LANES, dtype=np.float32), np.zeros(LANES)
    last = np.zeros(LANES, dtype=np.float32)
    blocks, i, passes = drives.shape[0], 0, 0
    while i < blocks:
        at: Single = np.float32(i)
        if i == before:
            for j in range(LANES):
                squares[j], squares_of_pass[j] = 0.0, np.float32(0.5) * s[0, j] * s[0, j]
                s[2, j], s[3, j], s[4, j], s[5, j] = abs(s[0, j]), at, s[0, j], s[1, j]
        if i + _PASS <= (before if i < before else blocks - 2):
            w0, w1, w2, w3 = _row(drives, i), _row(drives, i + 1), _row(drives, i + 2), _row(drives, i + 3)
            w4, w5, w6, w7 = (
                _row(drives, i + 4),
                _row(drives, i + 5),
                _row(drives, i + 6),
                _row(drives, i + 7),
            )
            for j in range(LANES):
                b, g, h, m, n = k[0, j], k[1, j], k[2, j], k[3, j], k[4, j]
                u = (k[5, j], k[6, j], k[7, j], k[8, j], k[9, j], k[10, j])
                y, d = s[0, j], s[1, j]
                y0, d0 = _step(y, d, b, g, u, w0)
                y1, d1 = _step(y0, d0, b, g, u, w1)
                y2, d2 = _step(y1, d1, b, h, u, w2)
                y3, d3 = _step(y2, d2, b, h, u, w3)
                y4, d4 = _step(y3, d3, b, m, u, w4)
                y5, d5 = _step(y4, d4, b, m, u, w5)
                y6, d6 = _step(y5, d5, b, n, u, w6)
                y7, d7 = _step(y6, d6, b, n, u, w7)
                s[0, j], s[1, j] = y7, d7
                high = _larger(_highest(y0, y1, y2, y3), _highest(y4, y5, y6, y7))
                squares_of_pass[j] += _square(y0, y1, y2, y3) + _square(y4, y5, y6, y7)
                noted = (s[2, j], s[3, j], s[4, j], s[5, j])
                s[2, j], s[3, j], s[4, j], s[5, j] = _note_peak(noted, (high, at, y, d), one)
            i, passes = i + _PASS, passes + 1
        else:
            ends = i + 1 == blocks
            fraction: Single = np.float32(end) if ends else np.float32(1.0)
            weight: Single = np.float32(end_weight(i, blocks, end))
            inner: Single = np.float32(0.0 if ends else 1.0)
            w0 = _row(drives, i)
            for j in range(LANES):
                u = (k[5, j], k[6, j], k[7, j], k[8, j], k[9, j], k[10, j])
                y, d = s[0, j], s[1, j]
                _, d0 = _step(y, d, k[0, j], k[1, j], u, w0)
                now = y + fraction * d0
                s[0, j], s[1, j], last[j] = now, d0, abs(now)
                squares_of_pass[j] += weight * now * now
                noted = (s[2, j], s[3, j], s[4, j], s[5, j])
                s[2, j], s[3, j], s[4, j], s[5, j] = _note_peak(noted, (inner * abs(now), at, y, d), one)
            i += 1
        if passes == _PARTS or i >= blocks:
            for j in range(LANES):
                squares[j] += squares_of_pass[j]
                squares_of_pass[j] = np.float32(0.0)
            passes = 0
    return s, squares, last


@compiled
def _around_peak(
    drives: NDArray[np.float32], at: int, y: float, d: float, cell: NDArray[np.float32]
) -> tuple[float, float, float]:
    """Deviation of one cell at its peak, and a block before and after it; all the same at the window's begin.

    The peak is in the pass that begins with block `at` in the state y, d.
    """
    steps = min(_PASS + 1, drives.shape[0] - at)
    path = np.empty(_PASS + 2)
    path[0] = y
    highest = 0
    for n in range(steps):
        drive = 0.0
        for w in range(DRIVES):
            drive += np.float64(cell[5 + w]) * drives[at + n, w]
        d = cell[1] * d - cell[0] * path[n] + drive
        path[n + 1] = path[n] + d
        if n + 1 < steps and abs(path[n + 1]) > abs(path[highest]):
            highest = n + 1
    if highest == 0:
        return path[0], path[0], path[0]
    return path[highest - 1], path[highest], path[highest + 1]


@compiled
def track(
    drives: NDArray[np.float32], before: int, end: float, coefficients: NDArray[np.float32], one: Single
) -> tuple[Array, Array, Array]:
    """Step all cells from rest through the window."""
    cells = coefficients.shape[1]
    squares, around, last = np.empty(cells), np.empty((3, cells)), np.empty(cells)
    for first in range(0, cells, LANES):
        s, total, final = _track_lanes(drives, before, end, coefficients[:, first : first + LANES], one)
        for j in range(LANES):
            squares[first + j], last[first + j] = total[j], final[j]
            cell = coefficients[:, first + j]
            place = _around_peak(drives, int(s[3, j]), float(s[4, j]), float(s[5, j]), cell)
            around[0, first + j], around[1, first + j], around[2, first + j] = place
    return squares, around, last


_LARGEST_GROWTH = 30.0  # as an exponent, beyond which squares may overflow
_MOST_BLOCKS = 2**24  # beyond which the number of a block is not exact in single precision


@dataclass(frozen=True, kw_only=True, eq=False)
class DrivenCells:
    """Cells whose deviations are responses to shared drives."""

    place: NDArray[np.intp]  # Which cells of a recursion, shape (n,)
    # Of `track`, the weights of the drives divided by `size`, shape (11, n)
    coefficients: NDArray[np.float32]
    size: Array  # Norm of the weights, shape (n,)
    # Growth of free vibration in one block, as an exponent, shape (n,); negative where it decays
    growth: Array


def driven_cells(drives: SharedDrives, coefficients: Array) -> DrivenCells:
    """Cells whose drives are sums of the shared ones to within their tolerance."""
    weights, precise = drives.weights(coefficients)
    place = np.flatnonzero(precise)
    weights, (c1, c2) = weights[:, place], coefficients[:2, place]
    size = np.sqrt((weights**2).sum(axis=0))
    size[size == 0.0] = 1.0
    gains = np.empty((PASS_GAINS, place.size), dtype=np.float32)
    remainder = np.zeros(place.size)
    for gain in gains:  # what one lacks the next makes up for
        gain[:] = -c2 + remainder
        remainder += -c2 - gain
    single = np.concatenate([(1.0 - c1 - c2)[np.newaxis], gains, weights / size]).astype(np.float32)
    return DrivenCells(place=place, coefficients=single, size=size, growth=0.5 * np.log(-c2))


@dataclass(frozen=True, kw_only=True, eq=False)
class DrivenRecord:
    """Shared drives of a structure under one record."""

    # Drives in each block in units of `scale`, in single precision, shape (blocks, drives)
    drives: NDArray[np.float32]
    scale: float  # Largest drive [m]

    @classmethod
    def from_blocks(cls, blocks: Blocks, drives: SharedDrives) -> "DrivenRecord":
        """Drives under the record of some blocks."""
        single, scale = in_units(drives.histories(blocks))
        return cls(drives=single, scale=scale)

    def bounded(self, cells: DrivenCells) -> NDArray[np.bool_]:
        """Whether single precision holds the deviations, shape (cells,)."""
        blocks = self.drives.shape[0]
        calm = cells.growth * blocks <= _LARGEST_GROWTH
        return np.asarray(calm & bool(blocks < _MOST_BLOCKS and np.isfinite(self.scale)))


@compiled
def in_units(histories: Array) -> tuple[NDArray[np.float32], float]:
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
    """What `track` finds of all driven cells, filled up to whole lanes."""

    squares: Array  # squares, around, last: As `track` returns them
    around: Array
    last: Array

    @classmethod
    def through_window(cls, blocks: Blocks, record: DrivenRecord, cells: DrivenCells) -> "Stepped":
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
    unit, cells_of_lanes = record.scale * cells.size[which], np.flatnonzero(which)
    left, middle, right = stepped.around[:, cells_of_lanes]
    peak = np.fmax(refine_peak(left, middle, right), stepped.last[cells_of_lanes])
    mean_square = unit**2 * stepped.squares[cells_of_lanes] / blocks.intervals
    strayed = Deviation(mean_square=mean_square, peak=unit * peak, ideal_peak=blocks.ideal_peak)
    return strayed, (peak > 0.0) & (peak < 1.0)
