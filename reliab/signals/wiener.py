"""Wiener's filter of a noisy displacement, and how far the signal in it reaches.

The spectrum of the noise is extrapolated from frequencies that are too high for a signal. The smoothed
displacement p̂ is the mean of the true one given the reading, so that what it misses is independent of p̂
itself (Berkson's error): forces regressed on p̂ are not attenuated. A force that is bent in the velocity is
expected where the velocity spreads about that of p̂.
"""

from collections.abc import Sequence

import numpy as np
from scipy import fft

from reliab.core.arrays import Array
from reliab.signals.noise import NoiseModel, Periodogram, fit_noise
from reliab.signals.spectra import detrend, hann, periodogram

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


def velocity_spread(displacement: Array, step: float, highest: float) -> float:
    """Return how far the velocity spreads about that of the smoothed motion, its standard deviation [m/s]."""
    _, frequency, mean_power, floor = _spectra(displacement, step, highest)
    missed_power = _share(frequency, mean_power, floor, highest) * floor * (2.0 * np.pi * frequency) ** 2
    return float(np.sqrt(missed_power.sum() / displacement.size))


def _share(frequency: Array, mean_power: Array, floor: Array, highest: float) -> Array:
    """Share of the signal in the power, by which the spectrum is multiplied."""
    share = np.clip((mean_power - floor) / np.maximum(mean_power, 1e-300), 0.0, 1.0)
    share[(frequency > highest) | (share < _CHANCE_SHARE)] = 0.0
    return np.asarray(share)
