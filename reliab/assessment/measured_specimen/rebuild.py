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

from reliab.assessment.measured_specimen.force_channel import ForceChannel, columns_of_channel
from reliab.assessment.measured_specimen.learned_test import OF_FORCE, LearnedTest
from reliab.assessment.measured_specimen.learning import late_by, learn_specimen
from reliab.assessment.measured_specimen.path import MeasuredPath
from reliab.assessment.rebuilt_error.difference_draws import draw_differences
from reliab.assessment.rebuilt_error.error_statistics import relative_errors
from reliab.assessment.rebuilt_error.initial import Start, check_histories, start_of_test
from reliab.assessment.rebuilt_error.interval import EXACT, Histories, Unknown, draw_unknown
from reliab.assessment.rebuilt_error.noise import SensorNoise, estimate_noise, white_floor
from reliab.assessment.rebuilt_error.parts import (
    AMPLITUDE,
    DELAY,
    FED_BACK_FORCE,
    NEITHER,
    Part,
    Parts,
    follow,
    part_of,
    parts_of,
)
from reliab.assessment.rebuilt_error.rebuild import RebuiltError, conclude
from reliab.assessment.rebuilt_error.recursion import Recursion
from reliab.assessment.rebuilt_error.size import require_fitting, samples_in_step_of_simulation
from reliab.assessment.rebuilt_error.tolerances import Tolerances
from reliab.assessment.rebuilt_error.widenings import Widening, widening_alone, widenings
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.threads import one_thread
from reliab.core.vocabulary import Metric
from reliab.structures.partition import Partition

DRAWS = 64
"""Number of draws of the specimen and of everything else that is uncertain."""

DRAWS_OF_LINEAR = 256
"""The same where the specimen is linear, as many as of a stated one."""

_AS_STATED = 4  # draws of which one is of noise and specimen alone, behind the value
_LEAST_RATE = 256.0  # samples in a second, and in a period, that are simulated
_PER_PERIOD = 100.0
_FORESEEN = 0.01  # of a displacement, that the specimen's force at the end of a step may move at most
_PERIODS_OF_BLOCK = 2.0
_FEWEST_BLOCKS = 12
_MISSED = 0.15  # of the force on held-out parts, above which a specimen is not learned
_PASSED = 0.27  # of the rate of simulation, up to which a filter passes


@dataclass(frozen=True, kw_only=True)
class FamilyOfSpecimen:
    """How well a family of elements predicts held-out parts of the force, and the error with it."""

    name: str  # Name of the family
    weight: float  # Share of the draws that it gets
    held_out: float  # RMS of what held-out parts of the force leave unexplained, over that of the force [-]
    rms: float  # RMS^R with this family, everything else as stated [-]


@dataclass(frozen=True, kw_only=True, eq=False)
class MeasuredSpecimen:
    """A specimen that was learned from a test's own force, and the test's error with it."""

    test: LearnedTest  # The test, and what it shows of the specimen
    rebuilt: RebuiltError  # The error, its interval and the exact response
    families: tuple[FamilyOfSpecimen, ...]  # Families of elements that learned the specimen, the best first
    force: Array  # Force that the specimen would have had along the exact response [N], shape (n,)
    fed_back: Array  # Force that it had along the measured displacement [N], shape (n,)
    work: float  # That would have been done on it [J]
    late: float  # Time by which the force seems to follow the displacement late, beyond what is stated [s]
    beyond: float  # How far the exact response leaves the range of the measured one, over the range [-]

    @property
    def held_out(self) -> float:
        """What the best family leaves unexplained of held-out parts of the force, RMS over RMS [-]."""
        return self.families[0].held_out

    @property
    def learned(self) -> bool:
        """Whether held-out parts of the force are predicted so well that the specimen counts as learned."""
        return self.held_out <= _MISSED

    def parts(self) -> Parts:
        """Divide the error into amplitude, delay, what is neither, and the fed-back force.

        Amplitude and delay are the errors that an actuator with these alone would have made along the same
        command, and their effect on each other counts as neither.
        """
        thin, whole = self.test.thin, self._whole
        gain, delay, differences = follow(thin.command, thin.measured, thin.time_step)
        pieces = {name: self._strayed(thin.command - differences[name]) for name in (AMPLITUDE, DELAY)}
        of_tracking = whole
        if self.test.feedback_lag:
            of_tracking = self._strayed(thin.measured)
            pieces[FED_BACK_FORCE] = whole - of_tracking
        pieces[NEITHER] = of_tracking - pieces[AMPLITUDE] - pieces[DELAY]
        return parts_of(
            gain, delay, {name: self._at_samples(piece) for name, piece in pieces.items()}, self._peak
        )

    def part_of_tracking(self, followed: Array) -> Part:
        """Part of the error that an actuator with this displacement [m] accounts for, shape (n,)."""
        piece = self._strayed(np.ascontiguousarray(followed[:: self.rebuilt.every]))
        return part_of(self._at_samples(piece), self._at_samples(self._whole), self._peak)

    def widenings(self, metric: Metric = Metric.RMS) -> tuple[Widening, ...]:
        """Which unknowns widen the interval most, the widest first."""
        rebuilt, seed = self.rebuilt, self.rebuilt.seed
        draws = rebuilt.draws.rms.size
        stated, _ = draw_unknown(rebuilt.unknown, draws, seed)
        of_force = self.test.drawn_of_force(draws, seed)
        del of_force["specimen"]  # whose families and coefficients are drawn, too
        deviations = rebuilt.unknown.deviations() | self.test.deviations_of_force
        few, places = _few(rebuilt.differences, draws), np.arange(rebuilt.reference.size) / rebuilt.every
        of_noise = self.test.spread(few, EXACT, places, seed, varied=False)
        quiet = np.broadcast_to(rebuilt.differences.mean(axis=0), few.shape)
        of_specimen = self.test.spread(quiet, EXACT, places, seed, carried=("specimen",))
        parts = widenings(rebuilt.draws, stated | of_force, deviations, of_noise, metric)
        specimen = widening_alone("specimen", rebuilt.draws, of_specimen, metric, self.test.missed)
        return tuple(sorted((*parts, specimen), key=lambda part: -part.contribution))

    def _strayed(self, moved: Array) -> Array:
        """Error of an actuator that moves like this along the command [m], at the simulated samples."""
        return moved - self.test.response(self.test.learned[0], moved, late=False)

    @property
    def _whole(self) -> Array:
        """Error of the test [m], at the simulated samples."""
        measured = self.test.thin.measured
        return measured - self.test.response(self.test.learned[0], measured)

    @property
    def _peak(self) -> float:
        return float(np.abs(self.rebuilt.reference).max())

    def _at_samples(self, values: Array) -> Array:
        places = np.arange(self.rebuilt.reference.size) / self.rebuilt.every
        return np.interp(places, np.arange(values.size), values)


def rebuild_with_force(
    command: Array,
    measured: Array,
    force: Array,
    time_step: float,
    whole: Partition,
    *,
    mass_deviation: float = 0.0,
    feedback_lag: float = 0.0,
    force_channel: ForceChannel | None = None,
    sensor_offset: float | None = None,
    resolution: float | None = None,
    tolerances: Tolerances | None = None,
    seed: int = 0,
) -> MeasuredSpecimen:
    """Compute the error of a test whose specimen is known by its recorded force only.

    `command`, `measured` [m] and `force` [N], shape (n,); `time_step`, `feedback_lag` [s]; `sensor_offset`,
    `resolution` [m]; `mass_deviation` of the mass, over the mass [-]. `whole` [kg, N·s/m, N/m] without its
    specimen is the computer's part. `force_channel` says what the recorded force holds beside that of the
    specimen, all of which was fed back.
    """
    with one_thread():
        command, measured = check_histories(command, measured, time_step, whole)
        force = _checked_force(force, measured)
        every = _samples_in_step(whole, time_step)
        require_fitting(command.size, every, time_step)
        noise = replace(estimate_noise(command, measured, time_step), resolution=resolution)
        start = start_of_test(command, measured, time_step, whole, noise, sensor_offset)
        read = measured - start.offset
        smooth = noise.smooth(command - read)
        histories = Histories(
            command=command, measured=command - smooth, fed_back=smooth, time_step=time_step
        )
        thin = histories.thin(every)
        channel = force_channel or ForceChannel()
        recorded = np.ascontiguousarray(noise.smooth(force)[::every])
        added = columns_of_channel(recorded, thin.measured, thin.time_step)
        path = _path(histories, force, recorded - channel.values @ added, every, noise, whole)
        test = LearnedTest(
            thin=thin,
            path=path,
            whole=whole,
            mass_deviation=mass_deviation,
            feedback_lag=feedback_lag,
            channel=channel,
            added=added,
            learned=tuple(learn_specimen(path)),
        )
        bounded = tuple(specimen for specimen in test.learned if test.bounded(specimen))
        test = replace(test, learned=bounded or test.learned[:1])
        return _concluded(test, histories, read, every, noise, start, tolerances or Tolerances(), seed)


def _samples_in_step(whole: Partition, time_step: float) -> int:
    """Give the number of samples of which one is simulated: the specimen's force is foreseen for a step."""
    lowest = float(whole.natural_frequencies[0])
    every = samples_in_step_of_simulation(
        lowest, time_step, least_rate=_LEAST_RATE, samples_per_period=_PER_PERIOD
    )
    while every > 1:
        recursion = Recursion.from_force(whole.numerical_substructure, every * time_step)
        moved = recursion.output @ recursion.late  # by a unit force at the end of the step
        if float((whole.specimen_stiffness @ moved)[0, 0]) <= _FORESEEN:
            break
        every -= 1
    return every


def _path(
    histories: Histories,
    force: Array,
    of_specimen: Array,
    every: int,
    noise: SensorNoise,
    whole: Partition,
) -> MeasuredPath:
    """Put together what the test shows of the specimen; `force` as recorded, `of_specimen` thinned [N]."""
    thin = histories.thin(every)
    shares = white_floor(force) / np.var(force) + noise.white**2 / np.var(histories.measured)
    return MeasuredPath(
        displacement=thin.measured,
        force=of_specimen,
        time_step=thin.time_step,
        noise=replace(noise, time_step=thin.time_step, band=min(noise.band, _PASSED / thin.time_step)),
        block=min(
            _PERIODS_OF_BLOCK / float(whole.natural_frequencies[0]),
            thin.command.size * thin.time_step / _FEWEST_BLOCKS,
        ),
        noisy=float(np.sqrt(shares * np.sum(noise.filter**2))),
    )


def _concluded(
    test: LearnedTest,
    histories: Histories,
    read: Array,
    every: int,
    noise: SensorNoise,
    start: Start,
    tolerances: Tolerances,
    seed: int,
) -> MeasuredSpecimen:
    """Draw what is not known, and put the error together; `read` [m]."""
    command, thin, learned = histories.command, test.thin, test.learned
    unknown = Unknown(tolerances=tolerances, offset=start.offset_deviation, error_at_start=0.0)
    draws = DRAWS_OF_LINEAR if learned[0].linear else DRAWS
    lowest = float(test.whole.natural_frequencies[0])
    differences = draw_differences(command, read, noise, lowest, every, draws, seed)
    responses = [test.response(specimen, thin.measured) for specimen in learned]
    reference = responses[0]
    places, known = np.arange(command.size) / every, np.arange(thin.command.size)
    few = _few(differences, draws)
    return MeasuredSpecimen(
        test=test,
        rebuilt=conclude(
            histories,
            read,
            command - np.interp(places, known, thin.command - reference),
            structure=test.whole,
            noise=noise,
            nominal_spread=test.spread(few, EXACT, places, seed),
            spread=test.spread(differences, unknown, places, seed, carried=OF_FORCE),
            differences=differences,
            stride=every,
            unknown=unknown,
            start=start,
            seed=seed,
        ),
        families=tuple(
            FamilyOfSpecimen(
                name=specimen.family,
                weight=float(weight),
                held_out=specimen.held_out,
                rms=relative_errors(thin.measured - response, response)[0],
            )
            for specimen, weight, response in zip(learned, test.weights, responses, strict=True)
        ),
        force=np.interp(places, known, test.force_of(learned[0], reference)),
        fed_back=np.interp(places, known, test.force_of(learned[0], thin.measured)),
        work=test.work_of(learned[0], thin.measured, reference),
        late=late_by(test.path, learned[0], test.added[0]),
        beyond=_beyond(reference, thin.measured),
    )


def _few(differences: Array, draws: int) -> Array:
    """Give some histories of x_c − x_m, without slow noise."""
    return differences[: 2 * draws // _AS_STATED : 2]


def _checked_force(force: Array, measured: Array) -> Array:
    force = np.ascontiguousarray(force, dtype=np.float64)
    if force.shape != measured.shape or not np.isfinite(force).all() or not np.ptp(force) > 0.0:
        raise InputError(
            "A measured specimen needs its recorded force, finite, changing and as long as the displacements",
            value=f"shape {force.shape}",
            remedy="Give the force that was fed back in newtons, or state a linear specimen",
        )
    return force


def _beyond(response: Array, measured: Array) -> float:
    """How far the response leaves the range of the measured displacement, over that range [-]."""
    outside = max(response.max() - measured.max(), measured.min() - response.min(), 0.0)
    return float(outside / np.ptp(measured))
