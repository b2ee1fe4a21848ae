"""The error of one test, rebuilt from its own commands and measured displacements.

A test obeys M x_c'' + C_n x_c' + K_n x_c = −M ι a_g − γ f, the undisturbed structure the same with the
specimen's true force under its own motion. Their difference e = x_c − x_I obeys the whole structure's own
equation, driven only by the restoring force that was wrong ::

    M e'' + C e' + K e = γ (Z x_c − f),   f = Z x_m,   Z = k_e + c_e s + m_e s²
    one degree of freedom:   e'' + 2ξω₀e' + ω₀²e = αω₀²(x_c − x_m)
    x_m − x_I = e − (x_c − x_m)

Neither the ground motion nor a reference is needed, and the actuator may do anything. The equation holds for
a linear structure with the stated properties (derivation: subtract the two equations of motion).

Use it so ::

    known = PriorKnowledge(tolerances={"frequency": 0.01})
    error = rebuild(command, measured, time_step, structure, known=known)
    error.rms.value, error.rms.low, error.rms.high      RMS^R and its 90 % interval; error.mte likewise
    error.probability(threshold, metric)                P(error < threshold), capped by the draws
    error.error, error.smooth_error, error.reference    x_m − x_I and x_I [m], shape (n,)
    error.low, error.high                               90 % band of x_m − x_I [m], shape (n,)
    error.parts()                                       Parts: gain, delay, first, by_name[...] with share,
                                                        rms, remaining_rms, remaining_mte, history;
                                                        rms_over_time(...)
    error.widenings(metric)                             what widens the interval, widest first
    error.start.offset, error.noise.white               the sensor's offset and noise [m]

What is assumed: the structure is linear with the stated properties (or its specimen has a model), the command
solves its equation of motion, and the fed-back force is that of the piston's true displacement, without the
sensor's noise and offset. An offset that the sensor shows before the test moves is the sensor's and is taken
away; `sensor_offset=0.0` says that the loop felt it. A sensor with a wrong scale, a channel that is shifted
in time, or a force that is fed back late looks exactly like an actuator error: state a tolerance for each,
and the interval includes it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from reliab.assessment.coupled_error import CoupledError, DegreeError, fit_followers
from reliab.assessment.inference.channel_spectra import ChannelSpectra
from reliab.assessment.inference.error_draws import typical_world
from reliab.assessment.inference.experiment import Experiment
from reliab.assessment.inference.posterior import DRAWS
from reliab.assessment.inference.uncertain_quantity import EXACTLY_KNOWN, Circumstances, PriorKnowledge
from reliab.assessment.inferred_error import InferredError, infer_errors
from reliab.assessment.parts import ErrorPart, Parts, divide, part_of_tracking
from reliab.assessment.rebuilt_error.histories import Histories, samples_in_step
from reliab.assessment.rebuilt_error.initial import Start, check_histories, examine_starts
from reliab.assessment.rebuilt_error.noise import SensorNoise, are_moving, estimate_noises
from reliab.assessment.rebuilt_error.readings import require_lag
from reliab.assessment.rebuilt_error.size import require_fitting, samples_in_step_of_structure
from reliab.assessment.rebuilt_error.spread import DisplacementError
from reliab.assessment.rebuilt_error.widenings import Widening
from reliab.core.arrays import Array
from reliab.core.vocabulary import Metric
from reliab.structures.partition import Partition, whole_structure
from reliab.structures.structure import Structure

_RESONANT = 10.0  # error of a command over the tracking error, at most, that a test may begin with
_DRAWS_OF_NOISE = 16  # that show how much of a displacement noise leaves open


@dataclass(frozen=True, kw_only=True, eq=False)
class RebuiltError(DisplacementError):
    """The error of a test with its uncertainty."""

    time_step: float  # Step between samples [s]
    structure: Partition  # The structure with which it was rebuilt
    noise: SensorNoise  # Noise of the displacement sensor
    start: Start  # How the test begins, and the sensor's offset
    histories: Histories  # Histories without noise, of which the parts are made
    inferred: InferredError  # Draws of everything that is uncertain, and what they say of the error

    @property
    def command(self) -> Array:
        """x_c at the interface [m], shape (1, n)."""
        return self.histories.command[np.newaxis]

    def parts(self) -> Parts:
        """Divide the error into amplitude, delay, what is neither, and the fed-back force."""
        return divide(self.histories, self.structure, self.inferred.band)

    def part_of_tracking(self, followed_command: Array) -> ErrorPart:
        """Part of the error that an actuator with this displacement [m] accounts for, shape (n,)."""
        return part_of_tracking(self.histories, self.structure, self.inferred.band, followed_command)

    def widenings(self, metric: Metric = Metric.RMS) -> tuple[Widening, ...]:
        """Which unknowns widen the interval most, the widest first."""
        return self.inferred.widenings(metric)


def _initial_size(command: Array, read: Array, starts: Sequence[Start]) -> float:
    """Size of the error [m] with which a record in motion may begin; `command`, `read` [m], shape (p, n).

    It is as much of the motion as elsewhere in the test, up to a resonance that amplifies the tracking error.
    """
    tracking = float(np.sqrt(np.mean((read - command) ** 2) / np.mean(command**2)))
    amplitude = max(0.0 if start.at_rest else start.amplitude for start in starts)
    return amplitude * min(_RESONANT * tracking, 1.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class Readings:
    """Channels of a test with p actuators, and how they begin."""

    command: Array  # command, read: x_c, and x_m as read without offsets, at the sensors [m], shape (p, n)
    read: Array
    time_step: float  # [s]
    noises: tuple[SensorNoise, ...]
    starts: tuple[Start, ...]
    partition: Partition  # The structure as stated
    channels: ChannelSpectra

    @classmethod
    def from_histories(
        cls,
        command: Array,
        measured_displacement: Array,
        time_step: float,
        partition: Partition,
        *,
        to_interface: Array | None = None,
        ground: Array | None = None,
        force: Array | None = None,
        sensor_offsets: Array | float | None = None,
        resolution: float | None = None,
    ) -> "Readings":
        """Check the channels, and transform them.

        `command`, `measured_displacement` [m], with its stated scale taken away, shape (n,) or (p, n);
        `time_step` [s]; `to_interface`: interface displacements of unit displacements of the actuators [-],
        shape (p, p), the identity by default; `ground` [m/s²]; `force` over the mass [N/kg], shape (n,);
        `sensor_offsets`, NaN where it is not known, and `resolution` of the displacement sensors [m].
        """
        command, read = check_histories(command, measured_displacement, time_step, partition)
        stride = samples_in_step_of_structure(partition, time_step)
        require_fitting(command.shape[1], stride, time_step)
        carry = np.eye(partition.degrees) if to_interface is None else np.asarray(to_interface, dtype=float)
        noises = estimate_noises(command, read, time_step)
        starts = examine_starts(command, read, time_step, partition, noises, carry, sensor_offsets)
        read = read - np.array([[start.offset] for start in starts])
        stood = np.array([start.standing for start in starts])
        initial_displacement = np.linalg.solve(carry, partition.static_transfer @ carry @ stood)
        remaining = stood - initial_displacement  # which the command did not answer before the record
        channels = ChannelSpectra.from_channels(
            command + initial_displacement[:, np.newaxis],
            read - remaining[:, np.newaxis],
            time_step,
            partition,
            ground=ground,
            force=None if force is None else force[np.newaxis],
            interface_matrix=carry,
            resolution=resolution or 0.0,
            offset_size=np.array([start.offset_deviation for start in starts]),
            initial_size=_initial_size(command, read, starts),
            standing=carry @ remaining,
        )
        return cls(
            command=command,
            read=read,
            time_step=time_step,
            noises=noises,
            starts=starts,
            partition=partition,
            channels=channels,
        )

    @property
    def stride(self) -> int:
        """Number of samples of which one is enough."""
        structure_stride = samples_in_step_of_structure(self.partition, self.time_step)
        return samples_in_step(structure_stride, self.noises, self.command.shape[1])

    def rebuilt(self, inferred: InferredError) -> RebuiltError:
        """Put the posterior of a test with one actuator into the form of a rebuilt error."""
        world = typical_world(inferred.posterior, inferred.errors)
        histories = self._histories(world)
        single = replace(
            histories,
            command=histories.command[0],
            measured=histories.measured[0],
            fed_back=histories.fed_back[0],
            standing=-self.starts[0].standing,
            carry=None,
        )
        return self.error_with(single, world.structure(self.partition), inferred)

    def error_with(self, histories: Histories, structure: Partition, inferred: InferredError) -> RebuiltError:
        """Put together what draws say of the error, and the histories and the structure of its parts."""
        return RebuiltError(
            **inferred.histories(0, self.read[0]),
            time_step=self.time_step,
            structure=structure,
            noise=self.noises[0],
            start=self.starts[0],
            histories=histories,
            inferred=inferred,
        )

    def rebuilt_of_several(self, inferred: InferredError) -> CoupledError:
        """Put the posterior of a test with several actuators into the form of a rebuilt error."""
        read, noise = self.channels.to_interface @ self.read, self._noise_left
        displacements = []
        for place, name in enumerate(self.partition.names):
            rebuilt = inferred.histories(place, read[place])
            peak = float(np.abs(rebuilt["reference"]).max())
            share = float(noise[place]) / peak if peak > 0.0 else np.inf
            displacements.append(DegreeError(**rebuilt, name=name, noise=share))
        world = typical_world(inferred.posterior, inferred.errors)
        return CoupledError(
            time_step=self.time_step,
            displacements=tuple(displacements),
            structure=world.structure(self.partition),
            starts=self.starts,
            histories=self._histories(world),
            tracking=fit_followers(
                self.command, np.gradient(self.command, self.time_step, axis=1), self.read
            ),
            inferred=inferred,
        )

    def _histories(self, world: Experiment) -> Histories:
        """Histories of a possible world, from which the parts of the error are made, shape (p, n)."""
        carry, motion = self.channels.to_interface, world.displacement(self.channels)
        spectra = np.stack([motion, world.late(motion, self.channels)])
        standing = np.reshape(self.channels.standing, (-1, 1))
        displacement, late_displacement = self.channels.band.full_history(spectra) + standing
        return Histories(
            command=self.command,
            measured=np.linalg.solve(carry, displacement),
            fed_back=carry @ self.command - late_displacement,
            time_step=self.time_step,
            standing=carry @ np.array([-start.standing for start in self.starts]),
            carry=carry,
        )

    @property
    def _noise_left(self) -> Array:
        """Standard deviation of x_m that the noise leaves open at the interface [m], shape (p,).

        Of an actuator that is not told to move, all that its sensor shows is open.
        """
        channels, carry = self.channels, self.channels.to_interface
        generator = np.random.default_rng(0)
        draws = [
            channels.band.history(carry @ channels.draw_noise(generator)) for _ in range(_DRAWS_OF_NOISE)
        ]
        still = ~are_moving(self.command, self.read)
        mean_squares = np.where(still, np.mean((self.command - self.read) ** 2, axis=1), 0.0)
        open_squares = np.mean(np.square(draws), axis=(0, 2)) + carry**2 @ mean_squares
        return np.asarray(np.sqrt(open_squares))


def rebuild(
    command: Array,
    measured_displacement: Array,
    time_step: float,
    structure: Structure | Partition,
    *,
    feedback_lag: float = 0.0,
    sensor_offset: float | None = None,
    resolution: float | None = None,
    known: PriorKnowledge = EXACTLY_KNOWN,
    draws: int = DRAWS,
    seed: int = 0,
) -> RebuiltError:
    """Rebuild the error of a test of a linear structure from its command and measured displacement.

    `command`, `measured_displacement` [m]; `time_step`, `feedback_lag` [s]; `sensor_offset`, `resolution`
    [m].

    An actuator that moves 1 % too little under a steady sine at resonance:

    >>> time = np.arange(0.0, 60.0, 1.0 / 256.0)
    >>> command = np.minimum(time / 20.0, 1.0) * np.sin(2.0 * np.pi * time)
    >>> error = rebuild(command, 0.99 * command, 1.0 / 256.0, Structure(frequency=1.0, damping_ratio=0.05))
    >>> round(error.rms.value, 3)
    0.06
    """
    partition = whole_structure(structure)
    readings = Readings.from_histories(
        command,
        measured_displacement,
        time_step,
        partition,
        sensor_offsets=sensor_offset,
        resolution=resolution,
    )
    require_lag(feedback_lag, readings.command.size * time_step)
    circumstances = Circumstances(
        **vars(known), partition=partition, channels=readings.channels, feedback_lag=feedback_lag
    )
    return readings.rebuilt(infer_errors(circumstances, readings.stride, seed, draws=draws))


def rebuild_coupled(
    command: Array,
    measured_displacements: Array,
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
    """Rebuild the error of every interface displacement of a test with several actuators.

    `command`, `measured_displacements` [m], shape (p, n); `time_step`, `feedback_lag` [s]; `to_interface`:
    interface displacements of unit displacements of the actuators [-], shape (p, p), the identity by default;
    `sensor_offsets`: of the displacement sensors [m], NaN where they are not known, shape (p,).

    Two actuators of which one moves 1 % too little:

    >>> time = np.arange(0.0, 60.0, 1.0 / 256.0)
    >>> partition = Partition(mass=np.eye(2), damping=0.5 * np.eye(2), stiffness=40.0 * np.eye(2),
    ...                       interface=np.eye(2), specimen_stiffness=40.0 * np.eye(2))
    >>> command = np.minimum(time / 20.0, 1.0) * np.sin(np.sqrt(40.0) * time) * np.ones((2, 1))
    >>> error = rebuild_coupled(command, command * [[0.99], [1.0]], 1.0 / 256.0, partition)
    >>> round(error.displacements[0].rms.value, 2), error.displacements[1].rms.value < 1e-3
    (0.07, True)
    """
    readings = Readings.from_histories(
        command,
        measured_displacements,
        time_step,
        partition,
        to_interface=to_interface,
        sensor_offsets=sensor_offsets,
    )
    require_lag(feedback_lag, readings.command.shape[1] * time_step)
    circumstances = Circumstances(
        **vars(known), partition=partition, channels=readings.channels, feedback_lag=feedback_lag
    )
    return readings.rebuilt_of_several(infer_errors(circumstances, readings.stride, seed, draws=draws))
