"""Many actuators before one frame, stepped side by side: one recursion of two states for each pole pair.

A pair z' = pz + a_g with residue r is exact for a ground acceleration that is linear in each step. With
E = e^(ph) and the weights F₀, F₁ of both ends of a step its displacement y = −2Re(rz) obeys::

    y₊₊ = 2Re(E)y₊ − |E|²y − 2Re(rF₁)a₊₊ − 2Re(rF₀ − rE*F₁)a₊ + 2Re(rE*F₀)a
"""

import numpy as np

from reliab.arrays import Array
from reliab.compiled import compiled, copy_rows
from reliab.simulation.deviation import LATEST, TRACKS, follow
from reliab.simulation.frames.loop_poles import PoleLoop
from reliab.simulation.linear_loop.blocks import ramp_weights

LANES = 64
"""Cells that advance side by side."""

_COEFFICIENTS = 7


def recursion(loop: PoleLoop, step: float) -> Array:
    """Coefficients of every pair and of the remainder.

    `step` [s].
    Returns shape (modes + 1, 7, cells): of the last two displacements, of the ground at the end of this step,
    at its begin and a step before, the displacement a step before the record for which its first sample acts
    as a jump, and of the ground at the end of the next step. The last row is the remainder.
    """
    early, late, decay = ramp_weights(loop.poles, step)
    r, back = loop.residues, loop.residues * decay.conj()
    jump = 2.0 * (back * late).real
    squared = np.abs(decay) ** 2
    pairs = np.stack(
        [
            2.0 * decay.real,
            -squared,
            -2.0 * (r * late).real,
            jump - 2.0 * (r * early).real,
            2.0 * (back * early).real,
            jump / squared,
            np.zeros_like(jump),
        ],
        axis=1,
    )
    return np.concatenate([pairs, _remainder(loop, step)[np.newaxis]])


def _remainder(loop: PoleLoop, step: float) -> Array:
    """Coefficients of the remainder, shape (7, cells): a first-order lag, or the ground some time ahead."""
    remainder = np.zeros((_COEFFICIENTS, loop.remainder.size))
    ahead = np.maximum(-loop.remainder_time, 0.0) / step
    remainder[2], remainder[6] = -loop.remainder * (1.0 - ahead), -loop.remainder * ahead
    lags = loop.remainder_time > 0.0
    if lags.any():
        pole = -1.0 / loop.remainder_time[lags]
        early, late, decay = ramp_weights(pole, step)
        static = -loop.remainder[lags] * pole
        remainder[0, lags], remainder[2, lags], remainder[3, lags] = decay, -static * late, -static * early
    return remainder


@compiled
def track(ground: Array, ideal: Array, first: int, coefficients: Array) -> Array:
    """Step cells from rest and track their deviation from the sample `first` on, shape (tracks, cells)."""
    cells = coefficients.shape[2]
    tracks = np.empty((TRACKS, cells))
    for begin in range(0, cells, LANES):
        lanes = slice(begin, begin + LANES)
        copy_rows(_track_lanes(ground, ideal, first, coefficients[:, :, lanes]), tracks[:, lanes])
    return tracks


@compiled
def _track_lanes(  # noqa: C901 - one compiled loop
    ground: Array, ideal: Array, first: int, coefficients: Array
) -> Array:
    pairs, last = coefficients.shape[0] - 1, ground.size - 1
    k = np.empty((pairs + 1, _COEFFICIENTS, LANES))
    for p in range(pairs + 1):
        copy_rows(coefficients[p], k[p])
    t = np.zeros((TRACKS, LANES))
    for j in range(LANES):
        t[LATEST, j] = np.nan
    x, y, remainder, total = (
        np.zeros((pairs, LANES)),
        np.zeros((pairs, LANES)),
        np.zeros(LANES),
        np.zeros(LANES),
    )
    # y lies one step before x; it starts where a jump at the first sample puts it.
    for p in range(pairs):
        for j in range(LANES):
            y[p, j] = k[p, 5, j] * ground[0]
    for i in range(last + 1):
        now, after = ground[i], ground[min(i + 1, last)]
        before = ground[i - 1] if i > 0 else 0.0
        earlier = ground[i - 2] if i > 1 else 0.0
        for j in range(LANES):
            remainder[j] = k[pairs, 0, j] * remainder[j] + k[pairs, 2, j] * now
            remainder[j] += k[pairs, 3, j] * before + k[pairs, 6, j] * after
            total[j] = remainder[j]
        if i > 0:
            for p in range(pairs):
                for j in range(LANES):
                    moved = k[p, 0, j] * x[p, j] + k[p, 1, j] * y[p, j]
                    moved += k[p, 2, j] * now + k[p, 3, j] * before + k[p, 4, j] * earlier
                    y[p, j] = x[p, j]
                    x[p, j] = moved
                    total[j] += moved
        if i >= first:
            weight = 0.5 if i in (first, last) else 1.0
            exact = ideal[i]
            for j in range(LANES):
                track_of = (t[0, j], t[1, j], t[2, j], t[3, j], t[4, j], t[5, j])
                track_of = follow(track_of, total[j] - exact, weight)
                t[0, j], t[1, j], t[2, j], t[3, j], t[4, j], t[5, j] = track_of
    return t
