"""The error of a test from command, measured displacement and recorded force, for any specimen.

With numerical mass m, damping c and stiffness k_N, and the specimen's force f along its path ::

    m x_c'' + c x_c' + k_N x_c + f[x_m] = −m a_g,   m y'' + c y' + k_N y + f[y] = −m a_g
    g = x_c − y:   m g'' + c g' + k_N g + (f[x_m] − f[y]) = 0

Only the difference of the specimen's force along two neighbouring paths is needed, so that what a
representation of f misses on both cancels. Families of elements learn f from the test itself. A specimen that
a spring and a dashpot explain as well as any family is linear, and the error that of a stated linear specimen
whose stiffness and damping are the test's own. A frame is the same with matrices, g = γᵀ(x_c − x_exact) at
its interface.
"""

from dataclasses import dataclass, replace

import numpy as np

from reliab.assessment.inference.experiment import Experiment
from reliab.assessment.inference.uncertain_quantity import Circumstances
from reliab.assessment.inferred_error import InferredError, infer_errors
from reliab.assessment.measured_specimen.force_channel import ForceChannel, columns_of_channel
from reliab.assessment.measured_specimen.learned_test import LearnedTest
from reliab.assessment.measured_specimen.learning import MeasuredPath, learn_specimen
from reliab.assessment.parts import (
    AMPLITUDE,
    DELAY,
    FED_BACK_FORCE,
    NEITHER,
    ErrorPart,
    Parts,
    fit_followers,
    part_of,
    parts_of,
)
from reliab.assessment.rebuilt_error.error_statistics import relative_error
from reliab.assessment.rebuilt_error.histories import Histories
from reliab.assessment.rebuilt_error.noise import SensorNoise, white_floor
from reliab.assessment.rebuilt_error.recursion import Recursion
from reliab.assessment.rebuilt_error.size import require_fitting, samples_in_step_of_simulation
from reliab.assessment.uncertainty_budget import SPECIMEN, BudgetItem
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.threads import one_thread
from reliab.core.vocabulary import Metric
from reliab.structures.partition import Partition

_DRAWS = 64  # of a nonlinear specimen and of everything else that is uncertain, at most
_LEAST_RATE = 256.0  # samples in a second, and in a period, that are simulated
_SAMPLES_PER_PERIOD = 100.0
_FORESEEN = 0.01  # of a displacement, that the specimen's force at the end of a step may move at most
_PERIODS_OF_BLOCK = 2.0
_FEWEST_BLOCKS = 12
_LARGEST_MISFIT = 0.15  # of the force on held-out parts, above which a specimen is not learned
_FILTER_SHARE = 0.27  # of the rate of simulation, up to which a filter passes


@dataclass(frozen=True, kw_only=True)
class FamilyOfSpecimen:
    """How well a family of elements predicts held-out parts of the force, and the error with it."""

    name: str  # Name of the family
    weight: float  # Share of the draws that it gets
    held_out: float  # RMS of what held-out parts of the force leave unexplained, over that of the force [-]
    rms: float  # RMS^R with this family, everything else as stated [-]


@dataclass(frozen=True, kw_only=True, eq=False)
class MeasuredSpecimen:
    """A specimen that was learned from a test's own force."""

    test: LearnedTest  # The test, and what it shows of the specimen
    families: tuple[FamilyOfSpecimen, ...]  # Families of elements that learned the specimen, the best first
    force: Array  # Force that the specimen would have had along the exact response [N], shape (n,)
    fed_back: Array  # Force that it had along the measured displacement [N], shape (n,)
    work: float  # That would have been done on it [J]
    beyond: float  # How far the exact response leaves the range of the measured one, over the range [-]

    @property
    def held_out(self) -> float:
        """What the best family leaves unexplained of held-out parts of the force, RMS over RMS [-]."""
        return self.families[0].held_out

    @property
    def learned(self) -> bool:
        """Whether held-out parts of the force are predicted so well that the specimen counts as learned."""
        return self.held_out <= _LARGEST_MISFIT

    def parts(self, peak: float) -> Parts:
        """Divide the error into amplitude, delay, what is neither, and the fed-back force.

        `peak` of the exact response [m]. Amplitude and delay are the errors that an actuator with these alone
        would have made along the same command, and their effect on each other counts as neither.
        """
        test, error = self.test, self._error
        *_, (differences,) = fit_followers(test.command, test.measured, test.time_step)
        pieces = {
            name: self._error_of_displacement(test.command - differences[name]) for name in (AMPLITUDE, DELAY)
        }
        tracking_error = error
        if test.feedback_lag:
            tracking_error = self._error_of_displacement(test.measured)
            pieces[FED_BACK_FORCE] = error - tracking_error
        pieces[NEITHER] = tracking_error - pieces[AMPLITUDE] - pieces[DELAY]
        return parts_of({name: test.interpolate(piece) for name, piece in pieces.items()}, peak)

    def part_of_tracking(self, followed_command: Array, peak: float) -> ErrorPart:
        """Part of the error that an actuator with this displacement [m] accounts for, shape (n,)."""
        test = self.test
        piece = self._error_of_displacement(np.ascontiguousarray(followed_command[:: test.every]))
        return part_of(test.interpolate(piece), test.interpolate(self._error), peak)

    def budget_item(self, inferred: InferredError, metric: Metric) -> BudgetItem:
        """Find what the interval owes to what the force leaves open of the specimen."""
        as_stated = Experiment.as_stated(actuators=1)
        draws = [self.test.solve(as_stated, draw)[:, 0] for draw in range(_DRAWS)]
        errors = np.array([relative_error(error, exact, metric) for error, exact in draws])
        deviation = self.test.unexplained_force
        return inferred.item_alone("specimen", SPECIMEN, errors, metric, deviation=deviation)

    def _error_of_displacement(self, displacement: Array) -> Array:
        """Error of an actuator that moves like this along the command [m], at the simulated samples."""
        return displacement - self.test.response(self.test.learned[0], displacement, late=False)

    @property
    def _error(self) -> Array:
        """Error of the test [m], at the simulated samples."""
        measured = self.test.measured
        return measured - self.test.response(self.test.learned[0], measured)


def infer_learned(
    histories: Histories,
    force: Array | None,
    noise: SensorNoise,
    channel: ForceChannel,
    circumstances: Circumstances,
    *,
    draws: int,
    seed: int,
) -> tuple[InferredError, MeasuredSpecimen]:
    """Learn the specimen from its force [N], shape (n,), and infer the error of its test.

    `histories`: smoothed by the filter of the sensor's `noise`.
    """
    structure, step, command = circumstances.partition, histories.time_step, histories.command[0]
    with one_thread():
        force = _check_force(force, command)
        stride = _samples_in_step(structure, step)
        require_fitting(command.size, stride, step)
        thin = histories.thin(stride)
        recorded_force = np.ascontiguousarray(noise.smooth(force)[::stride])
        channel_columns = columns_of_channel(recorded_force, thin.measured[0], thin.time_step)
        path = _path(
            histories, force, recorded_force - channel.values @ channel_columns, stride, noise, structure
        )
        test = LearnedTest(
            channels=circumstances.channels,
            recorded_command=command,
            every=stride,
            path=path,
            whole=structure,
            feedback_lag=circumstances.feedback_lag,
            channel=channel,
            added=channel_columns,
            learned=tuple(learn_specimen(path)),
            seed=seed,
        )
        bounded_specimens = tuple(specimen for specimen in test.learned if test.is_bounded(specimen))
        test = replace(test, learned=bounded_specimens or test.learned[:1])
        return _conclude(test, circumstances, draws)


def _samples_in_step(structure: Partition, time_step: float) -> int:
    """Give the number of samples of which one is simulated: the specimen's force is foreseen for a step."""
    lowest = float(structure.natural_frequencies[0])
    stride = samples_in_step_of_simulation(
        lowest, time_step, least_rate=_LEAST_RATE, samples_per_period=_SAMPLES_PER_PERIOD
    )
    while stride > 1:
        recursion = Recursion.from_force(structure.numerical_substructure, stride * time_step)
        displacement = recursion.output @ recursion.late  # by a unit force at the end of the step
        if float((structure.specimen_stiffness @ displacement)[0, 0]) <= _FORESEEN:
            break
        stride -= 1
    return stride


def _path(
    histories: Histories,
    force: Array,
    specimen_force: Array,
    stride: int,
    noise: SensorNoise,
    structure: Partition,
) -> MeasuredPath:
    """Put together what the test shows of the specimen; `force` as recorded, `specimen_force` thinned [N]."""
    thin = histories.thin(stride)
    shares = white_floor(force) / np.var(force) + noise.white**2 / np.var(histories.measured)
    return MeasuredPath(
        displacement=thin.measured[0],
        force=specimen_force,
        time_step=thin.time_step,
        noise=replace(noise, time_step=thin.time_step, band=min(noise.band, _FILTER_SHARE / thin.time_step)),
        block=min(
            _PERIODS_OF_BLOCK / float(structure.natural_frequencies[0]),
            thin.command[0].size * thin.time_step / _FEWEST_BLOCKS,
        ),
        noisy=float(np.sqrt(shares * np.sum(noise.filter**2))),
    )


def _conclude(
    test: LearnedTest, circumstances: Circumstances, draws: int
) -> tuple[InferredError, MeasuredSpecimen]:
    """Draw what is not known, and put the error together."""
    specimens = test.learned
    inferred = infer_errors(
        replace(
            circumstances,
            specimen_force=True,
            tolerances={**circumstances.tolerances, **test.deviations_by_name},
        ),
        test.every,
        test.seed,
        draws=draws if specimens[0].linear else min(draws, _DRAWS),
        test=test,
    )
    responses = [test.response(specimen, test.measured) for specimen in specimens]
    return inferred, MeasuredSpecimen(
        test=test,
        families=tuple(
            FamilyOfSpecimen(
                name=specimen.family,
                weight=float(weight),
                held_out=specimen.held_out,
                rms=relative_error(test.measured - response, response, Metric.RMS),
            )
            for specimen, weight, response in zip(specimens, test.weights, responses, strict=True)
        ),
        force=test.interpolate(test.force_of(specimens[0], responses[0])),
        fed_back=test.interpolate(test.force_of(specimens[0], test.measured)),
        work=test.work_of(specimens[0], test.measured, responses[0]),
        beyond=_range_excess(responses[0], test.measured),
    )


def _check_force(force: Array | None, measured_displacement: Array) -> Array:
    force = np.ascontiguousarray(np.zeros(0) if force is None else force, dtype=np.float64)
    if force.shape != measured_displacement.shape or not np.isfinite(force).all() or not np.ptp(force) > 0.0:
        raise InputError(
            "A measured specimen needs its recorded force, finite, changing and as long as the displacements",
            value=f"shape {force.shape}",
            remedy="Give the force that was fed back in newtons, or state a linear specimen",
        )
    return force


def _range_excess(response: Array, measured_displacement: Array) -> float:
    """How far the response leaves the range of the measured displacement, over that range [-]."""
    excess = max(
        response.max() - measured_displacement.max(), measured_displacement.min() - response.min(), 0.0
    )
    return float(excess / np.ptp(measured_displacement))
