"""Low-pass filters without delay."""

import numpy as np
import scipy

from reliab.arrays import Array

_ROOM = 0.9  # of the Nyquist frequency: a wider pass band is no filter
_RIPPLE = 60.0  # dB
_REACH = 0.2  # share of a history that a filter may be long


def low_pass(edge: float, rate: float) -> Array:
    """Design a symmetric low-pass filter.

    `edge`: frequency [Hz] at which half of the amplitude passes; `rate`: sampling rate [Hz]. Returns
    coefficients, shape (odd,); the single 1 where the edge is too near to the Nyquist frequency.

    >>> low_pass(49.0, 100.0).tolist(), low_pass(10.0, 100.0).size % 2
    ([1.0], 1)
    """
    nyquist = 0.5 * rate
    if not edge < _ROOM * nyquist:
        return np.ones(1)
    taps, beta = scipy.signal.kaiserord(_RIPPLE, 0.6 * edge / nyquist)
    return np.asarray(scipy.signal.firwin(taps | 1, edge / nyquist, window=("kaiser", beta)))


def smoothed(values: Array, coefficients: Array) -> Array:
    """Pass a history through a symmetric filter.

    Beyond its ends the history is continued point-symmetrically about the end of a straight line through
    the nearest samples, so that the noise of the last sample is not continued with it.

    `values`: a history, shape (n,); `coefficients`: the filter, shape (odd,). Returns the filtered history,
    shape (n,); the history itself where the filter is long beside it.

    >>> smoothed(np.arange(20.0), np.array([0.25, 0.5, 0.25])).round(12).tolist() == list(range(20))
    True
    """
    reach = coefficients.size // 2
    if reach == 0 or reach > _REACH * values.size:
        return values
    before = 2.0 * _end_of_line(values[reach::-1]) - values[reach:0:-1]
    after = 2.0 * _end_of_line(values[-reach - 1 :]) - values[-2 : -reach - 2 : -1]
    return np.asarray(
        scipy.signal.fftconvolve(np.concatenate([before, values, after]), coefficients, mode="valid")
    )


def _end_of_line(values: Array) -> float:
    """Last value of the straight line of least squares through values."""
    place = np.arange(values.size) - 0.5 * (values.size - 1)
    slope = float(place @ values) / float(place @ place)
    return float(values.mean()) + slope * float(place[-1])
