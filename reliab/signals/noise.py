"""The noise of a channel, the steps of its converter, and Wiener's filter against it.

The power spectral density of the noise is taken as a sum, with coefficients that are not negative, of white
noise and first-order autoregressive noises of fixed corner frequencies. Their maximum-likelihood coefficients
under Whittle's approximation follow from a multiplicative iteration (majorise–minimise for the Itakura–Saito
divergence: Févotte, Bertin and Durrieu 2009, Neural Computation 21, eq. 2.16). A smooth spectrum cannot
imitate the narrow lines of a structure's response, so that an effect is not mistaken for noise.

A converter's error is neither white nor stationary: it depends on the motion, and where that rests within a
step it is the motion itself, which looks like slack. It is therefore computed from a motion, on grids of
steps that are shifted against each other, or from a model's prediction, where only the noise before the
conversion remains unknown.

The spectrum of the noise is extrapolated from frequencies that are too high for a signal. The smoothed
displacement p̂ is the mean of the true one given the reading, so that what it misses is independent of p̂
itself (Berkson's error): forces regressed on p̂ are not attenuated. A force that is bent in the velocity is
expected where the velocity spreads about that of p̂.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from reliab.core.arrays import Array
from reliab.core.compiled import compiled
from reliab.signals.spectra import average_over_bins, detrend, hann, periodogram

CORNERS = (1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0)
"""Corner frequencies of the coloured parts [Hz]."""

_UPDATES = 3000
_BINS = 160
_LOWEST_LINE = 10.0  # Hz, of the mains folded at the Nyquist frequency
_PICKUP = 0.7  # Hz
_FEWEST_BINS = 3
_LINE = 12.0  # times the local median that a periodogram must exceed to be a line of the mains

_MOST_LEVELS = 0.25  # of the samples; the error of more levels is as good as white
_FEWEST_LEVELS = 3  # any two lie on a grid
_GRID_TOLERANCE = 0.02  # of a step; a text rounds the levels once more
_LEVEL_TOLERANCE = 1e-9  # of the range: two values so near are one level
_REFINEMENTS = 3
_LARGEST_SPREAD = 0.45  # of a step; more noise than this makes the error independent of the signal
_EXACT_BELOW = 0.05
_HARMONICS = 12


@dataclass(frozen=True, kw_only=True)
class NoiseModel:
    """A smooth power spectrum."""

    rate: float  # Sampling rate [Hz]
    # Level of the white part and of each coloured part at zero frequency, shape (1 + corners,); the mean
    # square of white noise is its level
    weights: Array

    @classmethod
    def white(cls, rate: float, variance: float) -> "NoiseModel":
        """White noise of a variance."""
        return cls(rate=rate, weights=np.array([variance, *(0.0 for _ in CORNERS)]))

    def density(self, frequency: Array) -> Array:
        """Return the expected periodogram |Σxe^(−iωt)|²/n at frequencies [Hz], shape of `frequency`."""
        return np.asarray(self.weights @ noise_shapes(frequency, self.rate))

    @property
    def rms(self) -> float:
        """Root mean square of the noise."""
        frequency = np.linspace(0.0, 0.5 * self.rate, 4097)
        return float(np.sqrt(np.trapezoid(self.density(frequency), frequency) / (0.5 * self.rate)))


def noise_shapes(frequency: Array, rate: float, corners: Sequence[float] = CORNERS) -> Array:
    """Spectra of which a noise is a sum: white, then first-order autoregressive, each 1 at zero frequency.

    `frequency`: frequencies [Hz], shape (n,); `rate`: sampling rate [Hz]; `corners`: corner frequencies of
    the coloured parts [Hz]. Returns expected periodograms, shape (1 + corners, n).
    """
    cosine = np.cos(2.0 * np.pi * np.asarray(frequency) / rate)
    rho = np.exp(-2.0 * np.pi * np.asarray(corners) / rate)[:, np.newaxis]
    markov_shape = (1.0 - rho) ** 2 / (1.0 - 2.0 * rho * cosine + rho**2)
    return np.concatenate([np.ones((1, cosine.size)), markov_shape])


@dataclass(frozen=True, kw_only=True)
class Periodogram:
    """Power of a stretch of residual at its Fourier frequencies."""

    frequency: Array  # Frequencies [Hz], without zero, shape (k,)
    power: Array  # |Σxe^(−iωt)|²/n, shape (k,)


def fit_noise(periodograms: Sequence[Periodogram], rate: float, *, least: float = 0.0) -> NoiseModel:
    """Fit a smooth spectrum to periodograms of noise.

    `rate` [Hz].

    >>> noise = np.random.default_rng(1).normal(size=4096)
    >>> power = np.abs(np.fft.rfft(noise))[1:] ** 2 / 4096
    >>> found = fit_noise([Periodogram(frequency=np.fft.rfftfreq(4096, 0.01)[1:], power=power)], 100.0)
    >>> round(found.rms, 1)
    1.0
    """
    frequency = np.concatenate([periodogram.frequency for periodogram in periodograms])
    power = np.concatenate([_mask_mains(periodogram, 0.5 * rate) for periodogram in periodograms])
    valid = np.isfinite(power)
    centre, mean, count = average_over_bins(frequency[valid], power[valid], _BINS)
    shapes = noise_shapes(centre, rate)
    floor = 1e-12 * float(mean.max()) + 1e-300 + least
    start = max(float(np.average(mean, weights=count)), floor) / shapes.shape[0]
    (weights,) = fit_levels(shapes[np.newaxis], mean, count, start=start, floor=floor, updates=_UPDATES)
    weights[0] += floor
    return NoiseModel(rate=rate, weights=weights)


def fit_levels(
    shapes: Array, mean: Array, count: Array, *, start: float, floor: float, updates: int
) -> Array:
    """Fit sums of spectra, with coefficients that are not negative, to mean powers of bins.

    `shapes`: the spectra of each sum at the bins, shape (sums, parts, bins); `mean`, `count`: mean power of a
    bin and the number of frequencies in it, shape (bins,); `start`: coefficient of every part from which the
    `updates` begin; `floor`: white level that is there in any case. Returns the coefficients of the highest
    Whittle likelihood, shape (sums, parts).
    """
    weights = np.full(shapes.shape[:2], start)
    for levels, basis_shape in zip(weights, np.ascontiguousarray(shapes), strict=True):
        _improve(basis_shape, mean, count, floor, levels, updates)
    return weights


@compiled
def _improve(shapes: Array, mean: Array, count: Array, floor: float, weights: Array, updates: int) -> None:
    """Improve the coefficients in place; several bins at once where a processor can."""
    parts, bins = shapes.shape
    density, fall, rise = np.empty(bins), np.empty(bins), np.empty(bins)
    for _ in range(updates):
        density[:] = floor
        for k in range(parts):
            for i in range(bins):
                density[i] += weights[k] * shapes[k, i]
        for i in range(bins):
            fall[i] = count[i] / density[i]
            rise[i] = fall[i] * mean[i] / density[i]
        for k in range(parts):
            rises, falls = 0.0, 0.0
            for i in range(bins):
                rises += rise[i] * shapes[k, i]
                falls += fall[i] * shapes[k, i]
            weights[k] *= rises / falls


def _mask_mains(periodogram: Periodogram, nyquist: float) -> Array:
    """Power with NaN where a line of the mains stands out."""
    power = periodogram.power.copy()
    for begin, end in line_places(periodogram, nyquist):
        power[begin:end] = np.nan
    return power


def line_places(periodogram: Periodogram, nyquist: float) -> list[tuple[int, int]]:
    """Ranges of a periodogram around harmonics of 50 or 60 Hz that stand out of their surroundings.

    `nyquist` [Hz].
    """
    if periodogram.frequency.size < _FEWEST_BINS:
        return []
    spacing = float(periodogram.frequency[1] - periodogram.frequency[0])
    reach, around = max(int(0.6 / spacing), 2), max(int(3.0 / spacing), 10)
    places = []
    for line in mains_frequencies(nyquist):
        centre = round((line - float(periodogram.frequency[0])) / spacing)
        if not 0 <= centre < periodogram.power.size:
            continue
        begin, end = max(centre - reach, 0), min(centre + reach + 1, periodogram.power.size)
        wide = periodogram.power[max(centre - around, 0) : centre + around + 1]
        if periodogram.power[begin:end].max() > _LINE * np.median(wide):
            places.append((begin, end))
    return places


def mains_frequencies(nyquist: float) -> list[float]:
    """Harmonics of 50 and 60 Hz up to the seventh, folded at the Nyquist frequency [Hz]."""
    frequencies = set()
    for mains in (50.0, 60.0):
        for order in range(1, 8):
            alias_frequency = abs((order * mains + nyquist) % (2.0 * nyquist) - nyquist)
            if _LOWEST_LINE < alias_frequency < nyquist - 1.0:
                frequencies.add(round(alias_frequency, 6))
    return sorted(frequencies)


def near_mains(frequency: Array, nyquist: float) -> NDArray[np.bool_]:
    """Whether frequencies [Hz] are so near a harmonic of the mains that a line there is pickup."""
    lines = np.array(mains_frequencies(nyquist))
    return np.asarray(np.abs(frequency[:, np.newaxis] - lines).min(axis=1, initial=np.inf) < _PICKUP)


def converter_step(values: Array) -> float:
    """Step between the levels of a channel, zero where there are none.

    `values`: samples of a channel, shape (n,). Returns step in the unit of the channel, of which all levels
    are whole multiples apart.

    >>> motion = np.sin(np.linspace(0.0, 9.0, 500))
    >>> round(converter_step(np.round(motion, 1)), 9), converter_step(motion)
    (0.1, 0.0)
    """
    levels = np.unique(values)
    distances = np.diff(levels)
    distances = distances[distances > _LEVEL_TOLERANCE * np.ptp(values)]
    if not _FEWEST_LEVELS <= distances.size + 1 < _MOST_LEVELS * values.size:
        return 0.0
    levels = np.concatenate([[0.0], np.cumsum(distances)])
    step = float(distances.min())
    for _ in range(_REFINEMENTS):  # the smallest distance is a step but for what the file rounds
        places = np.concatenate([[0.0], np.cumsum(np.round(distances / step))])
        step = float(np.polyfit(places, levels, 1)[0])
    return step if np.abs(levels / step - places).max() < _GRID_TOLERANCE else 0.0


def expect_rounding_error(signal: Array, step: float, spread: float, level: float) -> Array | None:
    """Mean of what the converter adds to a signal with some noise on it.

    `signal`: predicted signal, shape (n,); `spread`: standard deviation of what is not predicted; `level`:
    one level of the converter. Returns converted minus predicted signal, shape (n,); None where so much noise
    is added that nothing is left.
    """
    share = spread / step
    if share > _LARGEST_SPREAD:
        return None
    turns = (signal - level) / step
    if share < _EXACT_BELOW:
        return np.asarray(step * (np.round(turns) - turns))
    mean_error = np.zeros_like(signal)
    for k in range(1, _HARMONICS + 1):
        weight = (-1.0) ** k / (np.pi * k) * np.exp(-2.0 * (np.pi * k * share) ** 2)
        mean_error += step * weight * np.sin(2.0 * np.pi * k * turns)
    return mean_error


_NARROW, _WIDENING = 0.2, 0.1  # Hz, and of the frequency: to either side power is averaged so far
_FEWEST = 3  # frequencies to either side
_CHANCE_SHARE = 0.6  # share of a signal that an error of a converter, which is no noise, may seem to hold
_CLEAR = 50.0  # of the noise's power
_HARMONICS_OF_SINE, _NARROW_LINE, _ALL_OF_IT = 11.0, 0.1, 0.98
_LEAST_RELIABLE = 1.0  # Hz
_LOWEST_NOISE = 2.0  # Hz, down to which noise is told from a signal
_THIRD = 2.0 ** (1.0 / 3.0)  # of an octave
_STEEPEST = _THIRD**2  # rise of first-order noise over a third of an octave
_CHANCE_DEVIATIONS = 3.0  # standard deviations of a band's mean power


def reliable_frequency(displacements: Sequence[Array], step: float, highest: float) -> float:
    """Highest frequency [Hz] up to which noisy displacements are nearly all signal.

    `displacements` [m]; `step` [s]; `highest` [Hz].
    Returns highest frequency at which the signal's power is well above the noise's in all tests together.
    """
    clear = []
    for displacement in displacements:
        _, frequency, mean_power, floor = _spectra(displacement, step, highest)
        clear_frequencies = frequency[(mean_power > _CLEAR * floor) & (frequency <= highest)]
        clear.append(float(clear_frequencies[-1]) if clear_frequencies.size else 0.0)
    return max(float(np.median(clear)), _LEAST_RELIABLE)


def harmonics_up_to(displacement: Array, step: float) -> float:
    """Highest frequency [Hz] of the harmonics that a nearly periodic displacement makes elsewhere.

    A specimen answers a sine with harmonics at which the sine itself has no power. Nothing of the motion is
    missed there, because there is none.

    `displacement` [m]; `step` [s].
    """
    power = periodogram(detrend(displacement), hann(displacement.size))
    frequency = fft.rfftfreq(displacement.size, step)[1:]
    main = float(frequency[np.argmax(power)])
    reach = max(_NARROW_LINE * main, 3.0 * float(frequency[0]))
    near = np.abs(frequency - main) <= reach
    return _HARMONICS_OF_SINE * main if power[near].sum() > _ALL_OF_IT * power.sum() else 0.0


def _spectra(displacement: Array, step: float, highest: float) -> tuple[Array, Array, Array, Array]:
    """Spectrum of a displacement made antisymmetric, frequencies, its smooth power, the noise's."""
    n = displacement.size
    swing = displacement - np.linspace(displacement[0], displacement[-1], n)
    padded_signal = np.concatenate([swing, -swing[-2:0:-1]])
    spectrum = fft.rfft(padded_signal)
    frequency = fft.rfftfreq(padded_signal.size, step)
    power = np.abs(spectrum) ** 2 / padded_signal.size
    noise = _noise_below(frequency, power, highest, 1.0 / step)
    return spectrum, frequency, _average(frequency, power, highest), noise.density(frequency)


def _noise_below(frequency: Array, power: Array, highest: float, rate: float) -> NoiseModel:
    """Fit the noise above the highest frequency of a signal, and below it as far down as there is none.

    Far above its corner coloured noise looks the same whatever its corner, so that its level below does not
    follow from the band above alone. Bands below are therefore taken in, a third of an octave at a time,
    until one rises faster than any first-order noise does, by f⁻²: that one holds a signal, whose tail may
    reach into the two bands above it.
    """
    edges = [highest]
    while edges[-1] > _LOWEST_NOISE:
        lower = edges[-1] / _THIRD
        band = (frequency > lower) & (frequency <= edges[-1])
        upper_band = (frequency > edges[-1]) & (frequency <= edges[-1] * _THIRD)
        if not (band.any() and upper_band.any()):
            break
        chance = 1.0 + _CHANCE_DEVIATIONS / np.sqrt(float(min(band.sum(), upper_band.sum())))
        if float(power[band].mean()) > _STEEPEST * chance * float(power[upper_band].mean()):
            break
        edges.append(lower)
    is_above = frequency > edges[max(len(edges) - 3, 0)]
    return fit_noise([Periodogram(frequency=frequency[is_above], power=power[is_above])], rate)


def _average(frequency: Array, power: Array, highest: float) -> Array:
    """Mean power over a band that widens with the frequency, of what may be signal or of what may not."""
    reach = np.maximum((_NARROW + _WIDENING * frequency) / frequency[1], _FEWEST).astype(int)
    places = np.arange(frequency.size)
    border = int(np.searchsorted(frequency, highest, side="right"))
    first = np.maximum(places - reach, np.where(places < border, 0, border))
    last = np.minimum(places + reach + 1, np.where(places < border, border, frequency.size))
    sums = np.concatenate([[0.0], np.cumsum(power)])
    return np.asarray((sums[last] - sums[first]) / (last - first))


def smooth_displacement(displacement: Array, step: float, highest: float) -> Array:
    """Displacement [m] behind a noisy one, shape (n,).

    `displacement` [m]; `step` [s]; `highest` [Hz].

    >>> time = np.arange(0.0, 20.0, 0.002)
    >>> truth = np.sin(2.0 * np.pi * time) * np.sin(np.pi * time / 20.0)
    >>> noise = 0.1 * np.random.default_rng(1).normal(size=time.size)
    >>> bool(np.std(smooth_displacement(truth + noise, 0.002, 45.0) - truth) < 0.02)
    True
    """
    n = displacement.size
    spectrum, frequency, mean_power, floor = _spectra(displacement, step, highest)
    share = _share(frequency, mean_power, floor, highest)
    swing = fft.irfft(share * spectrum, 2 * n - 2)[:n]
    return np.asarray(swing + np.linspace(displacement[0], displacement[-1], n))


def _share(frequency: Array, mean_power: Array, floor: Array, highest: float) -> Array:
    """Share of the signal in the power, by which the spectrum is multiplied."""
    share = np.clip((mean_power - floor) / np.maximum(mean_power, 1e-300), 0.0, 1.0)
    share[(frequency > highest) | (share < _CHANCE_SHARE)] = 0.0
    return np.asarray(share)
