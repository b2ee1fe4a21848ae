"""Engine `delay`: the delay equation itself, stepped for any delay, stable or not.

With κ = αk_pω₀² the loop is a stiff oscillator under the record and a small remainder::

    x'' + 2ξω₀x' + ((1−α)ω₀² + κ)x = −a_g + κ(x(t) − x(t−τ))

The oscillator is propagated exactly over a block for a record that is linear there, the remainder
as the cubic through its values and rates at both ends; the delayed state is read from the cubic
through the stored displacements and velocities. A delay shorter than the block makes the step
implicit, which costs nothing because the loop is linear. Cells whose delays reach back by the same
number of blocks advance side by side.
"""

import numpy as np

from reliab.core.arrays import Array, Spectrum
from reliab.core.compiled import compiled, copy_rows
from reliab.simulation.excitation import LATEST, TRACKS, Deviation, end_weight, follow, summary
from reliab.simulation.linear_loop.blocks import Blocks, ramp_weights
from reliab.structures.structure import Structure

LANES = 48
"""Cells that advance side by side; their state fits the first-level cache."""

_COEFFICIENTS = 25
_POLE_GAP = 1e-5  # of ω₀, least distance of the oscillator's poles
_GAUSS_NODES, _GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(8)


def _cubics(s: Array, step: float) -> tuple[Array, ...]:
    """Cubics of value and rate at the begin, value and rate at the end of a block, at fraction s."""
    return (
        (1.0 + 2.0 * s) * (1.0 - s) ** 2,
        step * s * (1.0 - s) ** 2,
        s**2 * (3.0 - 2.0 * s),
        step * s**2 * (s - 1.0),
    )


def _cubic_rates(s: Array, step: float) -> tuple[Array, ...]:
    """Time derivatives of the cubics."""
    return (
        6.0 * s * (s - 1.0) / step,
        (1.0 - s) * (1.0 - 3.0 * s),
        6.0 * s * (1.0 - s) / step,
        s * (3.0 * s - 2.0),
    )


def _cubic_effects(pole: Spectrum, step: float) -> tuple[Spectrum, ...]:
    """∫₀ᴴ e^(p(H−s))h(s) ds of the four cubics h."""
    s = 0.5 * (_GAUSS_NODES + 1.0)
    kernel = 0.5 * step * _GAUSS_WEIGHTS * np.exp(np.multiply.outer(pole * step, 1.0 - s))
    return tuple(np.sum(kernel * shape, axis=-1) for shape in _cubics(s, step))


def coefficients(structure: Structure, gain: Array, delay: Array, step: float) -> Array:
    """Coefficients of one step of each cell.

    `step` [s].
    Returns shape (25, cells): the new displacement, then the new velocity, from displacement, velocity,
    delayed displacement and velocity at the begin of the block, what is stored of the delayed ones at its
    end, and the record at both ends; the four weights that read a delayed displacement, and a delayed
    velocity, off the stored ones; the gain.
    """
    w0, xi, alpha = structure.circular_frequency, structure.damping_ratio, structure.experimental_fraction
    coupling = alpha * gain * w0**2
    # Both poles p and q, conjugate or real; equal ones are parted by little.
    discriminant = (1.0 - alpha) * w0**2 + coupling - (xi * w0) ** 2
    discriminant = np.where(np.abs(discriminant) < (_POLE_GAP * w0) ** 2, (_POLE_GAP * w0) ** 2, discriminant)
    poles = -xi * w0 + np.multiply.outer([1.0, -1.0], np.sqrt(-discriminant + 0j))
    early, late, decay = ramp_weights(poles, step)
    fraction = np.floor(delay / step) + 1.0 - delay / step
    place, pace = _cubics(fraction, step), _cubic_rates(fraction, step)

    # z = v − qx and y = v − px carry the state: x = (z − y)/(p − q), v = (pz − qy)/(p − q).
    def state(effect: Spectrum) -> Array:
        modal_state = np.stack([effect[0] - effect[1], poles[0] * effect[0] - poles[1] * effect[1]])
        return np.asarray((modal_state / (poles[0] - poles[1])).real)

    value, rate, end_value, end_rate = (coupling * state(effect) for effect in _cubic_effects(poles, step))
    right_side = np.stack(
        [
            state(-decay * poles[::-1]) + value,
            state(decay) + rate,
            -value,
            -rate,
            -end_value,
            -end_rate,
            -state(early),
            -state(late),
        ]
    )
    # The remainder at the end holds the new state, in a delay shorter than the block twice.
    fresh = np.where(delay < step, 1.0, 0.0)
    displacement_part = end_value * (1.0 - fresh * place[2]) - end_rate * fresh * pace[2]
    velocity_part = -end_value * fresh * place[3] + end_rate * (1.0 - fresh * pace[3])
    (xx, vx), (xv, vv) = displacement_part, velocity_part
    determinant = (1.0 - xx) * (1.0 - vv) - xv * vx
    new_place = ((1.0 - vv) * right_side[:, 0] + xv * right_side[:, 1]) / determinant
    new_pace = (vx * right_side[:, 0] + (1.0 - xx) * right_side[:, 1]) / determinant
    return np.concatenate([new_place, new_pace, np.stack(place), np.stack(pace), gain[np.newaxis]])


@compiled
def _track_lanes(
    left: Array, right: Array, ideal: Array, before: int, end: float, cells: Array, delay: int, history: Array
) -> Array:
    """Step one set of lanes from rest through the window; shape (tracks, lanes).

    `history` receives command and measured displacement of the first lane unless it is empty.
    """
    c = np.empty((_COEFFICIENTS, LANES))
    copy_rows(cells, c)
    depth = delay + 2
    xs, vs = np.zeros((depth, LANES)), np.zeros((depth, LANES))
    state, t = np.zeros((4, LANES)), np.zeros((TRACKS, LANES))
    t[LATEST] = np.nan
    # The delayed state at the end of a block lies between two stored ones or, for a delay shorter
    # than a block, between the last stored one and the new one.
    stored_share, fresh = (1.0, 0.0) if delay > 0 else (0.0, 1.0)
    for i in range(left.size):
        old, new, put = (i - delay) % depth, (i + 1 - delay) % depth, (i + 1) % depth
        last = i + 1 == left.size
        weight = end_weight(i, left.size, end)
        if i + 1 == before:
            weight = 0.5
        for j in range(LANES):
            end_x, end_v = stored_share * xs[new, j], stored_share * vs[new, j]
            place = c[16, j] * xs[old, j] + c[17, j] * vs[old, j] + c[18, j] * end_x + c[19, j] * end_v
            pace = c[20, j] * xs[old, j] + c[21, j] * vs[old, j] + c[22, j] * end_x + c[23, j] * end_v
            x = c[0, j] * state[0, j] + c[1, j] * state[1, j] + c[2, j] * state[2, j] + c[3, j] * state[3, j]
            x += c[4, j] * place + c[5, j] * pace + c[6, j] * left[i] + c[7, j] * right[i]
            v = (
                c[8, j] * state[0, j]
                + c[9, j] * state[1, j]
                + c[10, j] * state[2, j]
                + c[11, j] * state[3, j]
            )
            v += c[12, j] * place + c[13, j] * pace + c[14, j] * left[i] + c[15, j] * right[i]
            state[0, j], state[1, j] = x, v
            state[2, j] = place + fresh * (c[18, j] * x + c[19, j] * v)
            state[3, j] = pace + fresh * (c[22, j] * x + c[23, j] * v)
        for j in range(LANES):
            xs[put, j], vs[put, j] = state[0, j], state[1, j]
        if history.size > 0:
            history[0, i + 1], history[1, i + 1] = state[0, 0], c[24, 0] * state[2, 0]
        if i + 1 >= before:
            for j in range(LANES):
                track = (t[0, j], t[1, j], t[2, j], t[3, j], t[4, j], t[5, j])
                now = c[24, j] * state[2, j] - ideal[i + 1]
                track = follow(track, t[2, j] + end * (now - t[2, j]) if last else now, weight)
                t[0, j], t[1, j], t[2, j], t[3, j], t[4, j], t[5, j] = track
    return t


def deviation(blocks: Blocks, structure: Structure, gain: Array, delay: Array) -> Deviation:
    """Deviation of the measured displacement from the exact response, for many cells."""
    tracks = np.empty((TRACKS, gain.size))
    cells = coefficients(structure, gain, delay, blocks.step)
    reach = np.floor(delay / blocks.step).astype(np.int64)
    for span in np.unique(reach):
        equal_delays = np.flatnonzero(reach == span)
        for first in range(0, equal_delays.size, LANES):
            lanes = equal_delays[first : first + LANES]
            indices = np.append(lanes, np.repeat(lanes[-1], LANES - lanes.size))
            tracks[:, lanes] = _run(blocks, cells[:, indices], int(span), np.empty((2, 0)))[:, : lanes.size]
    return summary(tracks, blocks.intervals, blocks.ideal_peak)


def response(blocks: Blocks, structure: Structure, gain: float, delay: float) -> Array:
    """Command and measured displacement of one cell at the edges of the blocks.

    Returns [m].
    """
    cells = coefficients(structure, np.full(LANES, gain), np.full(LANES, delay), blocks.step)
    histories = np.zeros((2, blocks.left.size + 1))
    _run(blocks, cells, int(delay / blocks.step), histories)
    return histories


def _run(blocks: Blocks, cells: Array, delay: int, history: Array) -> Array:
    rows = np.ascontiguousarray(cells)  # so that the kernel is compiled for one layout
    return _track_lanes(
        blocks.left, blocks.right, blocks.ideal, blocks.before, blocks.end, rows, delay, history
    )
