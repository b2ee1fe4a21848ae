"""The recursion of engine `pole`: two pole pairs, exact for a record that is linear in each block.

A mode z' = pz + a_g is exact over a block of length H with E = e^(pH) and, for a record that goes
from a₀ to a₁ in the block, ::

    z₊ = Ez + u,   u = F₀a₀ + F₁a₁,   F₁ = ∫₀ᴴ (s/H)e^(p(H−s)) ds,   F₀ = ∫₀ᴴ e^(p(H−s)) ds − F₁

so that y = −(rz + r'z') of two modes obeys a real recursion of two states and four ends of blocks::

    y₊₊ = (E + E')y₊ − EE'y − (ru + r'u')₊₊ + (rE'u + r'Eu')₊

For the dominant and the fast pair a step costs twelve multiply-adds whatever the delay, and cells of
any gain and delay advance side by side.

For an actuator that leads by T the mode is needed at t + T, a time θ before the end of the block that
contains t + T: the same recursion is used with the residue r·e^(−pθ), and the effect of the record during θ
replaces the fast pair. The exact response is read that number of blocks earlier.
"""

from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array, Spectrum
from reliab.core.compiled import compiled, copy_rows
from reliab.simulation.deviation import LATEST, TRACKS, Deviation, end_weight, follow, follow_four, summary
from reliab.simulation.linear_loop.blocks import Blocks, ramp_weights
from reliab.simulation.linear_loop.dominant_pole import LeadingLoop, ModalLoop

_Real = TypeVar("_Real", np.float32, np.float64)

BLOCK_COLUMNS = slice(8, 10)
"""Coefficients with which the record at both ends of a block enters beside the dominant pair."""


def fill_lanes(cells: NDArray[_Real], lanes: int) -> NDArray[_Real]:
    """Fill up the last set of lanes with copies of the last cell; shape (…, multiple of lanes).

    Rows are contiguous, so that kernels are compiled for one layout.
    """
    missing = -cells.shape[-1] % lanes
    copies = np.repeat(cells[..., -1:], missing, axis=-1)
    return np.ascontiguousarray(np.concatenate([cells, copies], axis=-1) if missing else cells)


@dataclass(frozen=True, kw_only=True)
class BlockRecursion:
    """The recursion of cells that look the same number of blocks ahead."""

    cells: NDArray[np.intp]  # Which cells, shape (n,)
    # Blocks by which the displacement is ahead of the exact response; 0 for actuators that are late
    ahead: int
    coefficients: Array  # Shape (12, n), as `recursion` describes them


def recursions(loop: ModalLoop | LeadingLoop, step: float, cells: NDArray[np.intp]) -> list[BlockRecursion]:
    """Recursions of the cells of a reduced loop.

    `step` [s].
    """
    if isinstance(loop, ModalLoop):
        return [BlockRecursion(cells=cells, ahead=0, coefficients=recursion(loop, step))]
    ahead, coefficients = leading_recursion(loop, step)
    return [
        BlockRecursion(cells=cells[equal_steps], ahead=int(count), coefficients=coefficients[:, equal_steps])
        for count in np.unique(ahead)
        for equal_steps in (np.flatnonzero(ahead == count),)
    ]


def leading_recursion(loop: LeadingLoop, step: float) -> tuple[NDArray[np.int64], Array]:
    """Coefficients of the recursion of actuators that lead.

    `step` [s].
    """
    pole, residue = loop.pole, loop.residue
    ahead = np.ceil(loop.lead / step).astype(np.int64)
    back = ahead * step - loop.lead
    decaying = residue * np.exp(-pole * back)
    slow = pair_recursion(np.stack([pole, pole.conj()]), np.stack([decaying, decaying.conj()]), step)
    # ∫₀^θ e^(−p(θ−u))a(u) du of the record's straight line, from its right end backwards
    constant_part = -np.expm1(-pole * back) / pole
    falling = (back - constant_part) / (pole * step)
    share = back / step
    left = 2.0 * (residue * falling).real - loop.feedthrough * share
    right = 2.0 * (residue * (constant_part - falling)).real - loop.feedthrough * (1.0 - share)
    zeros = np.zeros_like(left)
    return ahead, np.concatenate([slow, np.stack([zeros, zeros, left, right, zeros, zeros])])


def recursion(loop: ModalLoop, step: float) -> Array:
    """Coefficients of the recursion of each cell.

    `step` [s].
    Returns shape (12, cells): for the dominant and then the fast pair the coefficients of the last two
    displacements, and of the record at the left and right end of this block and of the one before.
    """
    poles = np.stack([loop.pole, loop.pole.conj()])
    residues = np.stack([loop.residue, loop.residue.conj()])
    dominant = pair_recursion(poles, residues, step)
    return np.concatenate([dominant, pair_recursion(loop.fast_poles, loop.fast_residues, step)])


def pair_recursion(poles: Spectrum, residues: Spectrum, step: float) -> Array:
    """Coefficients of the recursion of the response of two modes to −a_g.

    `poles`, `residues`, `step` [s].
    """
    early, late, decay = ramp_weights(poles, step)
    ahead, late_residues = residues, residues * decay[::-1]
    return np.stack(
        [
            decay.sum(axis=0).real,
            -decay.prod(axis=0).real,
            -(ahead * early).sum(axis=0).real,
            -(ahead * late).sum(axis=0).real,
            (late_residues * early).sum(axis=0).real,
            (late_residues * late).sum(axis=0).real,
        ]
    )


LANES = 64
"""Cells that advance side by side; their state fits the first-level cache."""

_COEFFICIENTS = 12


@compiled
def _four_steps(
    y: float,
    z: float,
    pair: tuple[float, float, float, float, float, float],
    left: tuple[float, float, float, float, float],
    right: tuple[float, float, float, float, float],
) -> tuple[float, float, float, float]:
    """Displacements of a pair at the ends of four blocks; y was the last, z the one before."""
    c1, c2, b0, b1, d0, d1 = pair
    p = c1 * y + c2 * z + b0 * left[1] + b1 * right[1] + d0 * left[0] + d1 * right[0]
    q = c1 * p + c2 * y + b0 * left[2] + b1 * right[2] + d0 * left[1] + d1 * right[1]
    r = c1 * q + c2 * p + b0 * left[3] + b1 * right[3] + d0 * left[2] + d1 * right[2]
    s = c1 * r + c2 * q + b0 * left[4] + b1 * right[4] + d0 * left[3] + d1 * right[3]
    return p, q, r, s


@compiled
def _track_lanes(
    left: Array, right: Array, ideal: Array, before: int, end: float, coefficients: Array
) -> Array:
    """Step one set of lanes from rest through the window; shape (tracks, lanes).

    Vector instructions need arrays that are made here, so that they cannot overlap, and pieces that
    take and return numbers only.
    """
    k = np.empty((_COEFFICIENTS, LANES))
    copy_rows(coefficients, k)
    x, t = np.zeros((4, LANES)), np.zeros((TRACKS, LANES))
    t[LATEST] = np.nan
    i = 0
    while i < left.size:
        if i > before and i + 5 < left.size:
            lefts = (left[i - 1], left[i], left[i + 1], left[i + 2], left[i + 3])
            rights = (right[i - 1], right[i], right[i + 1], right[i + 2], right[i + 3])
            for j in range(LANES):
                slow = (k[0, j], k[1, j], k[2, j], k[3, j], k[4, j], k[5, j])
                fast = (k[6, j], k[7, j], k[8, j], k[9, j], k[10, j], k[11, j])
                p, q, r, s = _four_steps(x[0, j], x[1, j], slow, lefts, rights)
                p2, q2, r2, s2 = _four_steps(x[2, j], x[3, j], fast, lefts, rights)
                x[0, j], x[1, j], x[2, j], x[3, j] = s, r, s2, r2
                p, q, r, s = (
                    p + p2 - ideal[i + 1],
                    q + q2 - ideal[i + 2],
                    r + r2 - ideal[i + 3],
                    s + s2 - ideal[i + 4],
                )
                track = follow_four((t[0, j], t[1, j], t[2, j], t[3, j], t[4, j], t[5, j]), p, q, r, s)
                t[0, j], t[1, j], t[2, j], t[3, j], t[4, j], t[5, j] = track
            i += 4
        else:
            last = i + 1 == left.size
            weight = end_weight(i, left.size, end)
            a0, a1 = left[i], right[i]
            a2, a3 = (left[i - 1], right[i - 1]) if i > 0 else (0.0, 0.0)
            for j in range(LANES):
                track = (t[0, j], t[1, j], t[2, j], t[3, j], t[4, j], t[5, j])
                difference = x[0, j] + x[2, j] - ideal[i]
                if i == before:
                    track = follow(track, difference, 0.5)
                slow = (
                    k[0, j] * x[0, j]
                    + k[1, j] * x[1, j]
                    + k[2, j] * a0
                    + k[3, j] * a1
                    + k[4, j] * a2
                    + k[5, j] * a3
                )
                fast = (
                    k[6, j] * x[2, j]
                    + k[7, j] * x[3, j]
                    + k[8, j] * a0
                    + k[9, j] * a1
                    + k[10, j] * a2
                    + k[11, j] * a3
                )
                x[0, j], x[1, j], x[2, j], x[3, j] = slow, x[0, j], fast, x[2, j]
                now = slow + fast - ideal[i + 1]
                if i >= before:
                    track = follow(track, difference + end * (now - difference) if last else now, weight)
                t[0, j], t[1, j], t[2, j], t[3, j], t[4, j], t[5, j] = track
            i += 1
    return t


@compiled
def _track(left: Array, right: Array, ideal: Array, before: int, end: float, coefficients: Array) -> Array:
    """Statistics of all cells, whose number is a multiple of the lanes; shape (tracks, cells)."""
    cells = coefficients.shape[1]
    tracks = np.empty((TRACKS, cells))
    for first in range(0, cells, LANES):
        lanes = slice(first, first + LANES)
        copy_rows(_track_lanes(left, right, ideal, before, end, coefficients[:, lanes]), tracks[:, lanes])
    return tracks


def deviation(blocks: Blocks, coefficients: Array, *, ahead: int = 0) -> Deviation:
    """Deviation of the measured displacement from the exact response, for many cells."""
    cells = coefficients.shape[1]
    lane_coefficients = fill_lanes(coefficients, LANES)
    left, right, ideal = blocks.left, blocks.right, blocks.ideal
    if ahead:
        (left, right), ideal = blocks.extend_lines(ahead), np.concatenate([np.zeros(ahead), ideal])
    tracks = _track(left, right, ideal, blocks.before + ahead, blocks.end, lane_coefficients)
    return summary(tracks[:, :cells], blocks.intervals, blocks.ideal_peak)
