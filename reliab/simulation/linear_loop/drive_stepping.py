"""Engine `pole`: deviations of many cells stepped side by side under shared drives (`shared_drives`).

The deviation y of a cell obeys a recursion of two states. It is stepped with its increment d ::

    d₊ = γd − βy₋ + w,   y₊ = y + d₊,     γ = |E|² − β,   β = |1 − E|²

in single precision, since β keeps the digits that 2Re E would lose; squares are summed up in double
precision. With y₋, the deviation before y, an increment waits for one product only, which lets a processor
step several cells at once. γ is near one: in a pass of eight blocks it is rounded four times, so that the
product is right.

Cells are stepped in sets of lanes, eight blocks in one pass with the state in registers. Of the peak only the
pass in which it lies is noted, with the state before it, from which it is stepped again at the end.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.compiled import compiled, copy_rows
from reliab.simulation.deviation import Deviation, end_weight, refine_peak
from reliab.simulation.linear_loop.blocks import Blocks
from reliab.simulation.linear_loop.pole_recursion import fill_lanes
from reliab.simulation.linear_loop.shared_drives import DRIVES, SharedDrives

LANES = 216
"""Cells that advance side by side; their state fits the first-level cache."""

PASS_GAINS = 4
"""Factors γ of a cell in one pass, each for two blocks."""

_PASS = 8
_PARTS = 8  # passes whose squares are summed in single precision
_COEFFICIENTS = 1 + PASS_GAINS + DRIVES
_STATES = 6  # y₋, d, and of the peak: modulus, first block of the pass, y₋ and d before it

Row = tuple[float, float, float, float, float, float]
"""Values of the drives in one block, or a cell's weights of them."""

Single = Any
"""A number in single precision; checked as any, since NumPy's is no float."""


@compiled
def _row(drives: NDArray[np.float32], i: int) -> Row:
    return drives[0, i], drives[1, i], drives[2, i], drives[3, i], drives[4, i], drives[5, i]


@compiled
def _increment(y_before: float, d: float, beta: float, gamma: float, u: Row, w: Row) -> float:
    """Increment of the deviation in a block."""
    drive = u[0] * w[0] + u[1] * w[1] + u[2] * w[2] + u[3] * w[3] + u[4] * w[4] + u[5] * w[5]
    return (drive - beta * y_before) + gamma * d


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
    old: tuple[float, float, float, float], new: tuple[float, float, float, float], unity: float
) -> tuple[float, float, float, float]:
    """Whichever of two peaks, with pass and state, is higher.

    A factor of one that the compiler does not know keeps it from writing through masks, which some processors
    do very slowly.
    """
    up = new[0] > old[0]
    return (
        unity * (new[0] if up else old[0]),
        unity * (new[1] if up else old[1]),
        unity * (new[2] if up else old[2]),
        unity * (new[3] if up else old[3]),
    )


@compiled
def _track_lanes(  # noqa: PLR0915 - one compiled loop
    drives: NDArray[np.float32], before: int, end: float, cells: NDArray[np.float32], unity: Single
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
    blocks, i, passes = drives.shape[1], 0, 0
    while i < blocks:
        position: Single = np.float32(i)
        if i == before:
            for j in range(LANES):
                y = s[0, j] + s[1, j]
                squares[j], squares_of_pass[j] = 0.0, np.float32(0.5) * y * y
                s[2, j], s[3, j], s[4, j], s[5, j] = abs(y), position, s[0, j], s[1, j]
        if i + _PASS <= (before if i < before else blocks - 2):
            w0, w1, w2, w3 = (
                _row(drives, i),
                _row(drives, i + 1),
                _row(drives, i + 2),
                _row(drives, i + 3),
            )
            w4, w5, w6, w7 = (
                _row(drives, i + 4),
                _row(drives, i + 5),
                _row(drives, i + 6),
                _row(drives, i + 7),
            )
            for j in range(LANES):
                b, g, h, m, n = k[0, j], k[1, j], k[2, j], k[3, j], k[4, j]
                u = (k[5, j], k[6, j], k[7, j], k[8, j], k[9, j], k[10, j])
                previous_pass, d = s[0, j], s[1, j]
                y = previous_pass + d
                d0 = _increment(previous_pass, d, b, g, u, w0)
                y0 = y + d0
                d1 = _increment(y, d0, b, g, u, w1)
                y1 = y0 + d1
                d2 = _increment(y0, d1, b, h, u, w2)
                y2 = y1 + d2
                d3 = _increment(y1, d2, b, h, u, w3)
                y3 = y2 + d3
                d4 = _increment(y2, d3, b, m, u, w4)
                y4 = y3 + d4
                d5 = _increment(y3, d4, b, m, u, w5)
                y5 = y4 + d5
                d6 = _increment(y4, d5, b, n, u, w6)
                y6 = y5 + d6
                d7 = _increment(y5, d6, b, n, u, w7)
                y7 = y6 + d7
                s[0, j], s[1, j] = y6, d7
                high = _larger(_highest(y0, y1, y2, y3), _highest(y4, y5, y6, y7))
                squares_of_pass[j] += _square(y0, y1, y2, y3) + _square(y4, y5, y6, y7)
                start_state = (s[2, j], s[3, j], s[4, j], s[5, j])
                s[2, j], s[3, j], s[4, j], s[5, j] = _note_peak(
                    start_state, (high, position, previous_pass, d), unity
                )
            i, passes = i + _PASS, passes + 1
        else:
            ends = i + 1 == blocks
            fraction: Single = np.float32(end) if ends else np.float32(1.0)
            weight: Single = np.float32(end_weight(i, blocks, end))
            inner: Single = np.float32(0.0 if ends else 1.0)
            w0 = _row(drives, i)
            for j in range(LANES):
                u = (k[5, j], k[6, j], k[7, j], k[8, j], k[9, j], k[10, j])
                previous_pass, d = s[0, j], s[1, j]
                y = previous_pass + d
                d0 = _increment(previous_pass, d, k[0, j], k[1, j], u, w0)
                now = y + fraction * d0
                s[0, j], s[1, j], last[j] = y, d0, abs(now)
                squares_of_pass[j] += weight * now * now
                start_state = (s[2, j], s[3, j], s[4, j], s[5, j])
                s[2, j], s[3, j], s[4, j], s[5, j] = _note_peak(
                    start_state, (inner * abs(now), position, previous_pass, d), unity
                )
            i += 1
        if passes == _PARTS or i >= blocks:
            for j in range(LANES):
                squares[j] += squares_of_pass[j]
                squares_of_pass[j] = np.float32(0.0)
            passes = 0
    return s, squares, last


@compiled
def _peak(drives: NDArray[np.float32], position: int, y_before: float, d: float, cell: Array) -> float:
    """Largest modulus of the deviation of one cell, between blocks too.

    The peak is in the pass that begins with block `position` in the state y₋, d.
    """
    steps = min(_PASS + 1, drives.shape[1] - position)
    now = left = middle = right = y_before + d
    rises, follows = False, False
    for n in range(steps):
        u = _row(drives, position + n)
        drive = (cell[5] * u[0] + cell[6] * u[1]) + (cell[7] * u[2] + cell[8] * u[3])
        d = cell[1] * d - cell[0] * y_before + (drive + (cell[9] * u[4] + cell[10] * u[5]))
        y_before, now = now, now + d
        if follows:
            right = now
        follows = n + 1 < steps and abs(now) > abs(middle)
        if follows:
            left, middle, rises = y_before, now, True
    return refine_peak(left, middle, right) if rises else abs(middle)  # at the begin of the window


@compiled
def track(
    drives: NDArray[np.float32], before: int, end: float, coefficients: NDArray[np.float32], unity: Single
) -> tuple[Array, Array]:
    """Step all cells from rest through the window: sums of squares, and largest moduli."""
    cells = coefficients.shape[1]
    squares, peaks, cell = np.empty(cells), np.empty(cells), np.empty(_COEFFICIENTS)
    for first in range(0, cells, LANES):
        s, total, final = _track_lanes(drives, before, end, coefficients[:, first : first + LANES], unity)
        for j in range(LANES):
            for row in range(_COEFFICIENTS):
                cell[row] = coefficients[row, first + j]
            peak = _peak(drives, int(s[3, j]), float(s[4, j]), float(s[5, j]), cell)
            if final[j] > peak or np.isnan(peak):
                peak = float(final[j])
            squares[first + j], peaks[first + j] = total[j], peak
    return squares, peaks


_LARGEST_GROWTH = 30.0  # as an exponent, beyond which squares may overflow
_MOST_BLOCKS = 2**24  # beyond which the number of a block is not exact in single precision


@dataclass(frozen=True, kw_only=True, eq=False)
class DrivenCells:
    """Cells whose deviations are responses to shared drives."""

    place: NDArray[np.intp]  # Which cells of a recursion, shape (n,)
    # Of `track`, the weights of the drives divided by `size`, filled up to whole lanes, shape (11, lanes)
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
    beta, remainder = (1.0 - c1 - c2).astype(np.float32), np.zeros(place.size)
    for gain in gains:  # what one lacks the next makes up for
        gain[:] = -c2 - beta + remainder
        remainder += -c2 - beta - gain
    single = np.concatenate([beta[np.newaxis], gains, (weights / size).astype(np.float32)])
    lane_cells = fill_lanes(single, LANES)
    return DrivenCells(place=place, coefficients=lane_cells, size=size, growth=0.5 * np.log(-c2))


@dataclass(frozen=True, kw_only=True, eq=False)
class DrivenRecord:
    """Shared drives of a structure under one record."""

    # Drives in each block in units of `scale`, in single precision, shape (drives, blocks)
    drives: NDArray[np.float32]
    scale: float  # Largest drive [m]

    @classmethod
    def from_blocks(cls, blocks: Blocks, drives: SharedDrives) -> "DrivenRecord":
        """Drives under the record of some blocks."""
        single, scale = normalise(drives.histories(blocks))
        return cls(drives=single, scale=scale)

    @property
    def is_bounded(self) -> bool:
        """Whether single precision holds the drives and the numbers of their blocks."""
        return self.drives.shape[1] < _MOST_BLOCKS and math.isfinite(self.scale)


@compiled
def normalise(histories: Array) -> tuple[NDArray[np.float32], float]:
    """Drives in single precision in units of the largest, and that unit; infinite where one is not finite."""
    scale, worst = 0.0, 0.0
    for drive in histories.flat:
        scale = max(scale, abs(drive))
        worst += drive - drive
    scale = scale if scale > 0.0 else 1.0
    scale = scale if worst == 0.0 else np.inf
    single = np.empty(histories.shape, dtype=np.float32)
    for i in range(histories.shape[0]):
        for j in range(histories.shape[1]):
            single[i, j] = histories[i, j] * (1.0 / scale)
    return single, scale


@dataclass(frozen=True, kw_only=True, eq=False)
class DriveResponse:
    """What `track` finds of all driven cells, filled up to whole lanes."""

    squares: Array  # squares, peaks: As `track` returns them
    peaks: Array

    @classmethod
    def step_through(cls, blocks: Blocks, record: DrivenRecord, cells: DrivenCells) -> "DriveResponse":
        """Step the cells through the window."""
        window = blocks.before, blocks.end
        squares, peaks = track(record.drives, *window, cells.coefficients, np.float32(1.0))
        return cls(squares=squares, peaks=peaks)


def deviation(
    blocks: Blocks, record: DrivenRecord, cells: DrivenCells, drive_response: DriveResponse
) -> tuple[Deviation, NDArray[np.bool_]]:
    """Deviation of the measured displacement from the exact response, for many cells.

    Returns `precise`: whether single precision is enough, shape (cells,). It is not for a cell that grows
    beyond it, nor for a deviation that stays below its drive, as under a record of high frequencies only.
    """
    number, unit = cells.size.size, record.scale * cells.size
    peak = drive_response.peaks[:number]
    mean_square = unit**2 * drive_response.squares[:number] / blocks.intervals
    difference = Deviation(mean_square=mean_square, peak=unit * peak, ideal_peak=blocks.ideal_peak)
    calm = cells.growth * record.drives.shape[1] <= _LARGEST_GROWTH
    return difference, calm & ((peak == 0.0) | (peak >= 1.0))
