"""The error of a test with several actuators, rebuilt from its commands and measured displacements.

The equation is that of one actuator with vectors in place of numbers (see `rebuilt_error/rebuild.py`); it
needs neither the ground motion nor a reference. Sensors stand at the actuators: noise, offsets and scales are
drawn there, and a matrix carries them to the interface.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from reliab.arrays import Array
from reliab.assessment.coupled_error.coupled_error import (
    CoupledError,
    CoupledHistories,
    errors_of_displacements,
)
from reliab.assessment.coupled_error.joint_draws import draw_jointly
from reliab.assessment.rebuilt_error.error_statistics import mean_and_deviation, mean_square
from reliab.assessment.rebuilt_error.initial import Start, checked_histories, examine_start
from reliab.assessment.rebuilt_error.interval import (
    ACCURACY,
    FEWEST_SWEPT,
    DrivenDraws,
    Unknown,
    columns_of_sensor,
    draw_unknown,
    factors_of_draws,
    states_at_first_sample,
    structures_of_draws,
)
from reliab.assessment.rebuilt_error.noise import SensorNoise, estimate_noise
from reliab.assessment.rebuilt_error.own_frequency import EntriesOfStructure, learn_frequency
from reliab.assessment.rebuilt_error.recursion import Recursion, respond, stacked
from reliab.assessment.rebuilt_error.size import require_fitting
from reliab.assessment.rebuilt_error.tolerances import Tolerances
from reliab.structures import Partition, is_part

DRAWS = 256
"""Number of draws of the uncertain quantities, a power of two."""

_OF_EXACT = 0.001  # accuracy of an error whose structure is exact
_EXACT_DRAWS = 64  # of the response that perfect actuators would have given
_IN_PERIOD_OF_BAND = 0.25
_PER_PERIOD = 16.0  # samples of the fastest mode that takes part; what lies between is corrected
_TAKES_PART = 0.01  # of the answer at rest: a mode with less does not set the step
_NEAR_BAND = 1.5  # times the band of the motion: modes above follow inputs that are linear between samples
_ABOVE_BAND = 4.0  # times the band of the motion: modes above follow by statics
_PAST_MODE = 1.05  # times its frequency, that the band holds of a mode that may ring
_HIGHEST = 0.2  # of the rate: above, noise is read, and a mode is seen only where it rises above it
_RIPPLE = 80.0  # dB: deviations of the filter would be those of errors that noise hardly leaves open
_STILL = 1e-12
_NO_NOISE = 1e-9  # of the span of a channel


@dataclass(frozen=True, kw_only=True, eq=False)
class Channels:
    """Histories at the sensors, without offsets, and what is known of each."""

    command: Array  # command, measured: x_c and x_m as read [m], shape (p, n)
    measured: Array
    noises: tuple[SensorNoise, ...]
    starts: tuple[Start, ...]

    @property
    def smoothed(self) -> Array:
        """x_m without what lies above the band of the motion [m], shape (p, n)."""
        rows = zip(self.noises, self.command, self.measured, strict=True)
        return np.stack([command - noise.smooth(command - read) for noise, command, read in rows])


def rebuild_coupled(
    command: Array,
    measured: Array,
    time_step: float,
    partition: Partition,
    *,
    to_interface: Array | None = None,
    feedback_lag: float = 0.0,
    tolerances: Tolerances | None = None,
    recursion: Recursion | None = None,
    sensor_offsets: Array | None = None,
    draws: int = DRAWS,
    seed: int = 0,
) -> CoupledError:
    """Rebuild the error of every interface displacement of a test.

    `command`, `measured` [m], shape (p, n); `time_step`, `feedback_lag` [s]; `to_interface`: interface
    displacements of unit displacements of the actuators [-], shape (p, p), the identity by default;
    `recursion`: of the ideal test as the computer steps it at the sampling rate, exact by default;
    `sensor_offsets`: of the displacement sensors [m], NaN where they are not known, shape (p,).

    Two actuators of which one moves 1 % too little:

    >>> time = np.arange(0.0, 60.0, 1.0 / 256.0)
    >>> partition = Partition(mass=np.eye(2), damping=0.5 * np.eye(2), stiffness=40.0 * np.eye(2),
    ...                              interface=np.eye(2), specimen_stiffness=40.0 * np.eye(2))
    >>> command = np.minimum(time / 20.0, 1.0) * np.sin(np.sqrt(40.0) * time) * np.ones((2, 1))
    >>> error = rebuild_coupled(command, command * [[0.99], [1.0]], 1.0 / 256.0, partition)
    >>> round(error.displacements[0].rms.value, 2), error.displacements[1].rms.value < 1e-6
    (0.07, True)
    """
    command, measured = checked_histories(command, measured, time_step, partition, several=True)
    carry = np.eye(partition.degrees) if to_interface is None else np.asarray(to_interface, dtype=float)
    channels = _examined(command, measured, time_step, partition, carry, sensor_offsets)
    band = channels.noises[0].band
    highest = _ABOVE_BAND * max(band, float(partition.natural_frequencies[0]))
    structure = partition.below(highest)
    every = _samples_in_step(structure, band, time_step, command.shape[1])
    differences = _draw(channels, structure, every, draws, seed)
    histories = CoupledHistories(
        command=command,
        measured=channels.smoothed,
        carry=carry,
        feedback_lag=feedback_lag,
        time_step=time_step,
        standing=carry @ np.array([-start.standing for start in channels.starts]),
        recursion=recursion or Recursion.of_displacement(structure, time_step, smooth=True),
    )
    unknown = _what_is_unknown(channels, histories, partition, structure, tolerances or Tolerances())
    sweep = _Sweep(
        histories=histories, partition=partition, structure=structure, highest=highest, every=every, seed=seed
    )
    accuracy = _OF_EXACT if unknown.own_frequency is None else ACCURACY
    swept, drawn = sweep.errors(unknown, differences, accuracy=accuracy)
    as_stated, loose = sweep.as_stated(differences[::2]), _looseness(channels, differences, carry)
    errors = errors_of_displacements(
        histories, channels.measured, partition.names, as_stated, swept, loose, every
    )
    return CoupledError(
        time_step=time_step,
        displacements=errors,
        structure=partition,
        reduced=structure,
        noises=channels.noises,
        starts=channels.starts,
        unknown=unknown,
        drawn=drawn,
        histories=histories,
        every=every,
        exact=partial(sweep.exact, unknown, differences[:_EXACT_DRAWS].copy()),
    )


def _what_is_unknown(
    channels: Channels,
    histories: CoupledHistories,
    partition: Partition,
    structure: Partition,
    tolerances: Tolerances,
) -> Unknown:
    """Collect what is uncertain, with what the test shows of a natural frequency that is not exact."""
    learned = learn_frequency(
        histories.carry @ histories.command,
        histories.fed_back,
        histories.difference,
        histories.time_step,
        structure,
        tolerances.frequency,
        standing=histories.standing,
        smooth=True,
        entries=EntriesOfStructure.of_parts(partition, tolerances.of_parts),
    )
    offset, at_start = _of_starts(channels, structure, histories.carry)
    return Unknown(tolerances=tolerances, offset=offset, error_at_start=at_start, own_frequency=learned)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Sweep:
    """Errors of many draws of what is not known."""

    histories: CoupledHistories
    partition: Partition  # As stated
    structure: Partition  # Without modes above the highest frequency [Hz]
    highest: float
    every: int
    seed: int

    def errors(
        self, unknown: Unknown, differences: Array, *, accuracy: float = 0.0
    ) -> tuple[tuple[Array, Array], dict[str, Array]]:
        """Mean square, peak and largest ideal motion, and mean and deviation over the draws.

        Returns shapes (draws, 3, p) and twice (p, n); and what was drawn by name, each shape (draws,).
        """
        draws = differences.shape[0]
        drawn, moving = draw_unknown(unknown, draws, self.seed)
        carried = self.histories.carry @ differences
        statistics, band = np.empty((draws, 3, carried.shape[1])), np.zeros((2, *carried.shape[1:]))
        for places, structure in self._structures(drawn, draws):
            chosen = {name: values[places] for name, values in drawn.items()}
            driven = self._driven(structure, chosen, moving[places])
            statistics[places], sums = driven.errors(carried[places])
            band += sums
        statistics *= self._between_samples
        computed: Array = 1.0 + accuracy * np.random.default_rng(self.seed).standard_normal((draws, 1))
        statistics[:, 0] *= computed**2
        statistics[:, 1] *= computed
        return (statistics, np.stack(mean_and_deviation(band, draws))), drawn

    def as_stated(self, differences: Array) -> tuple[Array, Array]:
        """Return the same where nothing but noise is open."""
        none = np.zeros(self.partition.degrees)
        exact = Unknown(tolerances=Tolerances(), offset=none, error_at_start=none)
        return self.errors(exact, differences)[0]

    def _structures(
        self, drawn: dict[str, Array], draws: int
    ) -> Iterator[tuple[NDArray[np.int64], Partition]]:
        """Structures of draws, with the places of these draws: together what is left of as many modes."""
        parts = {name: values for name, values in drawn.items() if is_part(name)}
        if not parts:
            yield np.arange(draws), structures_of_draws(self.structure, drawn)
            return
        changed = [
            self.partition.with_parts({name: float(values[draw]) for name, values in parts.items()}).below(
                self.highest
            )
            for draw in range(draws)
        ]
        sizes = np.array([structure.size for structure in changed])
        for size in np.unique(sizes):
            places = np.flatnonzero(sizes == size)
            f, ratio, share = (factor[places] for factor in factors_of_draws(drawn))
            together = stacked([changed[place] for place in places])
            yield places, together.scaled(frequency=f, damping_ratio=ratio, share=share)

    def exact(self, unknown: Unknown, differences: Array) -> Iterator[tuple[Partition, Array]]:
        """Structures and exact responses at the interface [m], draw by draw."""
        draws, carried = differences.shape[0], self.histories.carry @ differences
        drawn, moving = draw_unknown(unknown, draws, self.seed)
        for places, structure in self._structures(drawn, draws):
            chosen = {name: values[places] for name, values in drawn.items()}
            responses = self._driven(structure, chosen, moving[places]).exact(carried[places])
            for row, response in enumerate(responses):
                yield self._whole({name: values[row : row + 1] for name, values in chosen.items()}), response

    def _whole(self, drawn: dict[str, Array]) -> Partition:
        """Give the structure of one draw with all of its modes."""
        parts = {name: float(values[0]) for name, values in drawn.items() if is_part(name)}
        f, ratio, share = (float(factor[0]) for factor in factors_of_draws(drawn))
        changed = self.partition.with_parts(parts)
        whole = changed if changed.size == self.partition.size else self.partition
        return whole.scaled(frequency=f, damping_ratio=ratio, share=share)

    def _driven(self, structure: Partition, drawn: dict[str, Array], moving: Array) -> DrivenDraws:
        """Collect what drives draws of structures of one size."""
        histories, every = self.histories, self.every
        step = every * histories.time_step
        recursion = Recursion.of_displacement(structure, step, smooth=True).of_draws(len(moving))
        command, measured = histories.command[:, ::every], histories.measured[:, ::every]
        displaced = np.array([drawn[f"initial_state_{place + 1}"] for place in range(len(command))]).T
        inputs, shifts = self._at_sensors(command, measured, drawn)
        return DrivenDraws(
            recursion=recursion,
            states=states_at_first_sample(structure, recursion, displaced, moving, histories.standing),
            command=histories.carry @ command,
            inputs=inputs,
            shifts=shifts,
            late=(histories.fed_back - histories.difference)[:, ::every],
            velocity=histories.carry @ np.gradient(measured, step, axis=1),
            lags=drawn["feedback_lag"],
        )

    def _at_sensors(self, command: Array, measured: Array, drawn: dict[str, Array]) -> tuple[Array, Array]:
        """Columns of what is drawn of sensors at the interface, and how much each draw has of them."""
        step = self.every * self.histories.time_step
        inputs, shifts = [], []
        for place, (told, read) in enumerate(zip(command, measured, strict=True)):
            columns, sizes = columns_of_sensor(told, read, step, drawn, f"_{place + 1}")
            inputs.append(self.histories.carry[:, place, np.newaxis] * columns[:, np.newaxis])
            shifts.append(sizes)
        return np.concatenate(inputs), np.concatenate(shifts, axis=1)

    @cached_property
    def _between_samples(self) -> Array:
        """Factors by which the statistics of all samples differ from those of the swept ones."""
        histories = self.histories
        difference, command = histories.difference, histories.carry @ histories.command[:, :: self.every]
        late = (histories.fed_back - difference)[:, :: self.every]
        step = self.every * histories.time_step
        coarse = Recursion.of_displacement(self.structure, step, smooth=True)
        response = histories.respond(coarse, difference[:, :: self.every] + late)
        few = _statistics(response - difference[:, :: self.every], command - response)
        response = histories.response
        every = _statistics(response - difference, histories.carry @ histories.command - response)
        return np.divide(every, few, out=np.ones_like(few), where=few > 0.0)


def _statistics(strayed: Array, ideal: Array) -> Array:
    """Mean square and peak of the errors, and peak of the ideal motion, shape (3, p)."""
    squares = [mean_square(row) for row in np.ascontiguousarray(strayed)]
    return np.stack([np.array(squares), np.abs(strayed).max(axis=1), np.abs(ideal).max(axis=1)])


def _examined(
    command: Array,
    measured: Array,
    step: float,
    partition: Partition,
    carry: Array,
    offsets: Array | None,
) -> Channels:
    """Estimate noise and offset of each sensor, but for stated `offsets` [m]; they are taken away."""
    shares = partition.shares_at_sensors(carry)
    lowest = float(partition.natural_frequencies[0])
    moves = _moves(command, measured)
    noises, starts, read = [], [], []
    for place, (c, m) in enumerate(zip(command, measured, strict=True)):
        if not moves[place]:
            noises.append(_noise_at_rest(m, step))
            starts.append(Start(at_rest=True, amplitude=0.0, offset=0.0, offset_deviation=0.0))
        else:
            others = command[moves & (np.arange(len(moves)) != place)]
            noises.append(estimate_noise(c, m, step, others))
            own = float(shares[place])
            starts.append(examine_start(c, m, step, lowest, noises[-1].white, noises[-1].slow, own))
        if offsets is not None and not np.isnan(offsets[place]):
            starts[-1] = replace(starts[-1], offset=float(offsets[place]), offset_deviation=0.0)
        read.append(m - starts[-1].offset)
    band = _band(noises, measured, partition)
    return Channels(
        command=command,
        measured=np.stack(read),
        noises=tuple(replace(noise, band=band, ripple=_RIPPLE) for noise in noises),
        starts=tuple(starts),
    )


def _band(noises: Sequence[SensorNoise], measured: Array, partition: Partition) -> float:
    """Band of the motion [Hz], one for all channels, with the modes that may ring below the noise.

    A channel without noise shows any band, and tells only where none has noise.
    """
    least = _NO_NOISE * np.ptp(measured, axis=1)
    noisy = [noise.band for noise, small in zip(noises, least, strict=True) if noise.white > small]
    modes = _governing_modes(partition, _HIGHEST / noises[0].time_step)
    return float(max(*(noisy or [noise.band for noise in noises]), *(_PAST_MODE * modes)))


def _moves(command: Array, measured: Array) -> NDArray[np.bool_]:
    """Which actuators are told to move, shape (p,)."""
    return np.asarray(np.ptp(command, axis=1) > _STILL * np.abs(measured).max(axis=1))


def _noise_at_rest(measured: Array, step: float) -> SensorNoise:
    """Noise of a sensor whose actuator is not told to move."""
    still = np.zeros(measured.size)
    still[1] = 1e-9 * max(float(np.ptp(measured)), np.finfo(float).tiny)
    return estimate_noise(still, measured - measured.mean(), step)


def _of_starts(channels: Channels, structure: Partition, carry: Array) -> Array:
    """Deviations of offsets at the sensors and of the errors at the first sample at the interface [m]."""
    offsets = np.array([start.offset_deviation for start in channels.starts])
    if all(start.at_rest for start in channels.starts):
        return np.stack([offsets, np.zeros_like(offsets)])
    recursion = Recursion.of_displacement(structure, channels.noises[0].time_step, smooth=True)
    response = respond(recursion, carry @ (channels.command - channels.measured))
    command = carry @ channels.command
    moved = carry @ np.array([start.amplitude for start in channels.starts])
    spread = np.sqrt(np.mean(response**2, axis=1) / np.maximum(np.mean(command**2, axis=1), 1e-300))
    return np.stack([offsets, spread * np.abs(moved)])


def _draw(channels: Channels, structure: Partition, every: int, draws: int, seed: int) -> Array:
    """Draw histories of x_c − x_m at the sensors that the noise leaves open [m], shape (draws, p, m)."""
    actuators, samples = channels.command.shape
    require_fitting(actuators * samples, every, channels.noises[0].time_step / actuators)
    moves = _moves(channels.command, channels.measured)
    smooth = channels.command - channels.smoothed
    drawn = np.tile(smooth[:, ::every], (draws, 1, 1))
    drawn[:, moves] = draw_jointly(
        channels.command[moves],
        channels.measured[moves],
        [noise for noise, moving in zip(channels.noises, moves, strict=True) if moving],
        float(structure.natural_frequencies[0]),
        every,
        draws,
        seed,
    )
    return drawn


def _looseness(channels: Channels, differences: Array, carry: Array) -> Array:
    """Return the standard deviation of τ that the noise leaves open at the interface [m], shape (p,).

    Of an actuator that is not told to move, all that its sensor shows is open.
    """
    spread = np.einsum("ij,djt->dit", carry, differences - differences.mean(axis=0))
    still = ~_moves(channels.command, channels.measured)
    shown = np.where(still, np.mean((channels.command - channels.measured) ** 2, axis=1), 0.0)
    return np.asarray(np.sqrt(np.mean(spread**2, axis=(0, 2)) + carry**2 @ shown))


def _samples_in_step(structure: Partition, band: float, step: float, samples: int) -> int:
    """Return the number of samples of which one is enough while draws are swept."""
    governing = _governing_modes(structure, _NEAR_BAND * band)
    fastest = float(governing.max()) if governing.size else float(structure.natural_frequencies[0])
    of_structure = max(int(1.0 / (_PER_PERIOD * fastest * step)), 1)
    of_band = max(int(_IN_PERIOD_OF_BAND / (band * step)), 1)
    return min(of_structure, max(of_band, -(-samples // FEWEST_SWEPT)))


def _governing_modes(partition: Partition, highest: float) -> Array:
    """Natural frequencies [Hz] up to the highest of those with a share in the answer at rest."""
    frequency, _, moved = partition.modes
    share = np.diag(partition.specimen_stiffness) @ (moved**2) / (2.0 * np.pi * frequency) ** 2
    return np.asarray(frequency[(share > _TAKES_PART * share.sum()) & (frequency <= highest)])
