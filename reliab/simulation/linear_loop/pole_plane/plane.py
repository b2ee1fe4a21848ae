"""Mean squares of the deviations of many actuators, each under one of many ground motions."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from reliab.compiled import compiled
from reliab.simulation.linear_loop.pole_plane.expansion import Expansion
from reliab.simulation.linear_loop.pole_plane.responses import Responses

LEFT_OUT = 3e-5
"""Largest share of RMS^R that an expansion may leave out [-]."""


def mean_squares(
    responses: Sequence[Responses], expansions: Sequence[Expansion], motion: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Mean square deviations where the expansion is precise enough under the motion.

    Returns mean_square [m²].
    Returns `mean_square`: mean of (x_m − x_I)² over the window [m²], shape (cells,); zero where it is not
    known.
    Returns `known`: whether what the expansion leaves out is at most `LEFT_OUT` of RMS^R, shape (cells,).
    """
    mean_square, known = np.zeros(motion.size), np.zeros(motion.size, dtype=np.bool_)
    for expansion in expansions:
        under = motion[expansion.cells]
        asked = np.unique(under)
        place = np.searchsorted(asked, under)
        sums = [responses[k].sums(expansion.ahead) for k in asked]
        products, energy = (np.stack(part) for part in zip(*sums, strict=True))
        squares = _quadratic_forms(expansion.weights, products, place)
        left_out = np.einsum("ij,ij->i", expansion.left_out, energy[place])
        precise = left_out <= LEFT_OUT * np.sqrt(squares)
        mean_square[expansion.cells[precise]] = squares[precise]
        known[expansion.cells[precise]] = True
    return mean_square, known


@compiled
def _quadratic_forms(
    weights: NDArray[np.float64], products: NDArray[np.float64], which: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Form wᵀGw with one of several symmetric G for each row w of the weights; never below zero."""
    forms = np.empty(which.size)
    count = weights.shape[1]
    for row in range(which.size):
        w, total = weights[row], 0.0
        for k in range(count):
            g, part = products[which[row], k], 0.0
            for m in range(count):
                part += g[m] * w[m]
            total += w[k] * part
        forms[row] = max(total, 0.0)
    return forms
