"""The error of a test, from the posterior of everything that is uncertain about it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from reliab.assessment.budget.sizes import PriorSource
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
from reliab.assessment.inference.quantities import UncertainQuantity
from reliab.assessment.inference.rebuilt import rebuild
from reliab.assessment.inference.uncertain_quantity import Circumstances, Description
from reliab.assessment.rebuilt_error.initial import Start, check_histories, start_of_test
from reliab.assessment.rebuilt_error.interval import EXACT, Histories, samples_in_step
from reliab.assessment.rebuilt_error.noise import SensorNoise, estimate_noise
from reliab.assessment.rebuilt_error.rebuild import RebuiltError
from reliab.assessment.rebuilt_error.size import require_fitting, samples_in_step_of_structure
from reliab.assessment.rebuilt_error.spread import Spread
from reliab.assessment.rebuilt_error.widenings import Widening
from reliab.assessment.rebuilt_error.yielding_sweep import additional_displacement
from reliab.assessment.uncertainty_budget import BudgetItem, describe
from reliab.core.arrays import Array
from reliab.core.vocabulary import Metric
from reliab.effects.effect import SteppedEffect
from reliab.recordings.recording import Recording
from reliab.structures.partition import Partition

_NARROWING_FACTOR = 0.9  # of a standard deviation a priori, below which the test itself shows a quantity
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
        draw_places = np.random.default_rng(0).choice(weights.size, _EXACT_DRAWS, p=weights)
        for row in draw_places:
            world = self.posterior.experiment(self.posterior.draws.values[row])
            exact = channels.band.full_history(rebuild(channels, partition, world).exact)
            yield world.structure(partition), exact[:, :: self.every]

    def spread(self, place: int, error: Array) -> Spread:
        """Put the draws of a displacement into the form of others; `error`: its mean [m], shape (n,)."""
        band, displacement_errors = (
            self.posterior.circumstances.channels.band,
            self.errors.displacements[place],
        )
        places = np.arange(error.size) * band.record_step
        return Spread(
            rms=displacement_errors.rms,
            mte=displacement_errors.mte,
            mean=error,
            deviation=np.interp(places, band.time, self.errors.deviation[place]),
            counts=displacement_errors.weights * displacement_errors.weights.size,
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
        widenings = []
        for unknown, z, spread in self._unknowns():
            share = _explained_share(values, z, draws.weights)
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
        widenings.append(self._noise_widening(metric, place, deviation, width))
        return tuple(sorted(widenings, key=lambda part: -part.contribution))

    def _noise_widening(self, metric: Metric, place: int, deviation: float, width: float) -> Widening:
        """Contribution of the sensors' noise."""
        rms, mte = draw_noise_errors(self.posterior, _DRAWS_OF_NOISE)
        noise_deviation = float(np.std((rms if metric is Metric.RMS else mte)[:, place]))
        remainder = max(1.0 - (noise_deviation / deviation) ** 2, 0.0) if deviation else 0.0
        return Widening(
            name=_NOISE,
            deviation=0.0,
            contribution=noise_deviation,
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
            _NOISE: (describe(_NOISE), PriorSource.LEARNED)
        }
        for unknown, _, spread in self._unknowns():
            is_shown = spread < _NARROWING_FACTOR or not unknown.quantity.option
            descriptions[unknown.name] = (
                unknown.described,
                PriorSource.LEARNED if is_shown else unknown.prior.source,
            )
        return tuple(BudgetItem.from_widening(part, *descriptions[part.name]) for part in widenings)


_NOISE, _DRAWS_OF_NOISE = "sensor_noise", 32
_EXACT_DRAWS = 64


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


def infer_errors(circumstances: Circumstances, stride: int, seed: int) -> InferredError:
    """Infer the errors of all interface displacements.

    `stride`: number of samples of which exact responses give one.
    """
    posterior = infer(circumstances, seed=seed)
    errors = draw_errors(posterior, circumstances.partition.names)
    return InferredError(posterior=posterior, errors=errors, every=stride)


@dataclass(frozen=True, kw_only=True, eq=False)
class Readings:
    """Channels of a test, and how they begin."""

    command: Array  # [m], shape (n,)
    read: Array  # Measured displacement without the offset that rest shows [m], shape (n,)
    time_step: float  # [s]
    noise: SensorNoise
    start: Start
    every_of_structure: int  # Samples of which one resolves the structure's modes
    channels: ChannelSpectra

    @classmethod
    def from_recording(
        cls,
        recording: Recording,
        measured_displacement: Array,
        structure: Partition,
        *,
        mass: float | None,
        sensor_offset: float | None,
        resolution: float | None,
    ) -> "Readings":
        """Check the channels, and transform them.

        `measured_displacement` [m]: with its stated scale taken away; `mass` [kg] of the structure, without
        which a recorded force is left out; `sensor_offset`, `resolution` [m].
        """
        step, force = recording.time_step, recording.force
        command, measured_displacement = check_histories(
            recording.command, measured_displacement, step, structure
        )
        stride = samples_in_step_of_structure(structure, step)
        require_fitting(command.size, stride, step)
        noise = replace(estimate_noise(command, measured_displacement, step), resolution=resolution)
        start = start_of_test(command, measured_displacement, step, structure, noise, sensor_offset)
        read = measured_displacement - start.offset
        initial_displacement = (
            float(structure.static_transfer[0, 0]) * start.standing
        )  # by the command, before the record
        stood = start.standing - initial_displacement
        channels = ChannelSpectra.from_channels(
            (command + initial_displacement)[np.newaxis],
            (read - stood)[np.newaxis],
            step,
            structure,
            ground=recording.ground,
            force=None if force is None or mass is None else force[np.newaxis] / mass,
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
            every_of_structure=stride,
            channels=channels,
        )

    @property
    def stride(self) -> int:
        """Number of samples of which one is enough."""
        return samples_in_step(self.every_of_structure, self.noise, self.command.size)

    def rebuilt(self, inferred_error: InferredError, seed: int) -> RebuiltError:
        """Put the posterior into the form of a rebuilt error, on the samples of the record."""
        posterior, errors, stride = inferred_error.posterior, inferred_error.errors, self.stride
        band, displacement_errors = self.channels.band, errors.displacements[0]
        world = typical_world(posterior, errors)
        motion = world.displacement(self.channels)
        spectra = [errors.exact_spectrum, errors.error_spectrum, motion, world.late(motion, self.channels)]
        reference, error, displacement, late = band.full_history(np.stack(spectra))[:, 0]
        displacement, late = displacement + self.channels.standing, late + self.channels.standing
        return RebuiltError(
            error=self.read - reference,
            smooth_error=error,
            reference=reference,
            rms=displacement_errors.estimate(Metric.RMS),
            mte=displacement_errors.estimate(Metric.MTE),
            draws=inferred_error.spread(0, error),
            time_step=self.time_step,
            structure=world.structure(posterior.circumstances.partition),
            noise=self.noise,
            start=self.start,
            unknown=EXACT,
            histories=Histories(
                command=self.command,
                measured=displacement,
                fed_back=self.command - late,
                time_step=self.time_step,
                standing=-self.start.standing,
            ),
            differences=(self.command - displacement)[np.newaxis, ::stride],
            every=stride,
            seed=seed,
        )
