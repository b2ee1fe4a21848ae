"""Mean squares of the deviations of many actuators from the responses of a few poles to one record."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from reliab.loop.pole_plane.expansion import Expansion
from reliab.loop.pole_plane.responses import Responses

LEFT_OUT = 3e-5
"""Largest share of RMS^R that an expansion may leave out [-]."""


def mean_squares(
    responses: Responses, expansions: Sequence[Expansion], cells: int
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Mean square deviations of the cells for which the expansion is good enough under this record.

    Parameters
    ----------
    responses : Responses
        Responses of the basis to the record.
    expansions : sequence of Expansion
        The cells, expanded in that basis.
    cells : int
        Number of all cells.

    Returns
    -------
    mean_square : numpy.ndarray
        Mean of (x_m − x_I)² over the window [m²], shape (cells,); zero where it is not known.
    known : numpy.ndarray
        Whether what the expansion leaves out is at most `LEFT_OUT` of RMS^R, shape (cells,).
    """
    mean_square, known = np.zeros(cells), np.zeros(cells, dtype=np.bool_)
    for expansion in expansions:
        squares = responses.functions(expansion.ahead).mean_squares(expansion.weights)
        precise = responses.lost(expansion.left_out) <= LEFT_OUT * np.sqrt(squares)
        mean_square[expansion.cells[precise]] = squares[precise]
        known[expansion.cells[precise]] = True
    return mean_square, known
