"""Histories over frequency, and over time and frequency: Fourier and lapped transforms.

Lapped cosine transform: frames of two hops, each overlapping the next by half, under a window that
conserves power (Princen, Johnson and Bradley 1987, IEEE ICASSP; the window is that of the Vorbis
specification, section 4.3.1). White noise of variance σ² gives coefficients of variance σ² that are
uncorrelated; coefficient k of a frame stands at the frequency (k + 1/2)/(2·hop·step).

Sines, sweeps and irregular motions are told from each other by their spectrum and their zeros.
"""

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


def analyse(values: Array, hop: int) -> Array:
    """Transform a history."""
    frames = -(-values.size // hop) + 1
    padding = frames * hop - values.size
    start_extension, end_extension = 2.0 * values[0] - values[hop:0:-1], np.full(padding, values[-1])
    reflection = 2.0 * values[-1] - values[-2::-1][:padding]
    end_extension[: reflection.size] = reflection
    blocks = np.concatenate([start_extension, values, end_extension]).reshape(frames + 1, hop)
    window, half = _window(hop), hop // 2
    early, late = blocks[:-1] * window[:hop], blocks[1:] * window[hop:]
    folded_frames = np.concatenate(
        [-late[:, half - 1 :: -1] - late[:, half:], early[:, :half] - early[:, : half - 1 : -1]], axis=1
    )
    return np.asarray(scipy.fft.dct(folded_frames, type=4, norm="ortho", axis=1))


def synthesise(coefficients: Array, size: int) -> Array:
    """Give histories back.

    >>> history = np.cumsum(np.random.default_rng(0).standard_normal(100))
    >>> bool(np.allclose(synthesise(analyse(history, 16)[np.newaxis], 100)[0], history))
    True
    """
    hop = coefficients.shape[-1]
    folded_frames = scipy.fft.dct(coefficients, type=4, norm="ortho", axis=-1)
    window, half = _window(hop), hop // 2
    first, second = folded_frames[..., :half], folded_frames[..., half:]
    early = np.concatenate([second, -second[..., ::-1]], axis=-1) * window[:hop]
    late = np.concatenate([-first[..., ::-1], -first], axis=-1) * window[hop:]
    blocks = early[:, 1:] + late[:, :-1]
    return np.ascontiguousarray(blocks.reshape(coefficients.shape[0], -1)[:, :size])


@lru_cache(maxsize=16)
def _window(hop: int) -> Array:
    place = np.pi * (np.arange(2 * hop) + 0.5) / (2 * hop)
    return np.asarray(np.sin(0.5 * np.pi * np.sin(place) ** 2))


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
    frequency = scipy.fft.rfftfreq(driven.size, 1.0 / rate)[1:]
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
