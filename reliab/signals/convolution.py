"""Convolution and correlation by the fast Fourier transform."""

import numpy as np
import scipy

from reliab.arrays import Array


def convolved(history: Array, kernel: Array) -> Array:
    """Convolve histories with a kernel where the two overlap wholly.

    `history`: shape (…, n); `kernel`: shape (k,) with k at most n. Returns shape (…, n - k + 1).

    >>> convolved(np.array([1.0, 2.0, 4.0, 8.0]), np.array([0.5, 0.5])).round(12).tolist()
    [1.5, 3.0, 6.0]
    """
    return _full(history, kernel)[..., kernel.size - 1 : history.shape[-1]].copy()


def correlated(first: Array, second: Array) -> Array:
    """Sum of products of two histories of one length at every lag of the first behind the second.

    Returns shape (2 n - 1,); the lag of no samples has the place n - 1.

    >>> int(np.argmax(correlated(np.array([0.0, 1.0, 0.0]), np.array([1.0, 0.0, 0.0]))))
    3
    """
    return _full(first, second[::-1])


def _full(first: Array, second: Array) -> Array:
    size = first.shape[-1] + second.size - 1
    points = scipy.fft.next_fast_len(size, real=True)
    spectrum = scipy.fft.rfft(first, points) * scipy.fft.rfft(second, points)
    return np.asarray(scipy.fft.irfft(spectrum, points)[..., :size])
