"""The error of a test with one actuator, from the posterior of everything that is uncertain about it."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from reliab.assessment.budget.sizes import Equipment, Source
from reliab.assessment.inference.channel_spectra import ChannelSpectra
from reliab.assessment.inference.error_draws import (
    ErrorsOfTest,
    draw_errors,
    draw_noise_errors,
    typical_world,
)
from reliab.assessment.inference.posterior import (
    TestPosterior,
    experiment_at,
    infer,
    log_evidence_ratio,
)
from reliab.assessment.inference.quantities import Unknown as UncertainQuantity
from reliab.assessment.inference.rebuilt import rebuild
from reliab.assessment.inference.uncertain_quantity import Circumstances, Description
from reliab.assessment.rebuilt_error.initial import Start, check_histories, start_of_test
from reliab.assessment.rebuilt_error.interval import EXACT, Histories, samples_in_step
from reliab.assessment.rebuilt_error.noise import SensorNoise, estimate_noise
from reliab.assessment.rebuilt_error.readings import require_lag
from reliab.assessment.rebuilt_error.rebuild import RebuiltError
from reliab.assessment.rebuilt_error.size import require_fitting, samples_in_step_of_structure
from reliab.assessment.rebuilt_error.spread import Spread
from reliab.assessment.rebuilt_error.widenings import Widening
from reliab.assessment.rebuilt_error.yielding_sweep import additional_displacement
from reliab.assessment.uncertainty_budget import BudgetItem, describe
from reliab.core.arrays import Array
from reliab.core.stated_value import StatedValue
from reliab.core.vocabulary import MILLI, Metric
from reliab.effects.effect import SteppedEffect
from reliab.recordings.recording import Recording
from reliab.structures.partition import Partition

_NARROWED = 0.9  # of a standard deviation a priori, below which the test itself shows a quantity
_HALF = 0.75  # of the variance, which has to go for half the width


@dataclass(frozen=True, kw_only=True, eq=False)
class InferredError:
    """The posterior of a test and what it says of the error."""

    posterior: TestPosterior
    errors: ErrorsOfTest
    every: int  # Number of samples of which `exact` gives one

    def exact(self) -> Iterator[tuple[Partition, Array]]:
        """Structures, and responses without actuator errors at swept samples [m], draw by draw."""
        channels, partition = self.posterior.circumstances.channels, self.posterior.circumstances.partition
        weights = self.posterior.draws.weights
        chosen = np.random.default_rng(0).choice(weights.size, _EXACT_DRAWS, p=weights)
        for row in chosen:
            world = self.posterior.experiment(self.posterior.draws.values[row])
            exact = channels.band.full_history(rebuild(channels, partition, world).exact)
            yield world.structure(partition), exact[:, :: self.every]

    def spread(self, place: int, error: Array) -> Spread:
        """Put the draws of a displacement into the form of others; `error`: its mean [m], shape (n,)."""
        band, of_test = self.posterior.circumstances.channels.band, self.errors.displacements[place]
        places = np.arange(error.size) * band.record_step
        return Spread(
            rms=of_test.rms,
            mte=of_test.mte,
            mean=error,
            deviation=np.interp(places, band.time, self.errors.deviation[place]),
            counts=of_test.weights * of_test.weights.size,
        )

    def exact_as_stated(self) -> Array:
        """Return the response without actuator errors with everything as stated [m], shape (n,)."""
        circumstances = self.posterior.circumstances
        world = experiment_at(circumstances, (), np.zeros(0))
        exact = rebuild(circumstances.channels, circumstances.partition, world).exact
        return np.asarray(circumstances.channels.band.full_history(exact)[0])

    def log_evidence_ratio(self, specimen: SteppedEffect, histories: Histories) -> float:
        """Logarithm of how much likelier the channels are with another specimen than with a linear one.

        `histories`: of the displacement that it was moved by.
        """
        lost = -additional_displacement(specimen, histories.measured, histories.time_step)
        slip = self.posterior.circumstances.channels.band.spectrum(lost)
        return log_evidence_ratio(self.posterior, slip[np.newaxis])

    def widenings(self, metric: Metric, place: int = 0) -> tuple[Widening, ...]:
        """Return what widens the interval of a displacement, by shares of the variance of its error."""
        draws = self.errors.displacements[place]
        estimate = draws.estimate(metric)
        width = estimate.high - estimate.low
        values = draws.errors(metric)
        deviation = _deviation(values, draws.weights)
        found = []
        for unknown, z, spread in self._unknowns():
            share = _explained(values, z, draws.weights)
            found.append(
                Widening(
                    name=unknown.name,
                    deviation=unknown.prior.deviation * spread,
                    contribution=deviation * float(np.sqrt(share)),
                    width=width,
                    width_without=width * float(np.sqrt(1.0 - share)),
                    deviation_for_half=_for_half(share, spread, unknown.prior.deviation),
                )
            )
        found.append(self._of_noise(metric, place, deviation, width))
        return tuple(sorted(found, key=lambda part: -part.contribution))

    def _of_noise(self, metric: Metric, place: int, deviation: float, width: float) -> Widening:
        """Contribution of the sensors' noise."""
        rms, mte = draw_noise_errors(self.posterior, _DRAWS_OF_NOISE)
        alone = float(np.std((rms if metric is Metric.RMS else mte)[:, place]))
        left = max(1.0 - (alone / deviation) ** 2, 0.0) if deviation else 0.0
        return Widening(
            name=_NOISE,
            deviation=0.0,
            contribution=alone,
            width=width,
            width_without=width * float(np.sqrt(left)),
            deviation_for_half=None,
        )

    def _unknowns(self) -> Iterator[tuple[UncertainQuantity, Array, float]]:
        """Quantities, their draws z, and standard deviations over those a priori."""
        draws = self.posterior.draws
        for unknown, z in zip(self.posterior.unknowns, draws.values.T, strict=True):
            yield unknown, z, _deviation(z, draws.weights)

    def budget(self, widenings: Sequence[Widening]) -> tuple[BudgetItem, ...]:
        """Say in words what widens the interval."""
        said: dict[str, tuple[Description, Source]] = {_NOISE: (describe(_NOISE), Source.LEARNED)}
        for unknown, _, spread in self._unknowns():
            shown = spread < _NARROWED or not unknown.quantity.option
            said[unknown.name] = unknown.described, Source.LEARNED if shown else unknown.prior.source
        return tuple(BudgetItem.of_widening(part, *said[part.name]) for part in widenings)


_NOISE, _DRAWS_OF_NOISE = "sensor_noise", 32
_EXACT_DRAWS = 64


def _deviation(values: Array, weights: Array) -> float:
    return float(np.sqrt(weights @ (values - weights @ values) ** 2))


def _explained(values: Array, z: Array, weights: Array) -> float:
    """Share of the variance of values that a quantity explains, by a parabola: errors are never negative."""
    root = np.sqrt(weights)
    basis = root * np.stack([np.ones_like(z), z, z**2])
    left = root * values - np.linalg.lstsq(basis.T, root * values, rcond=None)[0] @ basis
    variance = _deviation(values, weights) ** 2
    return float(np.clip(1.0 - left @ left / variance, 0.0, 1.0)) if variance else 0.0


def _for_half(share: float, spread: float, deviation: float) -> float | None:
    """Return the standard deviation of a measurement that would halve the interval; None where none does."""
    if share <= _HALF:
        return None
    left = 1.0 - _HALF / share  # of the quantity's variance
    return deviation * spread * float(np.sqrt(left / (1.0 - left)))


def infer_error(
    recording: Recording,
    measured: Array,
    whole: Partition,
    *,
    stated: Mapping[str, StatedValue],
    equipment: Equipment,
    tolerances: Mapping[str, float],
    left_by_faults: Mapping[str, float],
    sensor_offset: float | None,
    resolution: float | None,
    seed: int,
) -> tuple[InferredError, RebuiltError]:
    """Infer the error of a test with one actuator.

    `measured` [m]: with its stated scale taken away; ground acceleration and force of the recording are
    evidence. `tolerances`: relative standard deviations that the file of a frame states, by names of
    quantities and parts [-]; `left_by_faults`: what faults of the channels leave unknown, by names of
    quantities [SI units]; `sensor_offset`, `resolution` [m].
    """
    lag = stated.get("feedback_lag", StatedValue(0.0)).value / MILLI
    require_lag(lag, recording.duration)
    readings = _Readings.of_test(recording, measured, whole, stated, sensor_offset, resolution)
    circumstances = Circumstances(
        partition=whole,
        channels=readings.channels,
        stated=stated,
        equipment=equipment,
        tolerances=tolerances,
        specimen_force=readings.channels.force is not None,
        feedback_lag=lag,
        left_by_faults=left_by_faults,
    )
    inferred = infer_errors(circumstances, readings.every, seed)
    return inferred, readings.rebuilt(inferred, seed)


def infer_errors(circumstances: Circumstances, every: int, seed: int) -> InferredError:
    """Infer the errors of all interface displacements.

    `every`: number of samples of which exact responses give one.
    """
    posterior = infer(circumstances, seed=seed)
    errors = draw_errors(posterior, circumstances.partition.names)
    return InferredError(posterior=posterior, errors=errors, every=every)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Readings:
    """Channels of a test, and how they begin."""

    command: Array  # [m], shape (n,)
    read: Array  # Measured displacement without the offset that rest shows [m], shape (n,)
    time_step: float  # [s]
    noise: SensorNoise
    start: Start
    every_of_structure: int  # Samples of which one resolves the structure's modes
    channels: ChannelSpectra

    @classmethod
    def of_test(
        cls,
        recording: Recording,
        measured: Array,
        whole: Partition,
        stated: Mapping[str, StatedValue],
        sensor_offset: float | None,
        resolution: float | None,
    ) -> "_Readings":
        """Check the channels, and transform them; arguments as of `infer_error`."""
        step, force = recording.time_step, recording.force
        command, measured = check_histories(recording.command, measured, step, whole)
        every = samples_in_step_of_structure(whole, step)
        require_fitting(command.size, every, step)
        noise = replace(estimate_noise(command, measured, step), resolution=resolution)
        start = start_of_test(command, measured, step, whole, noise, sensor_offset)
        read = measured - start.offset
        answered = float(whole.static_transfer[0, 0]) * start.standing  # by the command, before the record
        stood = start.standing - answered
        channels = ChannelSpectra.from_channels(
            (command + answered)[np.newaxis],
            (read - stood)[np.newaxis],
            step,
            whole,
            ground=recording.ground,
            force=None if force is None or "mass" not in stated else force[np.newaxis] / stated["mass"].value,
        )
        channels = replace(
            channels,
            offset_size=np.array([start.offset_deviation]),
            standing=np.array([stood]),
            initial_size=0.0 if start.at_rest else channels.initial_size,
        )
        return cls(
            command=command,
            read=read,
            time_step=step,
            noise=noise,
            start=start,
            every_of_structure=every,
            channels=channels,
        )

    @property
    def every(self) -> int:
        """Number of samples of which one is enough."""
        return samples_in_step(self.every_of_structure, self.noise, self.command.size)

    def rebuilt(self, inferred: InferredError, seed: int) -> RebuiltError:
        """Put the posterior into the form of a rebuilt error, on the samples of the record."""
        posterior, errors, every = inferred.posterior, inferred.errors, self.every
        band, of_test = self.channels.band, errors.displacements[0]
        world = typical_world(posterior, errors)
        moved = world.displacement(self.channels)
        spectra = [errors.exact_spectrum, errors.error_spectrum, moved, world.late(moved, self.channels)]
        reference, error, displaced, late = band.full_history(np.stack(spectra))[:, 0]
        displaced, late = displaced + self.channels.standing, late + self.channels.standing
        return RebuiltError(
            error=self.read - reference,
            smooth_error=error,
            reference=reference,
            rms=of_test.estimate(Metric.RMS),
            mte=of_test.estimate(Metric.MTE),
            draws=inferred.spread(0, error),
            time_step=self.time_step,
            structure=world.structure(posterior.circumstances.partition),
            noise=self.noise,
            start=self.start,
            unknown=EXACT,
            histories=Histories(
                command=self.command,
                measured=displaced,
                fed_back=self.command - late,
                time_step=self.time_step,
                standing=-self.start.standing,
            ),
            differences=(self.command - displaced)[np.newaxis, ::every],
            every=every,
            seed=seed,
        )
