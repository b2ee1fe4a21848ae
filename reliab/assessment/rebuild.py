"""The error of one test, rebuilt from its own command and measured displacement.

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

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from reliab.assessment.inference.channel_spectra import ChannelSpectra
from reliab.assessment.inference.error_draws import typical_world
from reliab.assessment.inference.posterior import DRAWS
from reliab.assessment.inference.uncertain_quantity import EXACTLY_KNOWN, Circumstances, PriorKnowledge
from reliab.assessment.inferred_error import InferredError, infer_errors
from reliab.assessment.rebuilt_error.histories import Histories, samples_in_step
from reliab.assessment.rebuilt_error.initial import Start, check_histories, start_of_test
from reliab.assessment.rebuilt_error.noise import SensorNoise, estimate_noise
from reliab.assessment.rebuilt_error.parts import ErrorPart, Parts, divide, part_of_tracking
from reliab.assessment.rebuilt_error.readings import require_lag
from reliab.assessment.rebuilt_error.size import require_fitting, samples_in_step_of_structure
from reliab.assessment.rebuilt_error.spread import DisplacementError
from reliab.assessment.rebuilt_error.widenings import Widening
from reliab.core.arrays import Array
from reliab.core.vocabulary import Metric
from reliab.structures.partition import Partition, whole_structure
from reliab.structures.structure import Structure


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
    def every(self) -> int:
        """Number of samples of which one was drawn."""
        return self.inferred.every

    @property
    def command(self) -> Array:
        """x_c at the interface [m], shape (1, n)."""
        return self.histories.command[np.newaxis]

    def exact(self) -> Iterator[tuple[Partition, Array]]:
        """Structures, and responses without actuator errors [m], shape (1, m), draw by draw."""
        return self.inferred.exact()

    def parts(self) -> Parts:
        """Divide the error into amplitude, delay, what is neither, and the fed-back force."""
        return divide(self.histories, self.structure)

    def part_of_tracking(self, followed_command: Array) -> ErrorPart:
        """Part of the error that an actuator with this displacement [m] accounts for, shape (n,)."""
        return part_of_tracking(self.histories, self.structure, followed_command)

    def widenings(self, metric: Metric = Metric.RMS) -> tuple[Widening, ...]:
        """Which unknowns widen the interval most, the widest first."""
        return self.inferred.widenings(metric)


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
    def from_histories(
        cls,
        command: Array,
        measured_displacement: Array,
        time_step: float,
        structure: Partition,
        *,
        ground: Array | None = None,
        force: Array | None = None,
        sensor_offset: float | None = None,
        resolution: float | None = None,
    ) -> "Readings":
        """Check the channels, and transform them.

        `command`, `measured_displacement` [m], with its stated scale taken away; `time_step` [s]; `ground`
        [m/s²]; `force` over the mass [N/kg]; `sensor_offset`, `resolution` [m].
        """
        command, measured_displacement = check_histories(command, measured_displacement, time_step, structure)
        stride = samples_in_step_of_structure(structure, time_step)
        require_fitting(command.size, stride, time_step)
        noise = estimate_noise(command, measured_displacement, time_step)
        start = start_of_test(command, measured_displacement, time_step, structure, noise, sensor_offset)
        read = measured_displacement - start.offset
        initial_displacement = (
            float(structure.static_transfer[0, 0]) * start.standing
        )  # by the command, before the record
        stood = start.standing - initial_displacement
        channels = ChannelSpectra.from_channels(
            (command + initial_displacement)[np.newaxis],
            (read - stood)[np.newaxis],
            time_step,
            structure,
            ground=ground,
            force=None if force is None else force[np.newaxis],
            resolution=resolution or 0.0,
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
            time_step=time_step,
            noise=noise,
            start=start,
            every_of_structure=stride,
            channels=channels,
        )

    @property
    def stride(self) -> int:
        """Number of samples of which one is enough."""
        return samples_in_step(self.every_of_structure, self.noise, self.command.size)

    def rebuilt(self, inferred: InferredError) -> RebuiltError:
        """Put the posterior of a linear structure into the form of a rebuilt error."""
        world = typical_world(inferred.posterior, inferred.errors)
        motion = world.displacement(self.channels)
        late = world.late(motion, self.channels)
        displacements = self.channels.band.full_history(np.stack([motion, late]))[:, 0]
        displacement, late_displacement = displacements + self.channels.standing
        histories = Histories(
            command=self.command,
            measured=displacement,
            fed_back=self.command - late_displacement,
            time_step=self.time_step,
            standing=-self.start.standing,
        )
        structure = world.structure(inferred.posterior.circumstances.partition)
        return self.error_with(histories, structure, inferred)

    def error_with(self, histories: Histories, structure: Partition, inferred: InferredError) -> RebuiltError:
        """Put together what draws say of the error, and the histories and the structure of its parts."""
        return RebuiltError(
            **inferred.histories(0, self.read),
            time_step=self.time_step,
            structure=structure,
            noise=self.noise,
            start=self.start,
            histories=histories,
            inferred=inferred,
        )


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
        sensor_offset=sensor_offset,
        resolution=resolution,
    )
    require_lag(feedback_lag, readings.command.size * time_step)
    circumstances = Circumstances(
        **vars(known), partition=partition, channels=readings.channels, feedback_lag=feedback_lag
    )
    return readings.rebuilt(infer_errors(circumstances, readings.stride, seed, draws=draws))
