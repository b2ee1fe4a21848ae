"""The data of a block as a problem to be fitted: segments, whitened residuals, noise."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from reliab.discrepancy.blocks.observed import ObservedBlock
from reliab.discrepancy.fitting.space import ModelSpace
from reliab.discrepancy.spectra.noise import NoiseModel, Periodogram, fit_noise
from reliab.discrepancy.spectra.quantisation import converter_step, expected_error
from reliab.discrepancy.spectra.segment import Segment

Array = NDArray[np.float64]

_LEAST_OF_CONVERSION = 0.2  # of the mean square of a converter's error
_UNBOUNDED = 1e6  # a whitened residual that stands for a simulation that ran away


@dataclass(frozen=True, kw_only=True, eq=False)
class Problem:
    """A block with the segments on which models of it are judged.

    Parameters
    ----------
    block : ObservedBlock
        The block.
    segments : tuple of Segment
        Stretches of tests.
    conversion : mapping of int to numpy.ndarray, optional
        By test, what the converter is known to have added to the channel, shape (n,).
    """

    block: ObservedBlock
    segments: tuple[Segment, ...]
    conversion: Mapping[int, Array] = field(default_factory=dict)

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
        """Variance of the noise below which a corrected conversion leaves it never."""
        squares = [self.steps[test] ** 2 for test in self.conversion]
        return _LEAST_OF_CONVERSION * float(np.mean(squares)) / 12.0 if squares else 0.0

    def corrected(self, space: ModelSpace, coordinates: Array) -> "Problem":
        """Return the problem without the converter's error that a model expects, where it has steps."""
        if not any(self.steps.values()):
            return self
        conversion = {}
        for test, predicted in self.predictions(space, coordinates).items():
            values, step = self.block.measured(test), self.steps[test]
            signal = self.block.at_rate(predicted, test)
            if step > 0.0:
                spread = np.sqrt(max(float(np.mean((values - signal) ** 2)) - step**2 / 12.0, 0.0))
                error = expected_error(signal, step, spread, float(values[0]))
                if error is not None:
                    conversion[test] = error
        return (
            Problem(block=self.block, segments=self.segments, conversion=conversion) if conversion else self
        )

    @cached_property
    def sketch(self) -> "Problem":
        """The same problem predicted at fewer instants, for derivatives."""
        block = self.block.sketch
        return self if block is self.block else Problem(block=block, segments=self.segments)

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

    def whitened(self, space: ModelSpace, coordinates: Array, noise: NoiseModel) -> Array:
        """Residuals of unit variance if the model is right, shape (rows,)."""
        predicted = self.predictions(space, coordinates)
        parts = []
        for segment, measured in zip(self.segments, self._spectra, strict=True):
            left = measured - segment.coarse_spectrum(predicted[segment.test], self.block.every)
            parts.append(real_parts(left, segment.density(noise)))
        rows = np.concatenate(parts)
        return rows if np.isfinite(rows).all() else np.full(rows.size, _UNBOUNDED)

    def residuals(self, space: ModelSpace, coordinates: Array) -> dict[int, Array]:
        """Measured minus predicted channel by test."""
        predicted = self.predictions(space, coordinates)
        return {
            test: self.block.measured(test) - self.block.at_rate(values, test)
            for test, values in predicted.items()
        }

    def noise_of(self, space: ModelSpace, coordinates: Array) -> NoiseModel:
        """Fit the noise to what a model leaves."""
        unit = NoiseModel.white(self.block.rate, 1.0)
        return self.noise_left(self.whitened(space, coordinates, unit), unit)

    def noise_left(self, rows: Array, noise: NoiseModel) -> NoiseModel:
        """Fit the noise to residuals that are whitened by another one, shape (rows,)."""
        powers = rows**2 * self._densities(noise)
        periodograms, begin = [], 0
        for segment, beyond in zip(self.segments, self._beyond, strict=True):
            real = powers[begin + 1 : begin + segment.bins]
            imaginary = powers[begin + segment.bins : begin + 2 * segment.bins - 1]
            inside = Periodogram(frequency=segment.frequency[1:], power=0.5 * (real + imaginary))
            periodograms += [inside, beyond]
            begin += 2 * segment.bins - 1
        return fit_noise(periodograms, self.block.rate, least=self.least_noise)

    def _densities(self, noise: NoiseModel) -> Array:
        """Return the expected power of each residual, shape (rows,)."""
        parts = [segment.density(noise) for segment in self.segments]
        return np.concatenate([np.concatenate([one, one[1:]]) for one in parts])

    def reweighting(self, old: NoiseModel, new: NoiseModel) -> Array:
        """Factors that turn residuals whitened by one noise into those whitened by another, shape (rows,)."""
        return np.asarray(np.sqrt(self._densities(old) / self._densities(new)))

    @cached_property
    def _beyond(self) -> list[Periodogram]:
        """Power of the measured channel at frequencies too high for any signal."""
        found = []
        limit = self.block.highest_signal
        for segment in self.segments:
            whole = segment.periodogram(self.measured(segment.test))
            above = whole.frequency > limit
            found.append(Periodogram(frequency=whole.frequency[above], power=whole.power[above]))
        return found

    def log_volume(self, noise: NoiseModel) -> float:
        """Logarithm of the normalisation of the likelihood, up to a constant."""
        logs = [np.log(segment.density(noise)) for segment in self.segments]
        return -sum(float(one[1:].sum()) + 0.5 * float(one[0]) for one in logs)


def real_parts(spectrum: NDArray[np.complex128], density: Array) -> Array:
    """Complex residuals as real ones of unit variance."""
    white = spectrum / np.sqrt(density)
    root = np.sqrt(2.0)
    return np.concatenate([white.real[:1], root * white.real[1:], root * white.imag[1:]])
