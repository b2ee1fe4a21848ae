"""RMS^R and MTE^R from histories, and the statistics of many rebuilt errors at once.

Both are normalised by the peak of the exact response, as in `reliab.indices.response_error` ::

    RMS^R = √(mean (x_m − x_I)²)/max|x_I|,   MTE^R = max|x_m − x_I|/max|x_I|
"""

import numpy as np

from reliab.arrays import Array
from reliab.assessment.rebuilt_error.recursion import advance
from reliab.compiled import compiled


def mean_square(values: Array) -> float:
    """Mean square of a history over time by the trapezoidal rule."""
    inner = float(values @ values)
    return (inner - 0.5 * float(values[0] ** 2 + values[-1] ** 2)) / (values.size - 1)


def relative_errors(strayed: Array, reference: Array) -> tuple[float, float]:
    """RMS^R and MTE^R [-] of x_m − x_I and x_I [m], both shape (n,)."""
    peak = np.abs(reference).max()
    return float(np.sqrt(mean_square(strayed)) / peak), float(np.abs(strayed).max() / peak)


@compiled
def tally(
    sums: tuple[float, float, float], strayed: float, exact: float, weight: float, band: Array, sample: int
) -> tuple[float, float, float]:
    """Add a sample to the weighted squares of x_m − x_I, its peak and that of x_I, and to the band."""
    band[0, sample] += strayed
    band[1, sample] += strayed * strayed
    return sums[0] + weight * strayed * strayed, max(sums[1], abs(strayed)), max(sums[2], abs(exact))


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

    `command`, `differences`, `fed_back_late` [m]; `velocity` [m/s]; `feedback_lag` [s].
    Returns mean square of x_m − x_I [m²], its peak [m], and the peak of x_I [m], shape (draws, 3).
    """
    draws, size = state.shape[0], command.size
    answer = np.empty((draws, 3))
    scratch = np.empty(state.shape[1])
    for draw in range(draws):
        row = draw % differences.shape[0]
        sums = (0.0, 0.0, 0.0)
        before = 0.0
        held = state[draw]
        for i in range(size):
            difference = differences[row, i]
            for k in range(inputs.shape[0]):
                difference += shifts[draw, k] * inputs[k, i]
            now = difference + fed_back_late[i] + feedback_lag[draw] * velocity[i]
            if i > 0:
                advance(decay[draw], early[draw], late[draw], before, now, held, scratch)
            before = now
            error = feed_through[draw] * now
            for column in range(held.size):
                error += output[draw, column] * held[column]
            weight = 0.5 if i in (0, size - 1) else 1.0
            sums = tally(sums, error - difference, command[i] - error, weight, band, i)
        answer[draw, 0], answer[draw, 1], answer[draw, 2] = sums[0] / (size - 1), sums[1], sums[2]
    return answer
