"""The shared functions of time under one ground motion, and the mean square of any sum of them.

The poles of a basis are stepped through the record once. All deviations of the plane being sums
Σ w_k f_k(t) of the same functions, the mean square of each is a quadratic form::

    mean (x_m − x_I)² = wᵀGw,     G_kl = mean f_k f_l

whatever the number of actuators. What the expansion leaves out of a response to a pole p_k has at most the
energy of that response followed to rest, ∫|z_k|² dt + |z_k(end)|²/(−2Re p_k), which the stepping sums up.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from reliab.compiled import compiled
from reliab.loop.blocks import Blocks, ramp_weights
from reliab.loop.pole_plane.basis import PoleBasis
from reliab.loop.pole_recursion import pair_recursion

_LANES, _TILE = 8, 64


@dataclass(frozen=True, kw_only=True, eq=False)
class Functions:
    """The functions inside the window, for actuators that look the same number of blocks ahead.

    Attributes
    ----------
    values : numpy.ndarray
        At the edges of the blocks and at the end of the window, shape (functions, samples).
    end : float
        Fraction of the last block at which the window ends, in (0, 1].
    """

    values: NDArray[np.float64]
    end: float

    @cached_property
    def mean_products(self) -> NDArray[np.float64]:
        """Mean of the product of each two functions over the window, shape (functions, functions)."""
        samples = self.values.shape[1]
        weights = np.ones(samples)
        weights[0] = 0.5
        weights[-2] = 0.5 + 0.5 * self.end if samples > 2 else 0.5 * self.end
        weights[-1] = 0.5 * self.end
        weighted = self.values * weights
        products: NDArray[np.float64] = weighted @ self.values.T / (samples - 2 + self.end)
        return products

    def mean_squares(self, weights: NDArray[np.float64]) -> NDArray[np.float64]:
        """Mean square of sums of the functions, of weights of shape (sums, functions)."""
        squares: NDArray[np.float64] = ((weights @ self.mean_products) * weights).sum(axis=1)
        return np.maximum(squares, 0.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class Responses:
    """Responses of a basis to one record.

    Parameters
    ----------
    blocks : Blocks
        Record and window, cut for the structure.
    basis : PoleBasis
        Poles and fast pairs.
    """

    blocks: Blocks
    basis: PoleBasis

    @cached_property
    def _stepped(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """All φ_k, real parts before imaginary ones, and the energy of each pole's response."""
        poles, step = self.basis.poles, self.blocks.step
        lines = self.blocks.prolonged(self.blocks.most_ahead)
        responses, energy = _step_poles(*lines, *ramp_weights(poles, step))
        count = poles.size
        rest = (responses[:count, -1] ** 2 + responses[count:, -1] ** 2) / (-2.0 * poles.real)
        return self.basis.orthogonal @ responses, energy * step + rest

    def lost(self, left_out: NDArray[np.float64]) -> NDArray[np.float64]:
        """Largest root mean square that expansions leave out [m], of the shape (cells, poles)."""
        duration = self.blocks.intervals * self.blocks.step
        bound: NDArray[np.float64] = (left_out * np.sqrt(self._stepped[1] / duration)).sum(axis=1)
        return bound

    def functions(self, ahead: int) -> Functions:
        """Functions for actuators that look a number of blocks ahead, in the order of `Expansion.weights`."""
        return self._late if ahead == 0 else self._early(ahead)

    @cached_property
    def _late(self) -> Functions:
        fast = self.basis.fast
        coefficients = pair_recursion(fast.fast_poles, fast.fast_residues, self.blocks.step)
        edges = self.blocks.left.size + 1
        pairs = _step_pairs(self.blocks.left, self.blocks.right, coefficients)
        return self._inside(np.concatenate([self._stepped[0][:, :edges], pairs]))

    def _early(self, ahead: int) -> Functions:
        if ahead not in self._by_ahead:
            self._by_ahead[ahead] = self._shifted(ahead)
        return self._by_ahead[ahead]

    @cached_property
    def _by_ahead(self) -> dict[int, Functions]:
        return {}

    def _shifted(self, ahead: int) -> Functions:
        modal, count = self._stepped[0], self.basis.poles.size
        edges = self.blocks.left.size + 1
        later = modal[:, ahead : ahead + edges].copy()
        first = modal[:: count, :edges]
        carried = np.exp(self.basis.poles[0] * ahead * self.blocks.step)
        turned = np.stack(
            [
                carried.real * first[0] - carried.imag * first[1],
                carried.imag * first[0] + carried.real * first[1],
            ]
        )
        driven = later[::count] - turned
        later[::count] = first
        left, right = (line[ahead - 1 : ahead - 1 + edges] for line in self.blocks.prolonged(self.blocks.most_ahead))
        return self._inside(np.concatenate([later, driven, left[np.newaxis], right[np.newaxis]]))

    def _inside(self, values: NDArray[np.float64]) -> Functions:
        """Keep what is inside the window, which ends at a fraction of the last block."""
        inside = values[:, self.blocks.before :].copy()
        end = self.blocks.end
        inside[:, -1] = (1.0 - end) * inside[:, -2] + end * inside[:, -1]
        return Functions(values=inside, end=end)


@compiled
def _step_poles(
    left: NDArray[np.float64],
    right: NDArray[np.float64],
    early: NDArray[np.complex128],
    late: NDArray[np.complex128],
    decay: NDArray[np.complex128],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Responses at all edges, real parts before imaginary ones, and the sum of their squares.

    Stored by tiles, because a step writes to as many places of the memory as there are poles.
    """
    count = decay.size
    responses, energy = np.zeros((2 * count, left.size + 1)), np.empty(count)
    c, x, y, sums = np.zeros((6, _LANES)), np.zeros(_LANES), np.zeros(_LANES), np.zeros(_LANES)
    u, v = np.empty((_TILE, _LANES)), np.empty((_TILE, _LANES))
    for first in range(0, count, _LANES):
        lanes = min(_LANES, count - first)
        for j in range(lanes):
            p = first + j
            c[0, j], c[1, j], c[2, j] = decay[p].real, decay[p].imag, early[p].real
            c[3, j], c[4, j], c[5, j] = early[p].imag, late[p].real, late[p].imag
            x[j], y[j], sums[j] = 0.0, 0.0, 0.0
        for begin in range(0, left.size, _TILE):
            size = min(_TILE, left.size - begin)
            for i in range(size):
                a, b = left[begin + i], right[begin + i]
                for j in range(_LANES):
                    real = c[0, j] * x[j] - c[1, j] * y[j] + (c[2, j] * a + c[4, j] * b)
                    imag = c[1, j] * x[j] + c[0, j] * y[j] + (c[3, j] * a + c[5, j] * b)
                    x[j], y[j], u[i, j], v[i, j] = real, imag, real, imag
                    sums[j] += real * real + imag * imag
            for j in range(lanes):
                responses[first + j, begin + 1 : begin + 1 + size] = u[:size, j]
                responses[count + first + j, begin + 1 : begin + 1 + size] = v[:size, j]
        energy[first : first + lanes] = sums[:lanes]
    return responses, energy


@compiled
def _step_pairs(
    left: NDArray[np.float64], right: NDArray[np.float64], coefficients: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Displacements of pairs at all edges, shape (pairs, edges)."""
    pairs = coefficients.shape[1]
    displacements = np.zeros((pairs, left.size + 1))
    for j in range(pairs):
        c1, c2, b0, b1, d0, d1 = coefficients[:, j]
        before, now, a0, a1 = 0.0, 0.0, 0.0, 0.0
        for i in range(left.size):
            new = c1 * now + c2 * before + b0 * left[i] + b1 * right[i] + d0 * a0 + d1 * a1
            before, now, a0, a1 = now, new, left[i], right[i]
            displacements[j, i + 1] = new
    return displacements
