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

    @cached_property
    def root_energy(self) -> NDArray[np.float64]:
        """Root of the energy of each pole's response, followed to rest, and of the record, over the window.

        Shape (poles + 1,), in m s and m/s².
        """
        ground = self.blocks.excitation
        energy = np.append(self._stepped[1], (ground.acceleration**2).sum() * ground.time_step)
        return np.sqrt(energy / ground.window_duration)

    def mean_products(self, ahead: int) -> NDArray[np.float64]:
        """Mean of the product of each two functions over the window, shape (functions, functions).

        Parameters
        ----------
        ahead : int
            Blocks by which the actuators look ahead.

        Returns
        -------
        numpy.ndarray
            The matrix G; its functions are in the order of `Expansion.weights`.
        """
        if ahead not in self._mean_products:
            functions = self._early(ahead) if ahead else self._late()
            # The trapezoidal rule; the window ends at a fraction of the last block.
            end = self.blocks.end
            functions[:, -1] = (1.0 - end) * functions[:, -2] + end * functions[:, -1]
            functions[:, 0] *= np.sqrt(0.5)
            functions[:, -2] *= np.sqrt(0.5 + 0.5 * end)
            functions[:, -1] *= np.sqrt(0.5 * end)
            self._mean_products[ahead] = functions @ functions.T / self.blocks.intervals
        return self._mean_products[ahead]

    @cached_property
    def _mean_products(self) -> dict[int, NDArray[np.float64]]:
        return {}

    def _late(self) -> NDArray[np.float64]:
        """Functions of late actuators inside the window: all φ_k and the fast pairs."""
        fast, blocks = self.basis.fast, self.blocks
        coefficients = pair_recursion(fast.fast_poles, fast.fast_residues, blocks.step)
        pairs = _step_pairs(blocks.left, blocks.right, coefficients)
        inside = slice(blocks.before, blocks.left.size + 1)
        return np.concatenate([self._stepped[0][:, inside], pairs[:, inside]])

    def _early(self, ahead: int) -> NDArray[np.float64]:
        """Functions of early actuators inside the window: φ₀, later φ_k, ψ, and the lines of the record."""
        modal, count = self._stepped[0], self.basis.poles.size
        begin, end = self.blocks.before, self.blocks.left.size + 1
        first, later = modal[::count, begin:end], modal[:, begin + ahead : end + ahead]
        carried = np.exp(self.basis.poles[0] * ahead * self.blocks.step)
        functions = np.empty((2 * count + 4, end - begin))
        functions[: 2 * count] = later
        functions[: 2 * count : count] = first
        functions[-4] = later[0] - carried.real * first[0] + carried.imag * first[1]
        functions[-3] = later[count] - carried.imag * first[0] - carried.real * first[1]
        for row, line in zip((-2, -1), self.blocks.prolonged(self.blocks.most_ahead), strict=True):
            functions[row] = line[begin + ahead - 1 : end + ahead - 1]
        return functions


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
