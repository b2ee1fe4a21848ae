"""The motion behind a noisy displacement, by Wiener's filter.

The spectrum of the noise is extrapolated from frequencies that are too high for a signal. The smoothed
displacement p̂ is the mean of the true one given the reading, so that what it misses is independent of p̂
itself (Berkson's error): forces regressed on p̂ are not attenuated.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy import fft, ndimage

from reliab.discrepancy.noise import Periodogram, fit_noise
from reliab.loop.hybrid_test import Motion3

Array = NDArray[np.float64]

HIGHEST_SIGNAL = 45.0
"""Highest frequency [Hz] at which a test may hold a signal; above it is noise."""

_LARGEST_SHARE = 0.4  # of the sampling rate
_SMOOTHED_OVER = 0.4  # Hz
_CLEAR = 50.0  # of the noise's power
_LEAST_RELIABLE = 1.0  # Hz


def highest_frequency(rate: float) -> float:
    """Highest frequency [Hz] at which models are judged, for a sampling rate [Hz]."""
    return min(HIGHEST_SIGNAL, _LARGEST_SHARE * rate)


def reliable_frequency(displacements: Sequence[Array], step: float) -> float:
    """Highest frequency [Hz] up to which noisy displacements are nearly all signal.

    Parameters
    ----------
    displacements : sequence of numpy.ndarray
        Readings of several tests [m].
    step : float
        Step between samples [s].

    Returns
    -------
    float
        Highest frequency at which the signal's power is well above the noise's in all tests together.
    """
    clear = []
    for displacement in displacements:
        _, frequency, whole, floor = _spectra(displacement, step)
        above = frequency[(whole > _CLEAR * floor) & (frequency <= highest_frequency(1.0 / step))]
        clear.append(float(above[-1]) if above.size else 0.0)
    return max(float(np.median(clear)), _LEAST_RELIABLE)


def _spectra(displacement: Array, step: float) -> tuple[Array, Array, Array, Array]:
    """Spectrum of a displacement made antisymmetric, frequencies, its smooth power, the noise's."""
    n = displacement.size
    swing = displacement - np.linspace(displacement[0], displacement[-1], n)
    padded = np.concatenate([swing, -swing[-2:0:-1]])
    spectrum = fft.rfft(padded)
    frequency = fft.rfftfreq(padded.size, step)
    power = np.abs(spectrum) ** 2 / padded.size
    beyond = frequency > highest_frequency(1.0 / step)
    noise = fit_noise([Periodogram(frequency=frequency[beyond], power=power[beyond])], 1.0 / step)
    width = max(int(_SMOOTHED_OVER / frequency[1]), 5)
    whole = ndimage.uniform_filter1d(power, width, mode="nearest")
    return spectrum, frequency, whole, noise.density(frequency)


def smoothed_motion(displacement: Array, step: float) -> Motion3:
    """Motion behind a noisy displacement.

    Parameters
    ----------
    displacement : numpy.ndarray
        Reading [m], shape (n,).
    step : float
        Step between samples [s].

    Returns
    -------
    Motion3
        Displacement, velocity and acceleration at the samples.

    Examples
    --------
    >>> time = np.arange(0.0, 20.0, 0.002)
    >>> truth = np.sin(2.0 * np.pi * time) * np.sin(np.pi * time / 20.0)
    >>> noise = 0.1 * np.random.default_rng(1).normal(size=time.size)
    >>> found = smoothed_motion(truth + noise, 0.002).values[0]
    >>> bool(np.std(found - truth) < 0.02)
    True
    """
    n = displacement.size
    spectrum, frequency, whole, floor = _spectra(displacement, step)
    share = np.clip((whole - floor) / np.maximum(whole, 1e-300), 0.0, 1.0)
    share[frequency > highest_frequency(1.0 / step)] = 0.0
    swing = fft.irfft(share * spectrum, 2 * n - 2)[:n]
    return Motion3.through(swing + np.linspace(displacement[0], displacement[-1], n), step)
