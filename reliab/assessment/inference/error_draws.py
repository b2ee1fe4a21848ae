"""Errors of a test over the draws of its posterior: values, intervals, probability, histories with a band."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from reliab.assessment.inference.channel_spectra import ChannelSpectra
from reliab.assessment.inference.experiment import Experiment
from reliab.assessment.inference.posterior import TestPosterior
from reliab.assessment.inference.rebuilt import rebuild, relative_errors
from reliab.assessment.rebuilt_error.interval import ACCURACY
from reliab.assessment.rebuilt_error.spread import ENDS, Estimate, weighted_quantiles
from reliab.core.arrays import Array, Spectrum
from reliab.core.vocabulary import Metric


@dataclass(frozen=True, kw_only=True, eq=False)
class ErrorDraws:
    """Errors of one displacement over the draws of a posterior."""

    name: str
    rms: Array  # RMS^R [-], shape (draws,)
    mte: Array  # MTE^R [-], shape (draws,)
    weights: Array  # Of the draws, sum one, shape (draws,)

    def errors(self, metric: Metric) -> Array:
        """Return the errors [-], shape (draws,)."""
        return self.rms if metric is Metric.RMS else self.mte

    def estimate(self, metric: Metric) -> Estimate:
        """Return the median and the 90 % interval."""
        value, low, high = weighted_quantiles(self.errors(metric), self.weights, 0.5, *ENDS)
        return Estimate(value=value, low=low, high=high)


@dataclass(frozen=True, kw_only=True, eq=False)
class ErrorsOfTest:
    """What the posterior of a test says of its error, for each interface displacement."""

    displacements: tuple[ErrorDraws, ...]
    deviation: Array  # Standard deviation of x_m − x_I [m], shape (p, m)
    exact_spectrum: Spectrum  # Mean of x_I [m], shape (p, K)
    error_spectrum: Spectrum  # Mean of x_m − x_I [m], shape (p, K)
    factors: Array  # From RMS^R and MTE^R on the coarse grid to those on the record's [-], shape (2, p)

    @property
    def largest(self) -> int:
        """Place of the displacement with the largest median RMS^R."""
        medians = [error.estimate(Metric.RMS).value for error in self.displacements]
        return int(np.argmax(medians))


def draw_errors(posterior: TestPosterior, names: Sequence[str], seed: int = 0) -> ErrorsOfTest:
    """Rebuild the error in every draw of a posterior; `names` of the interface displacements.

    `seed`: of the noise of the sensors.
    """
    channels, partition = posterior.circumstances.channels, posterior.circumstances.partition
    draws, weights = posterior.draws.values.shape[0], posterior.draws.weights
    rms, mte = np.empty((draws, partition.degrees)), np.empty((draws, partition.degrees))
    mean, square = np.zeros((2, partition.degrees, channels.band.samples))
    spectra = np.zeros((2, partition.degrees, channels.band.bins), dtype=np.complex128)
    generator = np.random.default_rng(seed)
    for row, experiment in enumerate(posterior.experiments()):
        experiment.noise = channels.draw_noise(generator)
        rebuilt = rebuild(channels, partition, experiment)
        both = np.stack([rebuilt.error, rebuilt.exact])
        histories = channels.band.history(both)
        rms[row], mte[row] = relative_errors(histories[0], histories[1])
        numerical_factor = 1.0 + ACCURACY * generator.standard_normal()
        rms[row], mte[row] = numerical_factor * rms[row], numerical_factor * mte[row]
        mean += weights[row] * histories[0]
        square += weights[row] * histories[0] ** 2
        spectra += weights[row] * both
    factors = _between_samples(channels, spectra)
    rms, mte = factors[0] * rms, factors[1] * mte
    return ErrorsOfTest(
        displacements=tuple(
            ErrorDraws(name=name, rms=rms[:, place], mte=mte[:, place], weights=weights)
            for place, name in enumerate(names)
        ),
        deviation=np.sqrt(np.maximum(square - mean**2, 0.0)),
        exact_spectrum=spectra[1],
        error_spectrum=spectra[0],
        factors=factors,
    )


def _between_samples(channels: ChannelSpectra, spectra: Spectrum) -> Array:
    """Factors from RMS^R and MTE^R on the coarse grid to those on the record's, which holds the peaks.

    `spectra`: of x_m − x_I and x_I [m], shape (2, p, K).
    Returns shape (2, p).
    """
    coarse, fine = channels.band.history(spectra), channels.band.full_history(spectra)
    least = np.finfo(float).tiny
    error, exact = (np.abs(fine).max(axis=-1) + least) / (np.abs(coarse).max(axis=-1) + least)
    return np.stack([1.0 / exact, error / exact])


def typical_world(posterior: TestPosterior, errors: ErrorsOfTest) -> Experiment:
    """Return a probable world with the median error, on the line from the mode along which errors change.

    Of several displacements, the one with the largest error.
    """
    place = errors.largest
    channels, partition = posterior.circumstances.channels, posterior.circumstances.partition
    draws, values, rms = posterior.draws, posterior.draws.values, errors.displacements[place].rms
    deviations = rms - draws.weights @ rms
    deviation = float(np.sqrt(draws.weights @ deviations**2))
    if not deviation > 0.0:
        return posterior.mode
    slope = (draws.weights * deviations) @ (values - draws.weights @ values) / deviation
    median = errors.displacements[place].estimate(Metric.RMS).value / float(errors.factors[0, place])

    def miss(position: float) -> float:
        rebuilt = rebuild(channels, partition, posterior.experiment(posterior.fit.mode + position * slope))
        errors = relative_errors(*channels.band.history(np.stack([rebuilt.error, rebuilt.exact])))
        return abs(float(errors[0][place]) - median)

    return posterior.experiment(posterior.fit.mode + min(_PLACES, key=miss) * slope)


_PLACES = sorted(np.linspace(-2.0, 2.0, 41).tolist(), key=abs)  # standard deviations of the error


def draw_noise_errors(posterior: TestPosterior, draws: int, seed: int = 0) -> tuple[Array, Array]:
    """RMS^R and MTE^R in the most probable world, with the sensors' noise as it may be, each (draws, p)."""
    channels, partition = posterior.circumstances.channels, posterior.circumstances.partition
    generator, errors = np.random.default_rng(seed), []
    for _ in range(draws):
        experiment = posterior.mode
        experiment.noise = channels.draw_noise(generator)
        rebuilt = rebuild(channels, partition, experiment)
        errors.append(relative_errors(*channels.band.history(np.stack([rebuilt.error, rebuilt.exact]))))
    rms, mte = np.moveaxis(np.array(errors), 1, 0)
    return rms, mte
