"""Fitting a candidate model to a block by free-run simulation, with everything else refitted."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy import optimize

from reliab.discrepancy.blocks.observed import ObservedBlock
from reliab.discrepancy.noise import NoiseModel, Periodogram, fit_noise
from reliab.discrepancy.quantisation import converter_step, expected_error
from reliab.discrepancy.segment import Segment
from reliab.discrepancy.space import ModelSpace

Array = NDArray[np.float64]

_STEP = 1e-3  # of a prior's standard deviation, for derivatives
_NEGLIGIBLE = 0.02  # nats
_ON = 1e-6  # from a bound, in standard deviations of the prior
_SMALL = 1.0  # nats
_FIRST_DAMPING, _MOST_DAMPING = 1e-3, 1e6
_MOST_STEPS = 12
_MOST_ROUNDS = 10
_SETTLED = 0.5  # nats
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


@dataclass(frozen=True, kw_only=True, eq=False)
class Fit:
    """A model fitted to a problem.

    Attributes
    ----------
    space : ModelSpace
        Which model.
    coordinates : numpy.ndarray
        Most probable coordinates, shape (size,).
    residual : numpy.ndarray
        Whitened residual there, shape (rows,).
    jacobian : numpy.ndarray
        Its derivatives, shape (rows, size).
    noise : NoiseModel
        Noise by which it is whitened.
    log_volume : float
        Normalisation of the likelihood.
    """

    space: ModelSpace
    coordinates: Array
    residual: Array
    jacobian: Array
    noise: NoiseModel
    log_volume: float

    @cached_property
    def free(self) -> NDArray[np.bool_]:
        """Whether a coordinate lies within its bounds and not on one, shape (size,)."""
        lower, upper = self.space.bounds
        return np.asarray((self.coordinates > lower + _ON) & (self.coordinates < upper - _ON))

    @cached_property
    def precision(self) -> Array:
        """Inverse covariance of the coordinates, shape (size, size)."""
        return np.asarray(self.jacobian.T @ self.jacobian + np.eye(self.space.size), dtype=np.float64)

    @cached_property
    def covariance(self) -> Array:
        """Covariance of the coordinates, shape (size, size)."""
        return np.asarray(np.linalg.inv(self.precision), dtype=np.float64)

    @property
    def log_likelihood(self) -> float:
        """Whittle log-likelihood, up to a constant of the problem."""
        return self.log_volume - 0.5 * float(self.residual @ self.residual)

    @property
    def log_evidence(self) -> float:
        """Logarithm of the marginal likelihood, by Laplace's approximation."""
        prior = -0.5 * float(self.coordinates @ self.coordinates)
        return self.log_likelihood + prior - 0.5 * float(np.linalg.slogdet(self.precision)[1])


def fit(problem: Problem, space: ModelSpace, starts: Sequence[Array], noise: NoiseModel) -> Fit:
    """Fit a model from several starts and keep the best.

    Parameters
    ----------
    problem : Problem
        Data.
    space : ModelSpace
        Which model.
    starts : sequence of numpy.ndarray
        Coordinates to start from.
    noise : NoiseModel
        Noise by which residuals are weighted.

    Returns
    -------
    Fit
        The most probable model.
    """
    found = [_fit_from(problem, space, start, noise) for start in starts]
    return max(found, key=lambda one: one.log_likelihood - 0.5 * float(one.coordinates @ one.coordinates))


def refined(problem: Problem, fitted: Fit) -> Fit:
    """Fit noise and model in turn, until the evidence settles."""
    for _ in range(_MOST_ROUNDS):
        again = _improved(problem, reweighted(problem, fitted))
        settled = abs(again.log_evidence - fitted.log_evidence) < _SETTLED
        fitted = again
        if settled:
            break
    return fitted


def transferred(problem: Problem, fitted: Fit) -> Fit:
    """Return a model of the same block at the same place, judged by other data."""
    return replace(fitted, residual=problem.whitened(fitted.space, fitted.coordinates, fitted.noise))


def reweighted(problem: Problem, fitted: Fit) -> Fit:
    """Return the same model judged by the noise that it leaves, without simulating it again."""
    noise = problem.noise_left(fitted.residual, fitted.noise)
    factors = problem.reweighting(fitted.noise, noise)
    return replace(
        fitted,
        residual=factors * fitted.residual,
        jacobian=factors[:, np.newaxis] * fitted.jacobian,
        noise=noise,
        log_volume=problem.log_volume(noise),
    )


def _fit_from(problem: Problem, space: ModelSpace, start: Array, noise: NoiseModel) -> Fit:
    x = np.clip(start, *space.bounds)
    residual = problem.whitened(space, x, noise)
    return _improved(
        problem,
        Fit(
            space=space,
            coordinates=x,
            residual=residual,
            jacobian=jacobian(problem, space, x, noise),
            noise=noise,
            log_volume=problem.log_volume(noise),
        ),
    )


def _improved(problem: Problem, fitted: Fit) -> Fit:
    """Levenberg–Marquardt with bounds and the prior; ends when a step promises less than 0.02.

    It ends, too, after a small step that reached what the quadratic model promised: derivatives have not
    changed, and the next step would be smaller still.
    """
    space, noise = fitted.space, fitted.noise
    lower, upper = space.bounds
    x, residual, derivatives = fitted.coordinates, fitted.residual, fitted.jacobian
    value = _objective(residual, x)
    damping = _FIRST_DAMPING
    for _ in range(_MOST_STEPS):
        curvature = derivatives.T @ derivatives + np.eye(x.size)
        slope = derivatives.T @ residual + x
        accepted = foreseen = False
        while damping < _MOST_DAMPING:
            step = _bounded_step(curvature, slope, lower - x, upper - x, damping)
            moved = np.clip(x + step, lower, upper)
            promise = -slope @ step - 0.5 * step @ curvature @ step
            if promise < _NEGLIGIBLE:
                break
            there = problem.whitened(space, moved, noise)
            gained = value - _objective(there, moved)
            if gained > 0.0:
                x, residual, accepted = moved, there, True
                foreseen = bool(promise < _SMALL and abs(gained - promise) < _NEGLIGIBLE)
                value -= gained
                damping = max(0.1 * damping, 1e-7)
                break
            damping *= 8.0
        if not accepted or foreseen:
            break
        derivatives = jacobian(problem, space, x, noise)
    return replace(fitted, coordinates=x, residual=residual, jacobian=derivatives)


def _bounded_step(curvature: Array, slope: Array, least: Array, most: Array, damping: float) -> Array:
    """Damped Newton step: the minimum of the quadratic model within the bounds."""
    damped = curvature + damping * np.diag(np.diag(curvature))
    step: Array = np.asarray(-np.linalg.solve(damped, slope), dtype=np.float64)
    if ((step >= least) & (step <= most)).all():
        return step
    root = np.linalg.cholesky(damped)
    most = np.maximum(most, least + 1e-12)
    found = optimize.lsq_linear(root.T, -np.linalg.solve(root, slope), bounds=(least, most), method="bvls")
    return np.asarray(found.x)


def _objective(residual: Array, coordinates: Array) -> float:
    return 0.5 * float(residual @ residual + coordinates @ coordinates)


def sharpened(problem: Problem, fitted: Fit) -> Fit:
    """Return a fitted model with derivatives of full predictions, for its standard deviations."""
    exact = _differentiated(problem, fitted.space, fitted.coordinates, fitted.noise)
    return replace(fitted, jacobian=exact)


def jacobian(problem: Problem, space: ModelSpace, coordinates: Array, noise: NoiseModel) -> Array:
    """Differentiate the whitened residual, shape (rows, size), at fewer instants where that is faster."""
    return _differentiated(problem.sketch, space, coordinates, noise)


def _differentiated(problem: Problem, space: ModelSpace, coordinates: Array, noise: NoiseModel) -> Array:
    _, upper = space.bounds
    centre = problem.whitened(space, coordinates, noise)
    columns = np.empty((centre.size, space.size))
    for place in range(space.size):
        step = _STEP if coordinates[place] + _STEP < upper[place] else -_STEP
        moved = coordinates.copy()
        moved[place] += step
        columns[:, place] = (problem.whitened(space, moved, noise) - centre) / step
    return columns
