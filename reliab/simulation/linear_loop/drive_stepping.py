"""Engine `pole`: deviations of many actuators stepped side by side as responses to a few shared drives.

The deviation y = x_m − x_I of one actuator obeys the recursion of its own dominant pair, driven by
what the reduced loop and the exact response leave of it::

    y₊₊ = c₁y₊ + c₂y + w,     E = e^(pH),  c₁ = 2Re E,  c₂ = −|E|²

For a given record the w of all actuators before one structure are nearly sums of the same few. The
shared ones are those of a few actuators, orthonormal over the frequencies (pivoted QR), and every other
actuator is fitted with them by least squares. The largest part that this leaves out of w, at any
frequency up to the highest that blocks resolve, bounds the relative error of y for **every** record.

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
from functools import lru_cache
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.core.arrays import Array, Spectrum
from reliab.core.compiled import compiled, copy_rows
from reliab.simulation.excitation import Deviation, end_weight, refine_peak
from reliab.simulation.linear_loop.blocks import Blocks
from reliab.simulation.linear_loop.pole_recursion import fill_lanes, modal_loop, recursion
from reliab.structures.structure import Structure

DRIVES = 6
"""Number of shared drives."""

LEFT_OUT = 1e-5
"""Largest share of an actuator's drive that the shared ones may leave out at any frequency [-]."""

_LAGS = 5  # blocks of which a drive is made up
_NO_DRIVE = 1e-10  # of the exact response's drive; less counts as none
_REACH_GAIN = 1.1  # of the actuators from which drives are taken: |ln k_p| in damping ratios
_LONGEST_DELAY = 0.3  # of a block; the fast pair of a longer delay needs more drives
_GAINS, _DELAYS = 9, 10
_FREQUENCIES = 24  # below the structure's and above it


@dataclass(frozen=True, kw_only=True, eq=False)
class SharedDrives:
    """Shared drives of the actuators before one structure."""

    # e^(−iωH) at the frequencies at which drives are compared, shape (frequencies, 1)
    back: Spectrum
    exact: Array  # Recursion of the exact response, shape (6, 1)
    taps: Array  # Of `drive_histories`, shape (13, drives)
    # Real and imaginary parts of the transfer functions from both ends of a block to the shared drives,
    # divided by `rows`, shape (4 frequencies, drives)
    orthonormal: Array
    rows: Array  # Usual size of a drive at each frequency, shape (frequencies, 1)

    def weights(self, coefficients: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Weights of the shared drives in those of late actuators."""
        targets = _parts(_drives(coefficients, self.exact, self.back) / self.rows)
        weights, residual = _fit(self.orthonormal, targets)
        exact_weights = _exact_drive(self.exact, self.back) / self.rows
        nothing = _NO_DRIVE * _sizes(_parts(exact_weights))
        weights[:, np.all(_sizes(targets) <= nothing, axis=0)] = 0.0
        return weights, np.all(_sizes(residual) <= LEFT_OUT * _sizes(targets) + nothing, axis=0)

    def histories(self, blocks: Blocks) -> Array:
        """Shared drives [m] in each block of a record, shape (drives, blocks)."""
        return drive_histories(blocks.left, blocks.right, blocks.ideal, self.taps)


@lru_cache(maxsize=1024)
def shared_drives(structure: Structure, step: float) -> SharedDrives:
    """Choose the shared drives of actuators before a structure.

    `step` [s].
    """
    turn = structure.circular_frequency * step
    low_frequencies = np.geomspace(1e-3 * turn, turn, _FREQUENCIES, endpoint=False)
    back = np.exp(-1j * np.append(low_frequencies, np.geomspace(turn, np.pi, _FREQUENCIES)))[:, np.newaxis]
    exact = recursion(modal_loop(structure, np.ones(1), np.zeros(1)), step)[:6]
    candidates = _candidates(structure, step)
    targets = _drives(candidates, exact, back)
    sizes = _sizes(_parts(targets))
    rows = np.sqrt(np.mean((sizes / sizes.max(axis=0)) ** 2, axis=1, keepdims=True))
    parts = _parts(targets / rows)
    _, _, order = scipy.linalg.qr(parts / np.linalg.norm(parts, axis=0), mode="economic", pivoting=True)
    drive_rows = order[:DRIVES]
    orthonormal, triangle = np.linalg.qr(parts[:, drive_rows])
    return SharedDrives(
        back=back,
        exact=exact,
        taps=_taps(candidates[:, drive_rows]) @ np.linalg.inv(triangle),
        orthonormal=orthonormal.copy(),
        rows=rows,
    )


def _candidates(structure: Structure, step: float) -> Array:
    """Recursions of late actuators with errors of interest, shape (12, cells)."""
    gains = np.exp(_REACH_GAIN * structure.damping_ratio * np.linspace(-1.0, 1.0, _GAINS))
    delays = _LONGEST_DELAY * step * np.linspace(0.0, 1.0, _DELAYS)
    gain, delay = (values.ravel() for values in np.meshgrid(gains, delays))
    is_perturbed = (gain != 1.0) | (delay > 0.0)
    loop = modal_loop(structure, gain[is_perturbed], delay[is_perturbed])
    return recursion(loop, step)[:, loop.residue != 0.0]


def _drives(coefficients: Array, exact: Array, back: Spectrum) -> Spectrum:
    """Transfer functions from both ends of a block to the drive w, shape (2, frequencies, cells)."""
    deviation = _pair(coefficients[:6], back) + _pair(coefficients[6:], back) - _pair(exact, back)
    return np.asarray(deviation * (1.0 - coefficients[0] * back - coefficients[1] * back**2))


def _exact_drive(exact: Array, back: Spectrum) -> Spectrum:
    return np.stack([exact[2] + exact[4] * back, exact[3] + exact[5] * back])


def _pair(c: Array, back: Spectrum) -> Spectrum:
    """Transfer functions of the recursion of one pair, a block early, shape (2, frequencies, cells)."""
    ends = np.stack([c[2] + c[4] * back, c[3] + c[5] * back])
    return np.asarray(ends / (1.0 - c[0] * back - c[1] * back**2))


def _parts(transfer: Spectrum) -> Array:
    """Real and imaginary parts from both ends of a block, shape (4 frequencies, cells)."""
    return np.concatenate([transfer[0].real, transfer[0].imag, transfer[1].real, transfer[1].imag])


def _sizes(parts: Array) -> Array:
    """Size of transfer functions from both ends of a block together, shape (frequencies, cells)."""
    return np.asarray(np.sqrt((parts**2).reshape(4, -1, parts.shape[1]).sum(axis=0)))


@compiled
def _fit(orthonormal: Array, targets: Array) -> tuple[Array, Array]:
    """Weights and rest; summed in a fixed order, so that no cell depends on the company of others."""
    weights, residual = np.zeros((orthonormal.shape[1], targets.shape[1])), targets.copy()
    for k in range(orthonormal.shape[1]):
        for row in range(targets.shape[0]):
            q = orthonormal[row, k]
            for j in range(targets.shape[1]):
                weights[k, j] += q * targets[row, j]
    for row in range(targets.shape[0]):
        for k in range(orthonormal.shape[1]):
            q = orthonormal[row, k]
            for j in range(targets.shape[1]):
                residual[row, j] -= q * weights[k, j]
    return weights, residual


def _taps(sources: Array) -> Array:
    """Drives of some actuators as sums of neighbouring values of a record and of the exact response.

    The recursion (1 − c₁z − c₂z²)x = (b₀ + d₀z)a₀ + (b₁ + d₁z)a₁ of either pair, z a block of delay, leaves
    of the dominant pair its load alone. The fast pair of so short a delay has c₁ of 3e-6 and c₂ of 3e-12, so
    that 1/(1 − c₁z − c₂z²) is 1 + c₁z.

    Returns the weights of a₀, then of a₁, in this block and the four before, and of the exact response at the
    end of this block and at the two edges before, shape (13, cells).
    """
    own_drives = np.stack([np.ones_like(sources[0]), -sources[0], -sources[1]])
    taps = np.zeros((2 * _LAGS + 3, sources.shape[1]))
    for end in (0, 1):
        lags = taps[end * _LAGS :]
        for dominant, late, fast in zip(sources[2 + end : 6 : 2], (0, 1), sources[8 + end :: 2], strict=True):
            lags[late] += dominant
            for later, weight in enumerate(own_drives):
                lags[late + later] += weight * fast
                lags[late + later + 1] += sources[6] * weight * fast
    taps[2 * _LAGS :] = -own_drives
    return taps


@compiled
def drive_histories(left: Array, right: Array, ideal: Array, taps: Array) -> Array:
    """Shared drives [m] in each block, from the lines of a record and the exact response to them."""
    blocks = left.size
    a0, a1, exact = np.zeros(blocks + _LAGS), np.zeros(blocks + _LAGS), np.zeros(blocks + _LAGS)
    for i in range(blocks):
        a0[i + _LAGS], a1[i + _LAGS], exact[i + _LAGS] = left[i], right[i], ideal[i + 1]
    drives = np.empty((DRIVES, blocks))
    for j in range(DRIVES):
        p0, p1, p2, p3, p4 = taps[0, j], taps[1, j], taps[2, j], taps[3, j], taps[4, j]
        q0, q1, q2, q3, q4 = taps[5, j], taps[6, j], taps[7, j], taps[8, j], taps[9, j]
        r0, r1, r2 = taps[10, j], taps[11, j], taps[12, j]
        for i in range(blocks):
            k = i + _LAGS
            early = p0 * a0[k] + p1 * a0[k - 1] + p2 * a0[k - 2] + p3 * a0[k - 3] + p4 * a0[k - 4]
            late = q0 * a1[k] + q1 * a1[k - 1] + q2 * a1[k - 2] + q3 * a1[k - 3] + q4 * a1[k - 4]
            drives[j, i] = early + late + (r0 * exact[k] + r1 * exact[k - 1] + r2 * exact[k - 2])
    return drives


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
