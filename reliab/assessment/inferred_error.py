"""The error of a test, from the posterior of everything that is uncertain about it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from reliab.assessment.budget.sizes import PriorSource
from reliab.assessment.inference.band import AnalysisBand
from reliab.assessment.inference.error_draws import (
    ErrorsOfTest,
    TestedStructure,
    draw_errors,
    draw_noise_errors,
)
from reliab.assessment.inference.experiment import Experiment
from reliab.assessment.inference.posterior import (
    DRAWS,
    TestPosterior,
    experiment_at,
    infer,
    log_evidence_ratio,
)
from reliab.assessment.inference.quantities import UncertainQuantity
from reliab.assessment.inference.rebuilt import LinearTest
from reliab.assessment.inference.uncertain_quantity import Circumstances, Description
from reliab.assessment.rebuilt_error.histories import Histories
from reliab.assessment.rebuilt_error.yielding_sweep import additional_displacement
from reliab.assessment.uncertainty_budget import NOT_INFERRED, BudgetItem, Widening
from reliab.core.arrays import Array
from reliab.core.vocabulary import Metric
from reliab.effects.effect import SteppedEffect
from reliab.structures.partition import Partition

_NARROWING_FACTOR = 0.9  # of a standard deviation a priori, below which the test itself shows a quantity
_HALF = 0.75  # of the variance, which has to go for half the width


@dataclass(frozen=True, kw_only=True, eq=False)
class InferredError:
    """The posterior of a test and what it says of the error."""

    posterior: TestPosterior
    test: TestedStructure
    errors: ErrorsOfTest
    every: int  # Number of samples of which `exact` gives one

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

    def worlds(self, count: int) -> Iterator[tuple[int, Experiment]]:
        """Possible worlds with the numbers of their draws, each as often as it weighs."""
        weights = self.posterior.draws.weights
        draws = np.random.default_rng(0).choice(weights.size, count, p=weights)
        for draw in draws.tolist():
            yield draw, self.posterior.experiment(self.posterior.draws.values[draw])

    def exact(self) -> Iterator[tuple[Partition, Array]]:
        """Structures, and responses without actuator errors at swept samples [m], draw by draw."""
        for draw, world in self.worlds(EXACT_DRAWS):
            exact = self.test.on_record(self.test.solve(world, draw))[1]
            yield world.structure(self.posterior.circumstances.partition), exact[:, :: self.every]

    def histories(self, place: int, read: Array) -> dict[str, Any]:
        """Histories and draws of the error of a displacement that was read so [m], shape (n,)."""
        return {
            "error": read - self.errors.exact[place],
            "smooth_error": self.errors.error[place],
            "reference": self.errors.exact[place],
            "deviation": self.errors.deviation[place],
            "draws": self.errors.displacements[place],
        }

    def exact_as_stated(self) -> Array:
        """Return the response without actuator errors with everything as stated [m], shape (n,)."""
        world = experiment_at(self.posterior.circumstances, (), np.zeros(0))
        return np.asarray(self.test.on_record(self.test.solve(world))[1, 0])

    def log_evidence_ratio(self, specimen: Sequence[SteppedEffect], histories: Histories) -> float:
        """Logarithm of how much likelier the channels are with another specimen than with a linear one.

        `specimen`: an effect for each interface displacement; `histories`: what it was moved by.
        """
        motion = np.ascontiguousarray(histories.carry @ histories.measured)
        lost = [
            -additional_displacement(effect, displacement, histories.time_step)
            for effect, displacement in zip(specimen, motion, strict=True)
        ]
        slip = self.posterior.circumstances.channels.band.spectrum(np.stack(lost))
        return log_evidence_ratio(self.posterior, slip)

    def widenings(self, metric: Metric, place: int = 0) -> tuple[Widening, ...]:
        """Return what widens the interval of a displacement, by shares of the variance of its error."""
        draws = self.errors.displacements[place]
        estimate = draws.estimate(metric)
        width = estimate.high - estimate.low
        values, weights = draws.errors(metric), self.posterior.draws.weights
        deviation = _deviation(values, weights)
        widenings = []
        for unknown, z, spread in self._unknowns():
            share = _explained_share(values, z, weights)
            widenings.append(
                Widening(
                    name=unknown.name,
                    deviation=unknown.prior.deviation * spread,
                    contribution=deviation * float(np.sqrt(share)),
                    width=width,
                    width_without=width * float(np.sqrt(1.0 - share)),
                    deviation_for_half=_deviation_for_half(share, spread, unknown.prior.deviation),
                )
            )
        rms, mte = draw_noise_errors(self.posterior, self.test, _DRAWS_OF_NOISE)
        noisy = (rms if metric is Metric.RMS else mte)[:, place]
        widenings.append(self.widening_alone(_NOISE, noisy, metric, place))
        return tuple(widenings)

    def widening_alone(
        self, name: str, errors: Array, metric: Metric, place: int = 0, deviation: float = 0.0
    ) -> Widening:
        """Contribution of something of which there are errors that hold nothing else, shape (draws,)."""
        draws, own = self.errors.displacements[place], float(np.std(errors))
        estimate = draws.estimate(metric)
        whole = _deviation(draws.errors(metric), self.posterior.draws.weights)
        remainder = max(1.0 - (own / whole) ** 2, 0.0) if whole else 0.0
        width = estimate.high - estimate.low
        return Widening(
            name=name,
            deviation=deviation,
            contribution=own,
            width=width,
            width_without=width * float(np.sqrt(remainder)),
            deviation_for_half=None,
        )

    def _unknowns(self) -> Iterator[tuple[UncertainQuantity, Array, float]]:
        """Quantities, their draws z, and standard deviations over those a priori."""
        draws = self.posterior.draws
        for unknown, z in zip(self.posterior.unknowns, draws.values.T, strict=True):
            yield unknown, z, _deviation(z, draws.weights) / unknown.prior.spread

    def budget(self, widenings: Sequence[Widening]) -> tuple[BudgetItem, ...]:
        """Say in words what widens the interval."""
        descriptions: dict[str, tuple[Description, PriorSource]] = {
            name: (description, PriorSource.LEARNED) for name, description in NOT_INFERRED.items()
        }
        for unknown, _, spread in self._unknowns():
            is_shown = spread < _NARROWING_FACTOR or not unknown.quantity.option
            descriptions[unknown.name] = (
                unknown.described,
                PriorSource.LEARNED if is_shown else unknown.prior.source,
            )
        return tuple(BudgetItem.from_widening(part, *descriptions[part.name]) for part in widenings)


_NOISE, _DRAWS_OF_NOISE = "sensor_noise", 32

EXACT_DRAWS = 64
"""Number of draws of the response that perfect actuators would have given."""


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
    errors = draw_errors(posterior, test)
    test = test or LinearTest(channels=circumstances.channels, partition=circumstances.partition)
    return InferredError(posterior=posterior, test=test, errors=errors, every=stride)
