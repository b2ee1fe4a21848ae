"""The data of a block as a problem to be fitted: segments, whitened residuals, noise."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.discrepancy.blocks.observed import ObservedBlock
from reliab.discrepancy.fitting.space import ModelSpace
from reliab.discrepancy.segment import Segment, split_by_segment
from reliab.signals.noise import NoiseModel, Periodogram, converter_step, expect_rounding_error, fit_noise

_LEAST_OF_CONVERSION = 0.2  # of the mean square of a converter's error
_LEAST_POWER = 0.05  # of the strongest test's
_LARGEST = 1e20  # whitened residual from which a simulation ran away
_RUNAWAY = 1e6  # the one that stands for it
_CACHED_NOISES = 4
MOST_OF_A_TEST = 24.0
"""Largest number of observations in one test: later swings repeat the earlier ones."""

_FEWEST = 4.0


class PlacedModel(Protocol):
    """A model at given coordinates, as a fit is."""

    @property
    def space(self) -> ModelSpace:
        """Which model."""

    @property
    def coordinates(self) -> Array:
        """Its coordinates, shape (size,)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Problem:
    """A block with the segments on which models of it are judged."""

    block: ObservedBlock  # The block
    segments: tuple[Segment, ...]  # Stretches of tests
    # By test, what the converter is known to have added to the channel, shape (n,)
    conversion: Mapping[int, Array] = field(default_factory=dict)
    # For each segment the power to which its likelihood is raised, below 1 where what models leave is an
    # error of theirs and no noise: neighbouring frequencies are then no independent observations. The error
    # is then judged over all frequencies alike, in the channel's own unit. Empty where noise judges
    tempering: tuple[float, ...] = ()
    # For each segment the mean square of the channel that counts as one, so that tests count alike
    powers: tuple[float, ...] = ()

    def measured(self, test: int) -> Array:
        """Measured channel of a test without what is known of its conversion, shape (n,)."""
        values = self.block.measured(test)
        return values - self.conversion[test] if test in self.conversion else values

    @cached_property
    def steps(self) -> dict[int, float]:
        """Steps of the converter by test, zero where there are none to be seen."""
        return {test: converter_step(self.block.measured(test)) for test in {s.test for s in self.segments}}

    @property
    def least_noise(self) -> float:
        """Smallest variance of the noise after a converter's known error was taken off."""
        squares = [self.steps[test] ** 2 for test in self.conversion]
        return _LEAST_OF_CONVERSION * float(np.mean(squares)) / 12.0 if squares else 0.0

    def correct_conversion(self, space: ModelSpace, coordinates: Array) -> "Problem":
        """Return the problem without the converter's error that a model expects, where it has steps."""
        if not any(self.steps.values()):
            return self
        conversion = {}
        for test, prediction in self.predictions(space, coordinates).items():
            values, step = self.block.measured(test), self.steps[test]
            signal = self.block.interpolate(prediction, test)
            if step > 0.0:
                spread = np.sqrt(max(float(np.mean((values - signal) ** 2)) - step**2 / 12.0, 0.0))
                error = expect_rounding_error(signal, step, spread, float(values[0]))
                if error is not None:
                    conversion[test] = error
        return replace(self, conversion=conversion) if conversion else self

    @property
    def flat(self) -> bool:
        """Whether the error is judged in the channel's own unit instead of by the noise."""
        return bool(self.tempering)

    def temper(self, observations: Mapping[int, float]) -> "Problem":
        """Return the problem judged in the channel's own unit, with so many observations in each test."""
        rows: dict[int, int] = {}
        for segment in self.segments:
            rows[segment.test] = rows.get(segment.test, 0) + 2 * segment.bins - 1
        return replace(
            self,
            tempering=tuple(min(observations[s.test] / rows[s.test], 1.0) for s in self.segments),
            powers=relative_powers(self),
        )

    @cached_property
    def sketch(self) -> "Problem":
        """The same problem predicted at fewer instants, for derivatives."""
        block = self.block.sketch
        return self if block is self.block else replace(self, block=block, conversion={})

    @cached_property
    def _spectra(self) -> list[NDArray[np.complex128]]:
        return [segment.spectrum(self.measured(segment.test)) for segment in self.segments]

    @property
    def rows(self) -> int:
        """Number of whitened residuals."""
        return sum(2 * segment.bins - 1 for segment in self.segments)

    @cached_property
    def owners(self) -> NDArray[np.int64]:
        """Index of the segment of each whitened residual, shape (rows,)."""
        return np.repeat(np.arange(len(self.segments)), [2 * s.bins - 1 for s in self.segments])

    def predictions(self, space: ModelSpace, coordinates: Array) -> dict[int, Array]:
        """Predicted channel by test."""
        model = space.model(coordinates)
        return {test: self.block.predict(model, test) for test in {s.test for s in self.segments}}

    def whiten(self, space: ModelSpace, coordinates: Array, noise: NoiseModel) -> Array:
        """Residuals of unit variance if the model is right, shape (rows,)."""
        predictions = self.block.spectra(space.model(coordinates), self.segments)
        triples = zip(self._spectra, predictions, self._roots(tuple(noise.weights.tolist())), strict=True)
        parts = [real_parts(spectrum_read - spectrum, root) for spectrum_read, spectrum, root in triples]
        rows = np.concatenate(parts)
        return rows if np.abs(rows).max() < _LARGEST else np.full(rows.size, _RUNAWAY)

    def residuals(self, fitted_model: PlacedModel) -> dict[int, Array]:
        """Measured minus predicted channel by test."""
        predictions = self.predictions(fitted_model.space, fitted_model.coordinates)
        return {
            test: self.block.measured(test) - self.block.interpolate(values, test)
            for test, values in predictions.items()
        }

    def loudness(self, noise: NoiseModel) -> float:
        """Energy of the whitened channel, its mean left out: what a model of nothing would leave."""
        rows = (
            real_parts(spectrum, root)[1:]
            for spectrum, root in zip(self._spectra, self._roots(tuple(noise.weights.tolist())), strict=True)
        )
        return sum(float(row @ row) for row in rows)

    def noise_of(self, space: ModelSpace, coordinates: Array) -> NoiseModel:
        """Fit the noise to what a model leaves."""
        unit = NoiseModel.white(self.block.rate, 1.0)
        return self.noise_left(self.whiten(space, coordinates, unit), unit)

    def noise_left(self, rows: Array, noise: NoiseModel) -> NoiseModel:
        """Fit the noise to residuals that are whitened by another one, shape (rows,)."""
        powers = rows**2 * self.densities(noise)
        if self.flat:
            share = np.array(self.tempering)[self.owners]
            level = float(share @ (powers / np.array(self.powers)[self.owners]) / share.sum())
            return NoiseModel.white(self.block.rate, max(level, self.least_noise, 1e-300))
        periodograms = []
        for (segment, power), high_band in zip(
            split_by_segment(self.segments, powers), self._high_band, strict=True
        ):
            mean = 0.5 * (power[1 : segment.bins] + power[segment.bins :])
            periodograms += [Periodogram(frequency=segment.frequency[1:], power=mean), high_band]
        return fit_noise(periodograms, self.block.rate, least=self.least_noise)

    def _density(self, place: int, noise: NoiseModel) -> Array:
        """Variance by which the residuals of a segment are divided, shape (bins,)."""
        density = self.segments[place].density(noise)
        return density * (self.powers[place] / self.tempering[place]) if self.flat else density

    @cached_property
    def _roots(self) -> Callable[[tuple[float, ...]], list[Array]]:
        """Standard deviations by which the residuals of each segment are divided, by the noise's weights."""

        def roots(weights: tuple[float, ...]) -> list[Array]:
            noise = NoiseModel(rate=self.block.rate, weights=np.array(weights))
            return [np.sqrt(self._density(place, noise)) for place in range(len(self.segments))]

        return lru_cache(maxsize=_CACHED_NOISES)(roots)

    def densities(self, noise: NoiseModel) -> Array:
        """Return the expected power of each residual, shape (rows,)."""
        parts = [self._density(place, noise) for place in range(len(self.segments))]
        return np.concatenate([np.concatenate([density, density[1:]]) for density in parts])

    def reweighting(self, old: NoiseModel, new: NoiseModel) -> Array:
        """Factors that turn residuals whitened by one noise into those whitened by another, shape (rows,)."""
        return np.asarray(np.sqrt(self.densities(old) / self.densities(new)))

    @cached_property
    def _high_band(self) -> list[Periodogram]:
        """Power of the measured channel at frequencies too high for any signal."""
        limit = self.block.highest_signal
        return [s.periodogram_above(self.measured(s.test), limit) for s in self.segments]

    def log_volume(self, noise: NoiseModel) -> float:
        """Logarithm of the normalisation of the likelihood, up to a constant."""
        logs = [np.log(segment.density(noise)) for segment in self.segments]
        shares = self.tempering or (1.0,) * len(logs)
        volumes = [float(log[1:].sum()) + 0.5 * float(log[0]) for log in logs]
        return -sum(share * volume for share, volume in zip(shares, volumes, strict=True))


def relative_powers(problem: Problem) -> tuple[float, ...]:
    """Mean square of the channel in the test of each segment, plus a share of the strongest's.

    Errors count relative to this, so that tests count alike, whatever their length and strength, but for
    those so weak that they show little beside their noise.
    """
    parts: dict[int, list[Array]] = {}
    for s in problem.segments:
        parts.setdefault(s.test, []).append(problem.measured(s.test)[s.begin : s.end])
    power = {test: float(np.mean(np.concatenate(values) ** 2)) for test, values in parts.items()}
    least = _LEAST_POWER * max(power.values())
    return tuple(max(power[s.test] + least, 1e-300) for s in problem.segments)


def real_parts(spectrum: NDArray[np.complex128], deviations: Array) -> Array:
    """Complex residuals as real ones of unit variance."""
    white = spectrum / deviations
    root = np.sqrt(2.0)
    return np.concatenate([white.real[:1], root * white.real[1:], root * white.imag[1:]])


def observations(problem: Problem) -> dict[int, float]:
    """Count the swings of the motion, up to a number in each test.

    What a model misses is much the same along a swing and differs between swings of different size and
    speed; samples, or frequencies, are no independent observations of it.
    """
    counts = {}
    for test in {segment.test for segment in problem.segments}:
        motion = problem.block.motions[test]
        displacement, velocity = motion.values[0] - motion.values[0].mean(), motion.values[1]
        turn = float(np.sqrt(np.mean(velocity**2) / max(float(np.mean(displacement**2)), 1e-300)))
        share = sum(s.end - s.begin for s in problem.segments if s.test == test) / problem.block.rate
        counts[test] = min(max(turn / np.pi * share, _FEWEST), MOST_OF_A_TEST)
    return counts
