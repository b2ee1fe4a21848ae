"""Errors of a test over the draws of its posterior: values, intervals, probability, histories with a band."""

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from reliab.assessment.inference.evidence import Evidence
from reliab.assessment.inference.experiment import Experiment
from reliab.assessment.inference.posterior import TestPosterior
from reliab.assessment.inference.rebuilt import LinearTest
from reliab.assessment.rebuilt_error.error_statistics import relative_errors
from reliab.assessment.rebuilt_error.spread import ErrorDraws
from reliab.core.arrays import Array
from reliab.core.vocabulary import Metric

ACCURACY = 0.004
"""Standard deviation of the relative error of the numbers, with structure and channels exact [-]."""


class TestedStructure(Protocol):
    """How the error of a test follows from a possible world: linear, by a model, or learned from its force.

    Solutions hold x_m − x_I and x_I, shape (2, p, …), and can be added to each other.
    """

    @property
    def places(self) -> Array:
        """Numbers of the record's samples between those of `histories`, shape (n,)."""

    @property
    def evidence(self) -> tuple[Evidence, ...] | None:
        """What a test shows of what is uncertain; None where that are all of its channels."""

    def solve(self, world: Experiment, draw: int | None = None) -> Any:  # noqa: ANN401 - of its own kind
        """Solve for x_m − x_I and x_I; `draw`: number of a draw of what the world does not hold, if any."""

    def histories(self, solution: Any) -> Array:  # noqa: ANN401
        """Both at the samples at which errors are taken [m], shape (2, p, m)."""

    def on_record(self, solution: Any) -> Array:  # noqa: ANN401
        """Both at the samples of the record [m], shape (2, p, n)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ErrorsOfTest:
    """What the posterior of a test says of its error, for each interface displacement."""

    displacements: tuple[ErrorDraws, ...]
    error: Array  # Mean of x_m − x_I [m], shape (p, n)
    exact: Array  # Mean of x_I [m], shape (p, n)
    deviation: Array  # Standard deviation of both [m], shape (p, n)
    factors: Array  # From RMS^R and MTE^R of the histories to those on the record [-], shape (2, p)

    @property
    def largest(self) -> int:
        """Place of the displacement with the largest median RMS^R."""
        medians = [error.estimate(Metric.RMS).value for error in self.displacements]
        return int(np.argmax(medians))


def draw_errors(posterior: TestPosterior, test: TestedStructure | None = None, seed: int = 0) -> ErrorsOfTest:
    """Rebuild the error in every draw of a posterior.

    `test`: with a specimen that is simulated, whose errors are those of the most probable world with an
    interval around them, since single draws may be far off; of a linear structure by default; `seed`: of the
    noise of the sensors.
    """
    channels, partition = posterior.circumstances.channels, posterior.circumstances.partition
    centre = None if test is None else test.solve(posterior.mode)
    test = test or LinearTest(channels=channels, partition=partition)
    weights = posterior.draws.weights
    rms, mte = np.empty((2, weights.size, partition.degrees))
    mean = square = 0.0
    solution_mean: Any = 0.0
    generator = np.random.default_rng(seed)
    for draw, world in enumerate(posterior.experiments()):
        world.noise = channels.draw_noise(generator)
        solution = test.solve(world, draw)
        histories = test.histories(solution)
        factor = 1.0 + ACCURACY * generator.standard_normal()  # of the numbers
        rms[draw], mte[draw] = factor * np.stack(relative_errors(*histories))
        mean += weights[draw] * histories[0]
        square += weights[draw] * histories[0] ** 2
        solution_mean += weights[draw] * solution
    solution = solution_mean if centre is None else centre
    histories, on_record = test.histories(solution), test.on_record(solution)
    middle = mean if centre is None else histories[0]
    deviation = np.sqrt(np.maximum(square - 2.0 * mean * middle + middle**2, 0.0))
    factors = _between_samples(histories, on_record)
    values = factors * np.stack(relative_errors(*histories))
    return ErrorsOfTest(
        displacements=tuple(
            ErrorDraws(
                rms=factors[0, place] * rms[:, place],
                mte=factors[1, place] * mte[:, place],
                weights=weights * weights.size,
                values=None if centre is None else tuple(values[:, place].tolist()),
            )
            for place in range(partition.degrees)
        ),
        error=on_record[0],
        exact=on_record[1],
        deviation=np.stack([np.interp(test.places, np.arange(row.size), row) for row in deviation]),
        factors=factors,
    )


def _between_samples(coarse: Array, fine: Array) -> Array:
    """Factors from RMS^R and MTE^R at some samples to those on the record, which holds the peaks, (2, p).

    `coarse`, `fine`: x_m − x_I and x_I [m], shape (2, p, …).
    """
    least = np.finfo(float).tiny
    error, exact = (np.abs(fine).max(axis=-1) + least) / (np.abs(coarse).max(axis=-1) + least)
    return np.stack([1.0 / exact, error / exact])


def typical_world(posterior: TestPosterior, errors: ErrorsOfTest) -> Experiment:
    """Return a probable world with the median error, on the line from the mode along which errors change.

    Of several displacements, the one with the largest error.
    """
    place = errors.largest
    test = LinearTest(channels=posterior.circumstances.channels, partition=posterior.circumstances.partition)
    draws, values, rms = posterior.draws, posterior.draws.values, errors.displacements[place].rms
    deviations = rms - draws.weights @ rms
    deviation = float(np.sqrt(draws.weights @ deviations**2))
    if not deviation > 0.0:
        return posterior.mode
    slope = (draws.weights * deviations) @ (values - draws.weights @ values) / deviation
    median = errors.displacements[place].estimate(Metric.RMS).value / float(errors.factors[0, place])

    def miss(position: float) -> float:
        solution = test.solve(posterior.experiment(posterior.fit.mode + position * slope))
        return abs(float(relative_errors(*test.histories(solution))[0][place]) - median)

    return posterior.experiment(posterior.fit.mode + min(_PLACES, key=miss) * slope)


_PLACES = sorted(np.linspace(-2.0, 2.0, 41).tolist(), key=abs)  # standard deviations of the error


def draw_noise_errors(
    posterior: TestPosterior, test: TestedStructure, draws: int, seed: int = 0
) -> tuple[Array, Array]:
    """RMS^R and MTE^R in the most probable world, with the sensors' noise as it may be, each (draws, p)."""
    generator, errors = np.random.default_rng(seed), []
    for _ in range(draws):
        world = posterior.mode
        world.noise = posterior.circumstances.channels.draw_noise(generator)
        errors.append(relative_errors(*test.histories(test.solve(world))))
    rms, mte = np.moveaxis(np.array(errors), 1, 0)
    return rms, mte
