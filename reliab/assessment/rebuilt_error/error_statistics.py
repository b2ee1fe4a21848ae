"""RMS^R and MTE^R from histories, and the statistics of many rebuilt errors at once.

Both are normalised by the peak of the exact response, as in `reliab.indices.response_error` ::

    RMS^R = √(mean (x_m − x_I)²)/max|x_I|,   MTE^R = max|x_m − x_I|/max|x_I|
"""

import numpy as np
from numpy.typing import NDArray

from reliab.assessment.rebuilt_error.recursion import advance
from reliab.compiled import compiled

Array = NDArray[np.float64]


def mean_square(values: Array) -> float:
    """Mean square of a history over time by the trapezoidal rule."""
    inner = float(values @ values)
    return (inner - 0.5 * float(values[0] ** 2 + values[-1] ** 2)) / (values.size - 1)


@compiled
def sweep_draws(
    decay: Array,
    early: Array,
    late: Array,
    output: Array,
    feed_through: Array,
    state: Array,
    command: Array,
    differences: Array,
    inputs: Array,
    shifts: Array,
    fed_back_late: Array,
    velocity: Array,
    feedback_lag: Array,
    band: Array,
) -> Array:
    """Statistics of the error for many sets of parameters.

    Parameters
    ----------
    decay, early, late, output, feed_through : numpy.ndarray
        Recursion of each draw, shapes (draws, 2n, 2n), (draws, 2n), (draws, 2n), (draws, 2n), (draws,).
    state : numpy.ndarray
        State at the first sample, shape (draws, 2n); changed in place to that at the last one.
    command : numpy.ndarray
        x_c [m], shape (n,).
    differences : numpy.ndarray
        x_c − x_m [m], shape (rows, n); the draws take the rows in turn.
    inputs : numpy.ndarray
        x_m, x_m' and one, shape (3, n).
    shifts : numpy.ndarray
        Factors by which each draw adds these inputs to x_c − x_m, shape (draws, 3).
    fed_back_late : numpy.ndarray
        What the known lag of the fed-back force adds to the input of the recursion [m], shape (n,).
    velocity : numpy.ndarray
        x_m' [m/s], shape (n,).
    feedback_lag : numpy.ndarray
        Further lag of the fed-back force [s], shape (draws,).
    band : numpy.ndarray
        Receives the sum and the sum of squares of the error over the draws, shape (2, n).

    Returns
    -------
    numpy.ndarray
        Mean square of x_m − x_I [m²], its peak [m], and the peak of x_I [m], shape (draws, 3).
    """
    draws, size = state.shape[0], command.size
    answer = np.empty((draws, 3))
    scratch = np.empty(state.shape[1])
    for draw in range(draws):
        row = draw % differences.shape[0]
        total, peak, ideal = 0.0, 0.0, 0.0
        before = 0.0
        held = state[draw]
        for i in range(size):
            difference = differences[row, i]
            for k in range(3):
                difference += shifts[draw, k] * inputs[k, i]
            now = difference + fed_back_late[i] + feedback_lag[draw] * velocity[i]
            if i > 0:
                advance(decay[draw], early[draw], late[draw], before, now, held, scratch)
            before = now
            error = feed_through[draw] * now
            for column in range(held.size):
                error += output[draw, column] * held[column]
            strayed = error - difference
            weight = 0.5 if i in (0, size - 1) else 1.0
            total += weight * strayed * strayed
            peak = max(peak, abs(strayed))
            ideal = max(ideal, abs(command[i] - error))
            band[0, i] += strayed
            band[1, i] += strayed * strayed
        answer[draw, 0] = total / (size - 1)
        answer[draw, 1] = peak
        answer[draw, 2] = ideal
    return answer
