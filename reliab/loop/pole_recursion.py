"""Engine `pole`: the dominant pole pair, stepped exactly for a record that is linear in each block.

The mode z' = pz + a_g is exact over a block of length H with E = e^(pH) and, for a record that
goes from a₀ to a₁ in the block, ::

    z₊ = Ez + u,   u = F₀a₀ + F₁a₁,   F₁ = ∫₀ᴴ (s/H)e^(p(H−s)) ds,   F₀ = ∫₀ᴴ e^(p(H−s)) ds − F₁

so that y = −2Re(rz) obeys y₊₊ = 2Re(E)y₊ − |E|²y − 2Re(r(u₊₊ − Ēu₊)). With the quasi-static lag,
stepped alike, a step of one cell costs nine multiply-adds whatever its delay, and cells of any
gain and delay advance side by side.
"""

import numpy as np
from numpy.typing import NDArray

from reliab.compiled import compiled
from reliab.loop.blocks import Blocks, ramp_weights
from reliab.loop.deviation import TRACKS, Deviation, follow, follow_four, summary
from reliab.loop.dominant_pole import ModalLoop

LANES = 64
"""Cells that advance side by side; their state fits the first-level cache."""

_COEFFICIENTS = 9


def recursion(loop: ModalLoop, step: float) -> NDArray[np.float64]:
    """Coefficients of the recursion of each cell.

    Parameters
    ----------
    loop : ModalLoop
        The reduced loop, one entry per cell.
    step : float
        Length H of a block [s].

    Returns
    -------
    numpy.ndarray
        Shape (9, cells): of the last two displacements; of the record at the left and right end of
        this block and of the one before; of the lag, and of the two ends of this block in it.
    """
    early, late, decay = ramp_weights(loop.pole, step)
    back = loop.residue * decay.conj()
    lags = loop.lag > 1e-6 * step  # a shorter lag follows at once
    rate = -1.0 / np.where(lags, loop.lag, 1.0)
    lag_early, lag_late, lag_decay = ramp_weights(rate, step)
    return np.stack(
        [
            2.0 * decay.real,
            -(np.abs(decay) ** 2),
            -2.0 * (loop.residue * early).real,
            -2.0 * (loop.residue * late).real,
            2.0 * (back * early).real,
            2.0 * (back * late).real,
            np.where(lags, lag_decay, 0.0),
            loop.quasi_static * np.where(lags, rate * lag_early, 0.0),
            loop.quasi_static * np.where(lags, rate * lag_late, -1.0),
        ]
    )


@compiled
def _four_steps(
    state: tuple[float, float, float],
    cell: tuple[float, float, float, float, float, float, float, float, float],
    left: tuple[float, float, float, float, float],
    right: tuple[float, float, float, float, float],
) -> tuple[float, float, float, float, tuple[float, float, float]]:
    """Displacements at the ends of four blocks, and the state after them."""
    z, y, lag = state
    c1, c2, b0, b1, d0, d1, l0, l1, l2 = cell
    p = c1 * y + c2 * z + b0 * left[1] + b1 * right[1] + d0 * left[0] + d1 * right[0]
    q = c1 * p + c2 * y + b0 * left[2] + b1 * right[2] + d0 * left[1] + d1 * right[1]
    r = c1 * q + c2 * p + b0 * left[3] + b1 * right[3] + d0 * left[2] + d1 * right[2]
    s = c1 * r + c2 * q + b0 * left[4] + b1 * right[4] + d0 * left[3] + d1 * right[3]
    lag_p = l0 * lag + l1 * left[1] + l2 * right[1]
    lag_q = l0 * lag_p + l1 * left[2] + l2 * right[2]
    lag_r = l0 * lag_q + l1 * left[3] + l2 * right[3]
    lag_s = l0 * lag_r + l1 * left[4] + l2 * right[4]
    return p + lag_p, q + lag_q, r + lag_r, s + lag_s, (r, s, lag_s)


@compiled
def _track_lanes(
    left: NDArray[np.float64],
    right: NDArray[np.float64],
    ideal: NDArray[np.float64],
    before: int,
    end: float,
    coefficients: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Step one set of lanes from rest through the window; shape (tracks, lanes).

    Vector instructions need arrays that are made here, so that they cannot overlap, and pieces that
    take and return numbers only.
    """
    k = np.empty((_COEFFICIENTS, LANES))
    k[:] = coefficients
    x, t = np.zeros((3, LANES)), np.zeros((TRACKS, LANES))
    i = 0
    while i < left.size:
        if i > before and i + 5 < left.size:
            lefts = (left[i - 1], left[i], left[i + 1], left[i + 2], left[i + 3])
            rights = (right[i - 1], right[i], right[i + 1], right[i + 2], right[i + 3])
            for j in range(LANES):
                cell = (k[0, j], k[1, j], k[2, j], k[3, j], k[4, j], k[5, j], k[6, j], k[7, j], k[8, j])
                p, q, r, s, after = _four_steps((x[0, j], x[1, j], x[2, j]), cell, lefts, rights)
                x[0, j], x[1, j], x[2, j] = after
                track = (t[0, j], t[1, j], t[2, j], t[3, j], t[4, j], t[5, j])
                track = follow_four(
                    track, p - ideal[i + 1], q - ideal[i + 2], r - ideal[i + 3], s - ideal[i + 4]
                )
                t[0, j], t[1, j], t[2, j], t[3, j], t[4, j], t[5, j] = track
            i += 4
        else:
            last = i + 1 == left.size
            weight = 0.5 * end if last else (0.5 + 0.5 * end if i + 2 == left.size else 1.0)
            old_left, old_right = (left[i - 1], right[i - 1]) if i > 0 else (0.0, 0.0)
            for j in range(LANES):
                track = (t[0, j], t[1, j], t[2, j], t[3, j], t[4, j], t[5, j])
                strayed = x[1, j] + x[2, j] - ideal[i]
                if i == before:
                    track = follow(track, strayed, 0.5)
                now = k[0, j] * x[1, j] + k[1, j] * x[0, j] + k[2, j] * left[i]
                now += k[3, j] * right[i] + k[4, j] * old_left + k[5, j] * old_right
                x[0, j], x[1, j] = x[1, j], now
                x[2, j] = k[6, j] * x[2, j] + k[7, j] * left[i] + k[8, j] * right[i]
                now += x[2, j] - ideal[i + 1]
                if i >= before:
                    track = follow(track, strayed + end * (now - strayed) if last else now, weight)
                t[0, j], t[1, j], t[2, j], t[3, j], t[4, j], t[5, j] = track
            i += 1
    return t


@compiled
def _track(
    left: NDArray[np.float64],
    right: NDArray[np.float64],
    ideal: NDArray[np.float64],
    before: int,
    end: float,
    coefficients: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Statistics of all cells, whose number is a multiple of the lanes; shape (tracks, cells)."""
    cells = coefficients.shape[1]
    tracks = np.empty((TRACKS, cells))
    for first in range(0, cells, LANES):
        lanes = slice(first, first + LANES)
        tracks[:, lanes] = _track_lanes(left, right, ideal, before, end, coefficients[:, lanes])
    return tracks


def deviation(blocks: Blocks, coefficients: NDArray[np.float64]) -> Deviation:
    """Deviation of the measured displacement from the exact response, for many cells.

    Parameters
    ----------
    blocks : Blocks
        Record and window, cut for the structure.
    coefficients : numpy.ndarray
        Coefficients of the recursion of each cell for blocks of this length, shape (9, cells).

    Returns
    -------
    Deviation
        Mean square and peak over the window.
    """
    cells = coefficients.shape[1]
    filled = np.pad(coefficients, ((0, 0), (0, -cells % LANES)), mode="edge")
    tracks = _track(blocks.left, blocks.right, blocks.ideal, blocks.before, blocks.end, filled)
    return summary(tracks[:, :cells], blocks.intervals, blocks.ideal_peak)
