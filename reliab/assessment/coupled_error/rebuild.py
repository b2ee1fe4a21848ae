"""The error of a test with several actuators, rebuilt from its commands and measured displacements.

The equation is that of one actuator with vectors in place of numbers (see `rebuild.py`); it
needs neither the ground motion nor a reference. Sensors stand at the actuators: noise, offsets and scales are
drawn there, and a matrix carries them to the interface.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from reliab.assessment.coupled_error.coupled_error import CoupledError, DegreeError
from reliab.assessment.inference.channel_spectra import ChannelSpectra
from reliab.assessment.inference.posterior import DRAWS
from reliab.assessment.inference.uncertain_quantity import EXACTLY_KNOWN, Circumstances, PriorKnowledge
from reliab.assessment.inferred_error import InferredError, infer_errors
from reliab.assessment.rebuilt_error.histories import Histories, samples_in_step
from reliab.assessment.rebuilt_error.initial import Start, check_histories, examine_start
from reliab.assessment.rebuilt_error.noise import SensorNoise, estimate_noise
from reliab.assessment.rebuilt_error.readings import delay_history
from reliab.assessment.rebuilt_error.size import require_fitting
from reliab.core.arrays import Array
from reliab.structures.partition import Partition

_SAMPLES_PER_PERIOD = 16.0  # samples of the fastest mode that takes part; what lies between is corrected
_TAKES_PART = 0.01  # of the answer at rest: a mode with less does not set the step
_NEAR_BAND = 1.5  # times the band of the motion: modes above follow inputs that are linear between samples
_STATIC_MODE_FACTOR = 4.0  # times the band of the motion: modes above follow by statics
_PAST_MODE = 1.05  # times its frequency, that the band holds of a mode that may ring
_HIGHEST = 0.2  # of the rate: above, noise is read, and a mode is seen only where it rises above it
_RIPPLE = 80.0  # dB: deviations of the filter would be those of errors that noise hardly leaves open
_STILL = 1e-12
_NO_NOISE = 1e-9  # of the span of a channel
_DRAWS_OF_NOISE = 16  # that show how much of a displacement noise leaves open


@dataclass(frozen=True, kw_only=True, eq=False)
class CoupledReadings:
    """Channels of a test with several actuators, and how they begin."""

    command: Array  # command, read: x_c and x_m as read without offsets, at the sensors [m], shape (p, n)
    read: Array
    time_step: float  # [s]
    noises: tuple[SensorNoise, ...]
    starts: tuple[Start, ...]
    partition: Partition  # The structure as stated
    to_interface: Array  # Interface displacements of unit displacements of the actuators [-], shape (p, p)
    channels: ChannelSpectra

    @classmethod
    def from_histories(
        cls,
        command: Array,
        displacements: Array,
        time_step: float,
        partition: Partition,
        *,
        to_interface: Array | None = None,
        ground: Array | None = None,
        sensor_offsets: Array | None = None,
    ) -> "CoupledReadings":
        """Check the channels, and transform them; parameters as of `rebuild_coupled`, `ground` [m/s²]."""
        command, displacements = check_histories(
            command, displacements, time_step, partition, has_actuators=True
        )
        carry = np.eye(partition.degrees) if to_interface is None else np.asarray(to_interface, dtype=float)
        noises, starts, read = _examine_channels(
            command, displacements, time_step, partition, carry, sensor_offsets
        )
        stood = np.array([start.standing for start in starts])
        initial_displacement = np.linalg.solve(carry, partition.static_transfer @ carry @ stood)
        remaining = stood - initial_displacement  # which the command did not answer before the record
        channels = ChannelSpectra.from_channels(
            command + initial_displacement[:, np.newaxis],
            read - remaining[:, np.newaxis],
            time_step,
            partition,
            ground=ground,
            interface_matrix=carry,
        )
        channels = replace(
            channels,
            offset_size=np.array([start.offset_deviation for start in starts]),
            standing=carry @ remaining,
            initial_size=0.0 if all(start.at_rest for start in starts) else channels.initial_size,
        )
        readings = cls(
            command=command,
            read=read,
            time_step=time_step,
            noises=noises,
            starts=starts,
            partition=partition,
            to_interface=carry,
            channels=channels,
        )
        require_fitting(command.size, readings.stride, time_step / len(command))
        return readings

    @property
    def _moving_structure(self) -> Partition:
        """The structure with the modes that move; others follow by statics."""
        band, frequencies = self.noises[0].band, self.partition.natural_frequencies
        highest = _STATIC_MODE_FACTOR * max(band, float(frequencies[0]))
        return self.partition.reduce_to_modes(int(np.count_nonzero(frequencies <= highest)))

    @property
    def stride(self) -> int:
        """Number of samples of which one is enough."""
        structure, noise = self._moving_structure, self.noises[0]
        governing = _governing_modes(structure, _NEAR_BAND * noise.band)
        fastest = float(governing.max() if governing.size else structure.natural_frequencies[0])
        structure_stride = max(int(1.0 / (_SAMPLES_PER_PERIOD * fastest * self.time_step)), 1)
        return samples_in_step(structure_stride, noise, self.command.shape[1])

    def rebuilt(self, inferred: InferredError, feedback_lag: float) -> CoupledError:
        """Put the posterior into the form of a rebuilt error; `feedback_lag` [s]."""
        read, noise = self.to_interface @ self.read, self._noise_left
        displacements = []
        for place, name in enumerate(self.partition.names):
            rebuilt = inferred.histories(place, read[place])
            peak = float(np.abs(rebuilt["reference"]).max())
            share = float(noise[place]) / peak if peak > 0.0 else np.inf
            displacements.append(DegreeError(**rebuilt, name=name, noise=share))
        histories = self._smooth(feedback_lag)
        return CoupledError(
            time_step=self.time_step,
            displacements=tuple(displacements),
            structure=self.partition,
            starts=self.starts,
            histories=histories,
            recursion=histories.recursion(self._moving_structure),
            inferred=inferred,
        )

    @property
    def _noise_left(self) -> Array:
        """Standard deviation of x_m that the noise leaves open at the interface [m], shape (p,).

        Of an actuator that is not told to move, all that its sensor shows is open.
        """
        channels, generator = self.channels, np.random.default_rng(0)
        draws = [
            channels.band.history(self.to_interface @ channels.draw_noise(generator))
            for _ in range(_DRAWS_OF_NOISE)
        ]
        still = ~_moves(self.command, self.read)
        mean_squares = np.where(still, np.mean((self.command - self.read) ** 2, axis=1), 0.0)
        open_squares = np.mean(np.square(draws), axis=(0, 2)) + self.to_interface**2 @ mean_squares
        return np.asarray(np.sqrt(open_squares))

    def _smooth(self, feedback_lag: float) -> Histories:
        """Histories without what lies above the band of the motion."""
        rows = zip(self.noises, self.command, self.read, strict=True)
        displacements = np.stack([command - noise.smooth(command - read) for noise, command, read in rows])
        delayed = np.stack([delay_history(row, feedback_lag, self.time_step) for row in displacements])
        return Histories(
            command=self.command,
            measured=displacements,
            fed_back=self.to_interface @ (self.command - delayed),
            time_step=self.time_step,
            standing=self.to_interface @ np.array([-start.standing for start in self.starts]),
            carry=self.to_interface,
            smooth=True,
        )


def rebuild_coupled(
    command: Array,
    displacements: Array,
    time_step: float,
    partition: Partition,
    *,
    to_interface: Array | None = None,
    feedback_lag: float = 0.0,
    known: PriorKnowledge = EXACTLY_KNOWN,
    sensor_offsets: Array | None = None,
    draws: int = DRAWS,
    seed: int = 0,
) -> CoupledError:
    """Rebuild the error of every interface displacement of a test.

    `command`, `displacements` [m], shape (p, n); `time_step`, `feedback_lag` [s]; `to_interface`:
    interface displacements of unit displacements of the actuators [-], shape (p, p), the identity by default;
    `sensor_offsets`: of the displacement sensors [m], NaN where they are not known, shape (p,).

    Two actuators of which one moves 1 % too little:

    >>> time = np.arange(0.0, 60.0, 1.0 / 256.0)
    >>> partition = Partition(mass=np.eye(2), damping=0.5 * np.eye(2), stiffness=40.0 * np.eye(2),
    ...                              interface=np.eye(2), specimen_stiffness=40.0 * np.eye(2))
    >>> command = np.minimum(time / 20.0, 1.0) * np.sin(np.sqrt(40.0) * time) * np.ones((2, 1))
    >>> error = rebuild_coupled(command, command * [[0.99], [1.0]], 1.0 / 256.0, partition)
    >>> round(error.displacements[0].rms.value, 2), error.displacements[1].rms.value < 1e-3
    (0.07, True)
    """
    readings = CoupledReadings.from_histories(
        command,
        displacements,
        time_step,
        partition,
        to_interface=to_interface,
        sensor_offsets=sensor_offsets,
    )
    circumstances = Circumstances(
        **vars(known), partition=partition, channels=readings.channels, feedback_lag=feedback_lag
    )
    inferred = infer_errors(circumstances, readings.stride, seed, draws=draws)
    return readings.rebuilt(inferred, feedback_lag)


def _examine_channels(
    command: Array,
    measured_displacement: Array,
    step: float,
    partition: Partition,
    carry: Array,
    offsets: Array | None,
) -> tuple[tuple[SensorNoise, ...], tuple[Start, ...], Array]:
    """Estimate noise and offset of each sensor, but for stated `offsets` [m].

    Returns also the readings without offsets [m], shape (p, n).
    """
    shares = partition.shares_at_sensors(carry)
    lowest = float(partition.natural_frequencies[0])
    moves = _moves(command, measured_displacement)
    noises, starts, read = [], [], []
    for place, (c, m) in enumerate(zip(command, measured_displacement, strict=True)):
        if not moves[place]:
            noises.append(_noise_at_rest(m, step))
            starts.append(Start(at_rest=True, amplitude=0.0, offset=0.0, offset_deviation=0.0))
        else:
            other_commands = command[moves & (np.arange(len(moves)) != place)]
            noises.append(estimate_noise(c, m, step, other_commands))
            own_share = float(shares[place])
            starts.append(examine_start(c, m, step, lowest, noises[-1].white, noises[-1].slow, own_share))
        if offsets is not None and not np.isnan(offsets[place]):
            starts[-1] = replace(starts[-1], offset=float(offsets[place]), offset_deviation=0.0)
        read.append(m - starts[-1].offset)
    band = _band(noises, measured_displacement, partition)
    noises = [replace(noise, band=band, ripple=_RIPPLE) for noise in noises]
    return tuple(noises), tuple(starts), np.stack(read)


def _band(noises: Sequence[SensorNoise], measured_displacement: Array, partition: Partition) -> float:
    """Band of the motion [Hz], one for all channels, with the modes that may ring below the noise.

    A channel without noise shows any band, and tells only where none has noise.
    """
    least = _NO_NOISE * np.ptp(measured_displacement, axis=1)
    noisy = [noise.band for noise, small in zip(noises, least, strict=True) if noise.white > small]
    modes = _governing_modes(partition, _HIGHEST / noises[0].time_step)
    return float(max(*(noisy or [noise.band for noise in noises]), *(_PAST_MODE * modes)))


def _moves(command: Array, measured_displacement: Array) -> NDArray[np.bool_]:
    """Which actuators are told to move, shape (p,)."""
    return np.asarray(np.ptp(command, axis=1) > _STILL * np.abs(measured_displacement).max(axis=1))


def _noise_at_rest(measured_displacement: Array, step: float) -> SensorNoise:
    """Noise of a sensor whose actuator is not told to move."""
    still = np.zeros(measured_displacement.size)
    still[1] = 1e-9 * max(float(np.ptp(measured_displacement)), np.finfo(float).tiny)
    return estimate_noise(still, measured_displacement - measured_displacement.mean(), step)


def _governing_modes(partition: Partition, highest: float) -> Array:
    """Natural frequencies [Hz] up to the highest of those with a share in the answer at rest."""
    frequency, _, shapes = partition.modes
    share = np.diag(partition.specimen_stiffness) @ (shapes**2) / (2.0 * np.pi * frequency) ** 2
    return np.asarray(frequency[(share > _TAKES_PART * share.sum()) & (frequency <= highest)])
