"""Sines, sweeps and irregular motions, told from each other by their spectrum and their zeros."""

import numpy as np
from scipy import fft

from reliab.core.arrays import Array
from reliab.signals.spectra import hann, periodogram

_LINE = 0.1  # of a sine's frequency to either side
_NEARLY_ALL = 0.9  # of the power
_FEWEST_CROSSINGS, _RANK_ORDER = 8, 0.9  # of zero, and the rank correlation of their distances with time
_CLEAR = 0.2  # standard deviations from zero that noise does not cross


def kind_of_motion(driven: Array, rate: float) -> str:
    """Tell a sine, a sweep and an irregular motion, such as an earthquake's, from each other.

    `rate` [Hz].

    >>> time = np.arange(0.0, 30.0, 0.005)
    >>> [kind_of_motion(np.sin(w * time), 200.0) for w in (5.0, 0.5 * time)]
    ['sine', 'sweep']
    """
    centred_values = driven - driven.mean()
    power = periodogram(centred_values, hann(driven.size))
    frequency = fft.rfftfreq(driven.size, 1.0 / rate)[1:]
    main = float(frequency[np.argmax(power)])
    near = np.abs(frequency - main) <= max(_LINE * main, 3.0 * float(frequency[0]))
    if power[near].sum() > _NEARLY_ALL * power.sum():
        return "sine"
    clear = np.flatnonzero(np.abs(centred_values) > _CLEAR * centred_values.std())
    crossings = clear[1:][np.diff(np.signbit(centred_values[clear]))]
    if crossings.size >= _FEWEST_CROSSINGS:
        _, value, counts = np.unique(np.diff(crossings), return_inverse=True, return_counts=True)
        ranks = (np.cumsum(counts) - 0.5 * (counts - 1))[value]  # the mean one where several are equal
        order = np.corrcoef(np.arange(ranks.size), ranks)[0, 1]
        if abs(float(order)) > _RANK_ORDER:
            return "sweep"
    return "irregular motion"
