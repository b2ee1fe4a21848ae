"""The band in which a block's input tells anything of its output."""

import numpy as np

from reliab.arrays import Array
from reliab.discrepancy.fitting.fit import Fit
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.spectra.segment import Segment

_LEAST_EXPLAINED = 0.5  # of the channel's power
_SMOOTHED = 1.0  # Hz
_FINEST = 0.1  # Hz


def informed_up_to(problem: Problem, fitted: Fit) -> float:
    """Frequency above the strongest motion from which a model explains less than half of the channel [Hz].

    Returns the highest frequency that is judged, where the model explains more than half of the power up to
    there.
    """
    remainders = problem.residuals(fitted.space, fitted.coordinates)
    highest = max(segment.highest for segment in problem.segments)
    grid = np.arange(_FINEST, highest, _FINEST)
    signal, remainder = np.zeros(grid.size), np.zeros(grid.size)
    for segment in problem.segments:
        signal += _power_of(segment, problem.measured(segment.test), grid)
        remainder += _power_of(segment, remainders[segment.test], grid)
    strongest = int(np.argmax(signal))
    unexplained = np.flatnonzero(remainder[strongest:] > (1.0 - _LEAST_EXPLAINED) * signal[strongest:])
    return float(grid[strongest + unexplained[0]]) if unexplained.size else highest


def _power_of(segment: Segment, values: Array, grid: Array) -> Array:
    """Mean power within half a hertz of each frequency of a grid, shape of `grid`."""
    frequency, power = segment.frequency[1:], np.abs(segment.spectrum(values)[1:]) ** 2
    total = np.concatenate([[0.0], np.cumsum(power)])
    begin = np.searchsorted(frequency, grid - 0.5 * _SMOOTHED)
    end = np.searchsorted(frequency, grid + 0.5 * _SMOOTHED, side="right")
    return np.asarray((total[end] - total[begin]) / np.maximum(end - begin, 1))
