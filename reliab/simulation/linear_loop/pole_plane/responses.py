"""The shared functions of time under one ground motion, and the mean square of any sum of them.

The poles of a basis are stepped through the record once. All deviations of the plane being sums
Σ w_k f_k(t) of the same functions, the mean square of each is a quadratic form::

    mean (x_m − x_I)² = wᵀGw,     G_kl = mean f_k f_l

whatever the number of actuators. G is summed up over pieces of the record that stay in the processor's cache,
so that no function is ever stored as a whole.

What the expansion leaves out of a response to a pole p_k has at most the energy of that response followed to
rest, ∫|z_k|² dt + |z_k(end)|²/(−2Re p_k), which the stepping sums up.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from reliab.core.arrays import Array
from reliab.core.compiled import compiled, copy_rows
from reliab.simulation.linear_loop.blocks import Blocks, ramp_weights
from reliab.simulation.linear_loop.pole_plane.basis import PoleBasis
from reliab.simulation.linear_loop.pole_recursion import pair_recursion

_LANES = 8
_PIECE = 512  # blocks; the functions of a piece stay in the second-level cache


class Sums(NamedTuple):
    """What is summed up over the window."""

    # The matrix G, shape (functions, functions), in the order of `Expansion.weights`
    mean_products: Array
    # Root of the energy of each pole's response, followed to rest, and of the record, over the window's
    # length, shape (poles + 1,), in m s and m/s²
    root_energy: Array


@dataclass(frozen=True, kw_only=True, eq=False)
class Responses:
    """Responses of a basis to one record."""

    blocks: Blocks  # Record and window, cut for the structure
    basis: PoleBasis  # Poles and fast pairs

    def sums(self, ahead: int) -> Sums:
        """Sum up products and energies of the responses, once for each number of blocks ahead."""
        if ahead not in self._sums:
            self._sums[ahead] = self._sum_products(ahead)
        return self._sums[ahead]

    @cached_property
    def _sums(self) -> dict[int, Sums]:
        return {}

    def _sum_products(self, ahead: int) -> Sums:
        stepping = _Stepping(self.basis, self.blocks.step)
        pieces = self._early(stepping, ahead) if ahead else self._late(stepping)
        products = _by_trapezoids(pieces, self.blocks.end) / self.blocks.intervals
        ground = self.blocks.excitation
        energy = np.append(stepping.energy, (ground.acceleration**2).sum() * ground.time_step)
        return Sums(mean_products=products, root_energy=np.sqrt(energy / ground.window_duration))

    def _late(self, stepping: "_Stepping") -> Iterator[Array]:
        """Functions of late actuators inside the window, by pieces: all φ_k and the fast pairs."""
        blocks, before = self.blocks, self.blocks.before
        if before == 0:
            yield np.zeros((1, 2 * self.basis.poles.size + self.basis.fast.pole.size))
        for begin in range(0, blocks.left.size, _PIECE):
            lines = blocks.left[begin : begin + _PIECE], blocks.right[begin : begin + _PIECE]
            functions = np.concatenate([stepping.modal(*lines), stepping.pairs(*lines)], axis=1)
            yield functions[max(0, before - 1 - begin) :]

    def _early(self, stepping: "_Stepping", ahead: int) -> Iterator[Array]:
        """Functions of early actuators inside the window: φ₀, later φ_k, ψ, and the lines of the record."""
        left, right = self.blocks.prolonged(ahead)
        count = self.basis.poles.size
        carried = np.exp(self.basis.poles[0] * ahead * self.blocks.step)
        earlier = np.zeros((ahead, 2))
        for begin in range(0, left.size, _PIECE):
            lines = left[begin : begin + _PIECE], right[begin : begin + _PIECE]
            modal = stepping.modal(*lines)
            later = modal[:, ::count].copy()
            both = np.concatenate([earlier, later])
            first, earlier = both[: later.shape[0]], both[later.shape[0] :]
            modal[:, ::count] = first
            added_real = later[:, 0] - carried.real * first[:, 0] + carried.imag * first[:, 1]
            added_imag = later[:, 1] - carried.imag * first[:, 0] - carried.real * first[:, 1]
            functions = np.column_stack([modal, added_real, added_imag, *lines])
            yield functions[max(0, self.blocks.before + ahead - 1 - begin) :]


class _Stepping:
    """Poles and fast pairs of a basis on their way through a record, piece by piece from rest."""

    def __init__(self, basis: PoleBasis, step: float) -> None:
        self._basis, self._step = basis, step
        count = basis.poles.size
        filled = -(-count // _LANES) * _LANES
        early, late, decay = ramp_weights(basis.poles, step)
        self._weights = np.zeros((6, filled))
        self._weights[:, :count] = [
            component for weight in (decay, early, late) for component in (weight.real, weight.imag)
        ]
        self._state = np.zeros((3, filled))
        self._mixture = np.zeros((2 * filled, 2 * count))
        self._mixture[:count], self._mixture[filled : filled + count] = np.split(basis.orthogonal.T, 2)
        self._pair_weights = pair_recursion(basis.fast.fast_poles, basis.fast.fast_residues, step)
        self._pair_state = np.zeros((4, self._pair_weights.shape[1]))

    def modal(self, left: Array, right: Array) -> Array:
        """All φ_k after each further block, real parts before imaginary ones, shape (blocks, 2 poles)."""
        responses = np.empty((left.size, self._mixture.shape[0]))
        _step_poles(left, right, self._weights, self._state, responses)
        return np.asarray(responses @ self._mixture)

    def pairs(self, left: Array, right: Array) -> Array:
        """Displacements of the fast pairs after each further block, shape (blocks, pairs)."""
        displacements = np.empty((left.size, self._pair_weights.shape[1]))
        _step_pairs(left, right, self._pair_weights, self._pair_state, displacements)
        return displacements

    @property
    def energy(self) -> Array:
        """Energy of each pole's response to what was stepped so far, followed to rest [m² s³]."""
        poles = self._basis.poles
        real, imag, squares = self._state[:, : poles.size]
        return np.asarray(squares * self._step + (real**2 + imag**2) / (-2.0 * poles.real))


def _by_trapezoids(pieces: Iterator[Array], end: float) -> Array:
    """Sum of the products of functions, shape (functions, functions), in units of a block.

    Every piece holds one row for each edge of a block; the window ends at a fraction of the last block.
    """
    rows, total, first = np.empty((0, 0)), np.empty((0, 0)), np.empty(0)
    for piece in pieces:
        if rows.size == 0:
            first, rows, total = piece[0], piece[:0], np.zeros((piece.shape[1], piece.shape[1]))
        total += piece.T @ piece
        rows = np.concatenate([rows[-2:], piece[-2:]])
    before, last = rows[-2:]
    ending = (1.0 - end) * before + end * last
    for weight, row in ((-0.5, first), (0.5 * end - 0.5, before), (-1.0, last), (0.5 * end, ending)):
        total += weight * np.outer(row, row)
    return total


@compiled
def _step_poles(left: Array, right: Array, weights: Array, state: Array, responses: Array) -> None:
    """Responses after each block, real parts before imaginary ones; the state is that after the last.

    The state is the real and the imaginary part of each response, and the sum of its squares.
    """
    filled = state.shape[1]
    c, s = np.empty((6, _LANES)), np.empty((3, _LANES))
    for first in range(0, filled, _LANES):
        copy_rows(weights[:, first:], c)
        copy_rows(state[:, first:], s)
        for i in range(left.size):
            a, b = left[i], right[i]
            for j in range(_LANES):
                real = c[0, j] * s[0, j] - c[1, j] * s[1, j] + (c[2, j] * a + c[4, j] * b)
                imag = c[1, j] * s[0, j] + c[0, j] * s[1, j] + (c[3, j] * a + c[5, j] * b)
                s[0, j], s[1, j] = real, imag
                s[2, j] += real * real + imag * imag
            for j in range(_LANES):
                responses[i, first + j], responses[i, filled + first + j] = s[0, j], s[1, j]
        copy_rows(s, state[:, first : first + _LANES])


@compiled
def _step_pairs(left: Array, right: Array, weights: Array, state: Array, displacements: Array) -> None:
    """Displacements of pairs after each block; the state is that after the last.

    The state is the displacement before the last, the last one, and the two ends of the last block.
    """
    for j in range(weights.shape[1]):
        c1, c2, b0, b1, d0, d1 = weights[:, j]
        before, now, a0, a1 = state[:, j]
        for i in range(left.size):
            new = c1 * now + c2 * before + b0 * left[i] + b1 * right[i] + d0 * a0 + d1 * a1
            before, now, a0, a1 = now, new, left[i], right[i]
            displacements[i, j] = new
        state[0, j], state[1, j], state[2, j], state[3, j] = before, now, a0, a1
