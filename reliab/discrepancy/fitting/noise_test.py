"""Whether a model's residual is noise: its energy must be spread evenly over time and frequency.

The whitened spectrum of a residual that is noise is a sequence of independent complex normal numbers, and so
is its transform over any band to instants within that band. The energy in each cell of such a division is
exponentially distributed, whatever the size of the cells; each test has a level of its own, because a load
cell is noisier on another day and in another range. The error of a model lies where the motion was: in
lines under a sine, on a ridge under a sweep, in the strong phase under an earthquake; cells there hold far
more energy than noise would. The share of the energy in such cells is what this test measures.
"""

import numpy as np

from reliab.core.arrays import Array, Spectrum
from reliab.discrepancy.fitting.fit import Fit
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.segment import split_by_segment
from reliab.signals.noise import near_mains

LARGEST_STRUCTURED_SHARE = 0.02
"""Largest share of a residual's energy in cells that noise would not fill for it to count as noise."""

_DOMINANT = 0.05
"""Share from which the residual counts as an error of the model."""

_STEPS = 1.0  # of a converter: within this RMS what is left is its own error, which is structured, too

_BANDS = (1, 4, 16, 64, 256, 1024)  # bins that are transformed together
_EXCESS = 7.0  # times the mean energy; noise has a thousandth of its energy above


def share_structured(problem: Problem, fit: Fit) -> float:
    """Share of a residual's energy that is more concentrated than noise would be."""
    spectra = list(_spectra(problem, fit.residual).values())
    return max(_share(spectra, size) for size in _BANDS)


def is_model_error(problem: Problem, fit: Fit) -> bool:
    """Whether a model's residual is an error of the model rather than noise."""
    return share_structured(problem, fit) > _DOMINANT and not _is_within_steps(problem, fit)


def is_noise(problem: Problem, fit: Fit) -> bool:
    """Whether a model's residual is compatible with noise, or with the error of a converter."""
    return is_spread(problem, fit) or _is_within_steps(problem, fit)


def is_spread(problem: Problem, fit: Fit) -> bool:
    """Whether a model's residual is spread over time and frequency as noise is."""
    return share_structured(problem, fit) <= LARGEST_STRUCTURED_SHARE


def noise_like_tests(problem: Problem, fit: Fit) -> frozenset[int]:
    """Find the tests in each of which what a model leaves, whitened by its noise, is spread as noise is.

    Or it stays within a step of the converter, whose own error follows the motion.
    """
    residual = problem.whiten(fit.space, fit.coordinates, fit.noise)
    spectra = _spectra(problem, residual)
    quantised_tests = _tests_within_steps(problem, fit)
    return frozenset(
        test
        for test, test_spectra in spectra.items()
        if test in quantised_tests
        or max(_share([test_spectra], size) for size in _BANDS) <= LARGEST_STRUCTURED_SHARE
    )


def _is_within_steps(problem: Problem, fit: Fit) -> bool:
    """Whether what a model leaves stays within a step of the converter in every test."""
    return len(_tests_within_steps(problem, fit)) == len(problem.steps)


def _tests_within_steps(problem: Problem, fit: Fit) -> frozenset[int]:
    """Find the tests in which what a model leaves stays within a step of the converter."""
    if not any(step > 0.0 for step in problem.steps.values()):
        return frozenset()
    residual = problem.residuals(fit)
    return frozenset(
        test for test, values in residual.items() if float(np.std(values)) < _STEPS * problem.steps[test]
    )


def _spectra(problem: Problem, residual: Array) -> dict[int, list[Spectrum]]:
    """Whitened complex spectra of the segments of each test, without zero frequency and pickup."""
    spectra: dict[int, list[Spectrum]] = {}
    for segment, rows in split_by_segment(problem.segments, residual):
        spectrum = (rows[1 : segment.bins] + 1j * rows[segment.bins :]) / np.sqrt(2.0)
        clean = ~near_mains(segment.frequency[1:], 0.5 * problem.block.rate)
        spectra.setdefault(segment.test, []).append(np.asarray(spectrum[clean], dtype=np.complex128))
    return spectra


def _share(spectra: list[list[Spectrum]], size: int) -> float:
    total_energy = concentrated_energy = 0.0
    for spectra_of_test in spectra:
        power = np.concatenate([np.zeros(0), *(_cells(spectrum, size) for spectrum in spectra_of_test)])
        if power.size:
            total_energy += float(power.sum())
            concentrated_energy += float(np.maximum(power - _EXCESS * power.mean(), 0.0).sum())
    return concentrated_energy / total_energy if total_energy > 0.0 else 0.0


def _cells(spectrum: Spectrum, size: int) -> Array:
    """Energy of a spectrum in bands of a size and instants within them."""
    bands = spectrum[: spectrum.size // size * size].reshape(-1, size)
    return np.asarray(np.abs(np.fft.ifft(bands, axis=1) * np.sqrt(size)).ravel() ** 2)
