"""The error of a test over the draws of its posterior: its sizes, histories with a band, and its budget."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np

from reliab.assessment.budget.sizes import PriorSource
from reliab.assessment.inference.band import AnalysisBand
from reliab.assessment.inference.evidence import Evidence
from reliab.assessment.inference.experiment import Experiment
from reliab.assessment.inference.posterior import (
    DRAWS,
    TestModel,
    TestPosterior,
    infer,
    log_evidence_ratio,
)
from reliab.assessment.inference.rebuilt import LinearTest
from reliab.assessment.inference.uncertain_quantity import Circumstances, Description
from reliab.assessment.rebuilt_error.error_statistics import relative_errors
from reliab.assessment.rebuilt_error.histories import Histories
from reliab.assessment.rebuilt_error.spread import DisplacementError, ErrorDraws
from reliab.assessment.rebuilt_error.yielding_sweep import additional_displacement
from reliab.assessment.uncertainty_budget import SENSOR_NOISE, BudgetItem
from reliab.core.arrays import Array
from reliab.core.vocabulary import Metric
from reliab.effects.effect import SteppedEffect
from reliab.structures.partition import Partition

ACCURACY = 0.004
"""Standard deviation of the relative error of the numbers, with structure and channels exact [-]."""

EXACT_DRAWS = 64
"""Number of draws of the response that perfect actuators would have given."""

_NARROWING_FACTOR = 0.9  # of a standard deviation a priori, below which the test itself shows a quantity
_HALF = 0.75  # of the variance, which has to go for half the width
_DRAWS_OF_NOISE = 32
_PLACES = sorted(np.linspace(-2.0, 2.0, 41).tolist(), key=abs)  # standard deviations of the error


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
class InferredError:
    """The posterior of a test, and what it says of the error of each interface displacement."""

    posterior: TestPosterior
    test: TestedStructure
    draws: tuple[ErrorDraws, ...]
    error: Array  # Mean of x_m − x_I [m], shape (p, n)
    exact: Array  # Mean of x_I [m], shape (p, n)
    deviation: Array  # Standard deviation of both [m], shape (p, n)
    factors: Array  # From RMS^R and MTE^R of the drawn histories to those on the record [-], shape (2, p)
    every: int = 1  # Number of samples of which `exact_draws` gives one

    @property
    def band(self) -> AnalysisBand:
        """Band in which the test is analysed."""
        return self.posterior.circumstances.channels.band

    @property
    def assumed(self) -> bool:
        """Whether sizes of what is uncertain are those of ordinary equipment."""
        return any(unknown.assumed for unknown in self.posterior.unknowns)

    @property
    def sizes(self) -> dict[str, float]:
        """Standard deviations of what is uncertain before the test, relative or in the SI unit, by name."""
        return {unknown.name: unknown.prior.deviation for unknown in self.posterior.unknowns}

    def displacement(self, place: int, read: Array, *, name: str, noise: float) -> DisplacementError:
        """Error of a displacement that was read so [m], shape (n,); `name`, `noise`: as of its class."""
        return DisplacementError(
            error=read - self.exact[place],
            smooth_error=self.error[place],
            reference=self.exact[place],
            deviation=self.deviation[place],
            draws=self.draws[place],
            name=name,
            noise=noise,
        )

    def worlds(self) -> Iterator[tuple[int, Experiment]]:
        """Possible worlds with the numbers of their draws, each as often as it weighs."""
        weights = self.posterior.draws.weights
        draws = np.random.default_rng(0).choice(weights.size, EXACT_DRAWS, p=weights)
        for draw in draws.tolist():
            yield draw, self.posterior.experiment(self.posterior.draws.values[draw])

    def exact_draws(self) -> Iterator[tuple[Partition, Array]]:
        """Structures, and responses without actuator errors at swept samples [m], draw by draw."""
        for draw, world in self.worlds():
            exact = self.test.on_record(self.test.solve(world, draw))[1]
            yield world.structure(self.posterior.circumstances.partition), exact[:, :: self.every]

    def exact_as_stated(self) -> Array:
        """Return the response without actuator errors with everything as stated [m], shape (n,)."""
        as_stated = TestModel(circumstances=self.posterior.circumstances, unknowns=(), evidence=())
        world = as_stated.experiment(np.zeros(0))
        return np.asarray(self.test.on_record(self.test.solve(world))[1, 0])

    def typical_world(self) -> Experiment:
        """Return a probable world with the median error, on the line from the mode along which errors change.

        Of several displacements, the one with the largest error.
        """
        posterior, test = self.posterior, self.test
        medians = [draws.estimate(Metric.RMS).value for draws in self.draws]
        place = int(np.argmax(medians))
        weights, values, rms = posterior.draws.weights, posterior.draws.values, self.draws[place].rms
        deviations = rms - weights @ rms
        deviation = float(np.sqrt(weights @ deviations**2))
        if not deviation > 0.0:
            return posterior.mode
        slope = (weights * deviations) @ (values - weights @ values) / deviation
        median = medians[place] / float(self.factors[0, place])

        def miss(position: float) -> float:
            solution = test.solve(posterior.experiment(posterior.fit.mode + position * slope))
            return abs(float(relative_errors(*test.histories(solution))[0][place]) - median)

        return posterior.experiment(posterior.fit.mode + min(_PLACES, key=miss) * slope)

    def log_evidence_ratio(self, specimen: Sequence[SteppedEffect], histories: Histories) -> float:
        """Logarithm of how much likelier the channels are with another specimen than with a linear one.

        `specimen`: an effect for each interface displacement; `histories`: what it was moved by.
        """
        motion = np.ascontiguousarray(histories.carry @ histories.measured)
        lost = [
            -additional_displacement(effect, displacement, histories.time_step)
            for effect, displacement in zip(specimen, motion, strict=True)
        ]
        return log_evidence_ratio(self.posterior, self.band.spectrum(np.stack(lost)))

    def budget(self, metric: Metric, place: int = 0) -> tuple[BudgetItem, ...]:
        """Say what widens the interval of a displacement, by shares of the variance of its error."""
        values, posterior = self.draws[place].errors(metric), self.posterior
        weights = posterior.draws.weights
        deviation, items = _deviation(values, weights), []
        for unknown, z in zip(posterior.unknowns, posterior.draws.values.T, strict=True):
            share = _explained_share(values, z, weights)
            spread = _deviation(z, weights) / unknown.prior.spread
            is_shown = spread < _NARROWING_FACTOR or not unknown.quantity.option
            items.append(
                BudgetItem.from_description(
                    unknown.described,
                    name=unknown.name,
                    source=PriorSource.LEARNED if is_shown else unknown.prior.source,
                    deviation=unknown.prior.deviation * spread,
                    contribution=deviation * float(np.sqrt(share)),
                    **self._widths(metric, place, share),
                    deviation_for_half=_deviation_for_half(share, spread, unknown.prior.deviation),
                )
            )
        noisy = self._noise_errors()[list(Metric).index(metric), place]
        return *items, self.item_alone("sensor_noise", SENSOR_NOISE, noisy, metric, place)

    def item_alone(
        self,
        name: str,
        description: Description,
        errors: Array,
        metric: Metric,
        place: int = 0,
        *,
        deviation: float = 0.0,
    ) -> BudgetItem:
        """Contribution of something of which there are errors that hold nothing else, shape (draws,)."""
        own = float(np.std(errors))
        whole = _deviation(self.draws[place].errors(metric), self.posterior.draws.weights)
        return BudgetItem.from_description(
            description,
            name=name,
            source=PriorSource.LEARNED,
            deviation=deviation,
            contribution=own,
            **self._widths(metric, place, min((own / whole) ** 2, 1.0) if whole else 1.0),
            deviation_for_half=None,
        )

    def _widths(self, metric: Metric, place: int, share: float) -> dict[str, float]:
        """Widths of the interval, and of that without a share of the variance."""
        estimate = self.draws[place].estimate(metric)
        width = estimate.high - estimate.low
        return {"width": width, "width_without": width * float(np.sqrt(1.0 - share))}

    def _noise_errors(self) -> Array:
        """RMS^R and MTE^R in the most probable world, with the sensors' noise as it may be, (2, p, draws)."""
        generator, errors = np.random.default_rng(0), []
        for _ in range(_DRAWS_OF_NOISE):
            world = self.posterior.mode
            world.noise = self.posterior.circumstances.channels.draw_noise(generator)
            errors.append(relative_errors(*self.test.histories(self.test.solve(world))))
        return np.moveaxis(np.array(errors), 0, -1)


def _deviation(values: Array, weights: Array) -> float:
    return float(np.sqrt(weights @ (values - weights @ values) ** 2))


def _explained_share(values: Array, z: Array, weights: Array) -> float:
    """Share of the variance of values that a quantity explains, by a parabola: errors are never negative."""
    root = np.sqrt(weights)
    basis = root * np.stack([np.ones_like(z), z, z**2])
    residual = root * values - np.linalg.lstsq(basis.T, root * values, rcond=None)[0] @ basis
    variance = _deviation(values, weights) ** 2
    return float(np.clip(1.0 - residual @ residual / variance, 0.0, 1.0)) if variance else 0.0


def _deviation_for_half(share: float, spread: float, deviation: float) -> float | None:
    """Return the standard deviation of a measurement that would halve the interval; None where none does."""
    if share <= _HALF:
        return None
    remainder = 1.0 - _HALF / share  # of the quantity's variance
    return deviation * spread * float(np.sqrt(remainder / (1.0 - remainder)))


def infer_errors(
    circumstances: Circumstances,
    stride: int,
    seed: int,
    *,
    draws: int = DRAWS,
    test: TestedStructure | None = None,
) -> InferredError:
    """Infer the errors of all interface displacements.

    `stride`: number of samples of which exact responses give one; `test`: of a nonlinear specimen, which has
    evidence of its own; linear by default.
    """
    if test is not None:
        channels = replace(circumstances.channels, initial_size=0.0, drift_size=np.zeros(1))
        circumstances = replace(circumstances, channels=channels)
    evidence = None if test is None else test.evidence
    posterior = infer(circumstances, draws=draws, seed=seed, evidence=evidence)
    return replace(draw_errors(posterior, test), every=stride)


def draw_errors(
    posterior: TestPosterior, test: TestedStructure | None = None, seed: int = 0
) -> InferredError:
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
    return InferredError(
        posterior=posterior,
        test=test,
        draws=tuple(
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
