"""Histories by the Fourier transform: convolution, periodogram, the level above the motion, means of bins."""

from functools import lru_cache

import numpy as np
import scipy

from reliab.core.arrays import Array, read_only


def convolve_valid(history: Array, kernel: Array) -> Array:
    """Convolve histories with a kernel where the two overlap wholly.

    `history`: shape (…, n); `kernel`: shape (k,) with k at most n. Returns shape (…, n - k + 1).

    >>> convolve_valid(np.array([1.0, 2.0, 4.0, 8.0]), np.array([0.5, 0.5])).round(12).tolist()
    [1.5, 3.0, 6.0]
    """
    return _full(history, kernel)[..., kernel.size - 1 : history.shape[-1]].copy()


def cross_correlate(first: Array, second: Array) -> Array:
    """Sum of products of two histories at every lag of the first behind the second.

    Returns shape (2 n - 1,), of histories of one length; the lag of no samples has the place n - 1.

    >>> int(np.argmax(cross_correlate(np.array([0.0, 1.0, 0.0]), np.array([1.0, 0.0, 0.0]))))
    3
    """
    return _full(first, second[::-1])


def _full(first: Array, second: Array) -> Array:
    size = first.shape[-1] + second.size - 1
    points = scipy.fft.next_fast_len(size, real=True)
    spectrum = scipy.fft.rfft(first, points) * scipy.fft.rfft(second, points)
    return np.asarray(scipy.fft.irfft(spectrum, points)[..., :size])


def average_over_bins(frequency: Array, power: Array, bins: int) -> tuple[Array, Array, Array]:
    """Average a spectrum over bins.

    `frequency` [Hz].
    Returns mean frequency [Hz], mean power and number of frequencies of each bin that is not empty.

    >>> centre, mean, count = average_over_bins(np.array([1.0, 10.0, 11.0]), np.array([1.0, 2.0, 4.0]), 2)
    >>> centre.tolist(), mean.tolist(), count.tolist()
    ([1.0, 10.5], [1.0, 3.0], [1.0, 2.0])
    """
    edges = np.geomspace(frequency.min() * 0.999, frequency.max() * 1.001, bins + 1)
    place = np.digitize(frequency, edges) - 1
    count = np.bincount(place, minlength=bins).astype(np.float64)
    occupied_bins = count > 0
    centre = np.bincount(place, frequency, minlength=bins)[occupied_bins] / count[occupied_bins]
    mean = np.bincount(place, power, minlength=bins)[occupied_bins] / count[occupied_bins]
    return centre, mean, count[occupied_bins]


def periodogram(values: Array, taper: Array) -> Array:
    """Power of a history without its mean, over the mean square of the taper.

    `values`: a history, shape (n,); `taper`: weights that fall to zero at both ends, shape (n,). Returns |Σ x
    w e^(−iωt)|²/Σ w² at the Fourier frequencies above zero, shape (n // 2,); of white noise its mean square.
    """
    # SciPy keeps what it worked out for a length, which halves the time of one with large prime factors
    spectrum = scipy.fft.rfft((values - values.mean()) * taper)[1:]
    return np.asarray(np.abs(spectrum) ** 2 / np.sum(taper**2))


def detrend(values: Array) -> Array:
    """Take the straight line of least squares off a history, shape (n,).

    >>> detrend(np.array([1.0, 2.0, 3.0, 5.0])).round(12).tolist()
    [0.2, -0.1, -0.4, 0.3]
    """
    centred_values = values - values.mean()
    place = np.arange(values.size) - 0.5 * (values.size - 1)
    return np.asarray(centred_values - place * (float(place @ centred_values) / float(place @ place)))


def taper(name: str, size: int) -> Array:
    """Window of a name that SciPy knows, as it is repeated in a Fourier transform, shape (size,)."""
    if name == "hann":
        return hann(size)
    from scipy.signal import get_window

    return np.asarray(get_window(name, size))


@lru_cache(maxsize=16)  # a verdict asks some ninety times for windows of a few lengths
def hann(size: int) -> Array:
    """Hann's window as it is repeated in a Fourier transform, shape (size,).

    >>> hann(4).round(12).tolist()
    [0.0, 0.5, 1.0, 0.5]
    """
    return read_only(0.5 + 0.5 * np.cos(np.linspace(-np.pi, np.pi, size + 1)[:-1]))


def upper_level(power: Array) -> float:
    """Level of noise in the upper half of a periodogram, from the median of its exponential distribution.

    >>> noise = np.random.default_rng(1).normal(size=4000)
    >>> round(upper_level(periodogram(noise, np.hanning(4000))), 1)
    1.0
    """
    return float(np.median(power[power.size // 2 :])) / float(np.log(2.0))
