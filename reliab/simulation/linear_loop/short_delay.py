"""Engine `delay` for delays shorter than a block, four blocks in one pass.

The delayed states at both ends of a block are then read from the states at its own ends and at the begin of
the block before, so that a step of `delay_stepper` is a linear map::

    (x, v)₊ = M (x, v, x₋, v₋) + N (a₀, a₁),     x_m₊ = k_p (h₀x + h₁v + h₂x₊ + h₃v₊)

with twelve and four coefficients instead of twenty-four, and no history.
"""

import numpy as np

from reliab.core.arrays import Array
from reliab.core.compiled import compiled, copy_rows
from reliab.simulation.deviation import LATEST, TRACKS, end_weight, follow, follow_four
from reliab.simulation.linear_loop.blocks import Blocks
from reliab.simulation.linear_loop.pole_recursion import fill_lanes

LANES = 48
"""Cells that advance side by side; their state fits the first-level cache."""

_COEFFICIENTS = 16

Six = tuple[float, float, float, float, float, float]
Four = tuple[float, float, float, float]


def tracks(blocks: Blocks, coefficients: Array) -> Array:
    """Statistics of cells whose delays are shorter than a block."""
    filled = fill_lanes(_map(coefficients), LANES)
    lines = blocks.left, blocks.right, blocks.ideal
    parts = [
        _track_lanes(*lines, blocks.before, blocks.end, filled[:, at : at + LANES].copy())
        for at in range(0, filled.shape[1], LANES)
    ]
    return np.concatenate(parts, axis=1)[:, : coefficients.shape[1]]


def _map(c: Array) -> Array:
    """Coefficients of the new displacement, of the new velocity, and of x_m, shape (16, cells)."""
    place, pace, gain = c[16:20], c[20:24], c[24]
    rows = []
    for state in (c[0:8], c[8:16]):
        now = state[:2] + state[2] * place[2:] + state[3] * pace[2:]
        now = now + state[4] * place[:2] + state[5] * pace[:2]
        rows += [now, state[2] * place[:2] + state[3] * pace[:2], state[6:8]]
    return np.concatenate([*rows, gain * place])


@compiled
def _next(state: Four, a0: float, a1: float, m: Six) -> float:
    """Step the displacement, or the velocity, from both at the begin of a block and of the one before."""
    x, v, x1, v1 = state
    return (m[4] * a0 + m[5] * a1 + m[2] * x1 + m[3] * v1) + (m[0] * x + m[1] * v)


@compiled
def _measure(state: Four, h: Four) -> float:
    """Measured displacement at the end of a block."""
    return (h[0] * state[2] + h[1] * state[3]) + (h[2] * state[0] + h[3] * state[1])


@compiled
def _track_lanes(
    left: Array, right: Array, ideal: Array, before: int, end: float, coefficients: Array
) -> Array:
    """Step one set of lanes from rest through the window; shape (tracks, lanes)."""
    k, s, t = np.empty((_COEFFICIENTS, LANES)), np.zeros((4, LANES)), np.zeros((TRACKS, LANES))
    t[LATEST] = np.nan
    copy_rows(coefficients, k)
    i = 0
    while i < left.size:
        several = i > before and i + 5 < left.size
        last = i + 1 == left.size
        weight = end_weight(i, left.size, end)
        weight = 0.5 if i + 1 == before else weight
        if several:
            a, b, c, d = left[i], left[i + 1], left[i + 2], left[i + 3]
            e, f, g, h = right[i], right[i + 1], right[i + 2], right[i + 3]
            w, x, y, z = ideal[i + 1], ideal[i + 2], ideal[i + 3], ideal[i + 4]
            for j in range(LANES):
                m = (k[0, j], k[1, j], k[2, j], k[3, j], k[4, j], k[5, j])
                n = (k[6, j], k[7, j], k[8, j], k[9, j], k[10, j], k[11, j])
                read = (k[12, j], k[13, j], k[14, j], k[15, j])
                x0, v0, x1, v1 = s[0, j], s[1, j], s[2, j], s[3, j]
                x2, v2 = _next((x0, v0, x1, v1), a, e, m), _next((x0, v0, x1, v1), a, e, n)
                x3, v3 = _next((x2, v2, x0, v0), b, f, m), _next((x2, v2, x0, v0), b, f, n)
                x4, v4 = _next((x3, v3, x2, v2), c, g, m), _next((x3, v3, x2, v2), c, g, n)
                x5, v5 = _next((x4, v4, x3, v3), d, h, m), _next((x4, v4, x3, v3), d, h, n)
                s[0, j], s[1, j], s[2, j], s[3, j] = x5, v5, x4, v4
                track = (t[0, j], t[1, j], t[2, j], t[3, j], t[4, j], t[5, j])
                t[0, j], t[1, j], t[2, j], t[3, j], t[4, j], t[5, j] = follow_four(
                    track,
                    _measure((x2, v2, x0, v0), read) - w,
                    _measure((x3, v3, x2, v2), read) - x,
                    _measure((x4, v4, x3, v3), read) - y,
                    _measure((x5, v5, x4, v4), read) - z,
                )
            i += 4
        else:
            a, e, w = left[i], right[i], ideal[i + 1]
            for j in range(LANES):
                m = (k[0, j], k[1, j], k[2, j], k[3, j], k[4, j], k[5, j])
                n = (k[6, j], k[7, j], k[8, j], k[9, j], k[10, j], k[11, j])
                state = (s[0, j], s[1, j], s[2, j], s[3, j])
                after = (_next(state, a, e, m), _next(state, a, e, n), state[0], state[1])
                s[0, j], s[1, j], s[2, j], s[3, j] = after
                now = _measure(after, (k[12, j], k[13, j], k[14, j], k[15, j])) - w
                if i + 1 >= before:
                    track = (t[0, j], t[1, j], t[2, j], t[3, j], t[4, j], t[5, j])
                    now = t[2, j] + end * (now - t[2, j]) if last else now
                    track = follow(track, now, weight)
                    t[0, j], t[1, j], t[2, j], t[3, j], t[4, j], t[5, j] = track
            i += 1
    return t
