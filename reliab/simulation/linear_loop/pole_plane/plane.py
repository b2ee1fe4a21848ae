"""Mean squares of the deviations of many actuators, each under one of many ground motions.

Deviations are sums of shared functions of time. With the pole p, the residue r of x_m and r₀ = 1/(p₀ − p̄₀) of
x_I, and with c_k of `basis`, the deviation of a late actuator is ::

    x_m − x_I = −2Re Σ_k (r c_k − [k = 0] r₀) φ_k + fast pair

For an actuator that leads by T = nH − θ the response of the pole is taken n blocks later and multiplied by
e^(−pθ); the record's straight line in the last block corrects for the time θ
(`pole_recursion.leading_recursion`). The first function n blocks later is split into the share that cancels
the exact response, and what the record adds in these blocks::

    φ₀(t + nH) = e^(p₀nH) φ₀(t) + ψ(t)
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.compiled import compiled
from reliab.simulation.linear_loop.dominant_pole import LeadingLoop, ModalLoop
from reliab.simulation.linear_loop.pole_plane.basis import PoleBasis
from reliab.simulation.linear_loop.pole_plane.responses import Responses
from reliab.simulation.linear_loop.pole_recursion import FROM_BLOCK, leading_recursion


@dataclass(frozen=True, kw_only=True, eq=False)
class Expansion:
    """Weights of actuators that look the same number of blocks ahead."""

    cells: NDArray[np.intp]  # Which cells, shape (n,)
    # Blocks by which the displacement is ahead of the exact response; 0 for actuators that are late
    ahead: int
    weights: Array  # Weight of each function that `Responses` steps, shape (n, functions)
    # Largest displacement that is left out, for responses of size 1 of the poles and, last, for a ground
    # acceleration of size 1, shape (n, poles + 1)
    left_out: Array


def expansions(
    basis: PoleBasis, parts: Sequence[tuple[NDArray[np.intp], ModalLoop | LeadingLoop]], step: float
) -> list[Expansion]:
    """Expand the deviations of all cells whose poles are near enough to that of the structure.

    `step` [s].
    Returns one for each number of blocks that cells look ahead; cells that cannot be expanded are in none.
    """
    expanded = []
    for cells, loop in parts:
        if isinstance(loop, ModalLoop):
            expanded.append(_late(basis, cells, loop))
        else:
            expanded += _early(basis, cells, loop, step)
    return [expansion for expansion in expanded if expansion.cells.size]


def _late(basis: PoleBasis, cells: NDArray[np.intp], loop: ModalLoop) -> Expansion:
    shares, left_out = basis.coefficients(loop.pole)
    fast, fast_left_out = basis.fast_coefficients(loop)
    amplitudes = loop.residue * shares
    amplitudes[0] -= 1.0 / (2j * basis.structure.pole.imag)
    weights = np.concatenate([-2.0 * amplitudes.real, 2.0 * amplitudes.imag, fast]).T
    usable = np.isfinite(left_out)
    neglected = 2.0 * np.abs(loop.residue * shares) * np.where(usable, left_out, 0.0)
    neglected = np.concatenate([neglected, fast_left_out[np.newaxis]])
    return Expansion(
        cells=cells[usable], ahead=0, weights=weights[usable].copy(), left_out=neglected.T[usable]
    )


def _early(basis: PoleBasis, cells: NDArray[np.intp], loop: LeadingLoop, step: float) -> list[Expansion]:
    shares, left_out = basis.coefficients(loop.pole)
    ahead, recursion = leading_recursion(loop, step)
    back = ahead * step - loop.lead
    carried = loop.residue * np.exp(-loop.pole * back)
    amplitudes = carried * shares
    passed = amplitudes[:1].copy()
    amplitudes[0] *= np.exp(basis.structure.pole * ahead * step)
    amplitudes[0] -= 1.0 / (2j * basis.structure.pole.imag)
    weights = np.concatenate(
        [
            -2.0 * amplitudes.real,
            2.0 * amplitudes.imag,
            -2.0 * passed.real,
            2.0 * passed.imag,
            recursion[FROM_BLOCK],
        ]
    ).T
    usable = np.isfinite(left_out)
    neglected = 2.0 * np.abs(carried * shares) * np.where(usable, left_out, 0.0)
    neglected = np.concatenate([neglected, np.zeros((1, cells.size))]).T
    groups = []
    for count in np.unique(ahead[usable]):
        alike = (ahead == count) & usable
        groups.append(
            Expansion(
                cells=cells[alike], ahead=int(count), weights=weights[alike].copy(), left_out=neglected[alike]
            )
        )
    return groups


LEFT_OUT = 3e-5
"""Largest share of RMS^R that an expansion may leave out [-]."""


def mean_squares(
    responses: Sequence[Responses], expansions: Sequence[Expansion], motion: NDArray[np.int64]
) -> tuple[Array, NDArray[np.bool_]]:
    """Mean square deviations where the expansion is precise enough under the motion.

    Returns `mean_square`: mean of (x_m − x_I)² over the window [m²], shape (cells,); zero where it is not
    known.
    Returns `precise_cells`: where the expansion leaves out at most `LEFT_OUT` of RMS^R, shape (cells,).
    """
    mean_square, precise_cells = np.zeros(motion.size), np.zeros(motion.size, dtype=np.bool_)
    for expansion in expansions:
        under = motion[expansion.cells]
        motions = np.unique(under)
        place = np.searchsorted(motions, under)
        sums = [responses[k].sums(expansion.ahead) for k in motions]
        products, energy = (np.stack(arrays) for arrays in zip(*sums, strict=True))
        squares = _quadratic_forms(expansion.weights, products, place)
        left_out = np.einsum("ij,ij->i", expansion.left_out, energy[place])
        precise = left_out <= LEFT_OUT * np.sqrt(squares)
        mean_square[expansion.cells[precise]] = squares[precise]
        precise_cells[expansion.cells[precise]] = True
    return mean_square, precise_cells


@compiled
def _quadratic_forms(weights: Array, products: Array, which: NDArray[np.int64]) -> Array:
    """Form wᵀGw with one of several symmetric G for each row w of the weights; never below zero."""
    forms = np.empty(which.size)
    count = weights.shape[1]
    for row in range(which.size):
        w, total = weights[row], 0.0
        for k in range(count):
            g, product = products[which[row], k], 0.0
            for m in range(count):
                product += g[m] * w[m]
            total += w[k] * product
        forms[row] = max(total, 0.0)
    return forms
