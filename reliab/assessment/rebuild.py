"""The error of one test, rebuilt from its own commands and measured displacements.

Finished tests and running ones, with a specimen that is linear, modelled or learned, go this one way.

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
    error.division.parts()                              Parts: first, by_name[...] with share, rms,
                                                        remaining_rms, remaining_mte, history;
                                                        rms_over_time(...)
    error.budget(metric)                                what makes the interval, the largest first
    error.readings.starts, .noises                      the sensors' offsets and noise [m]

    displacement, *others = error.displacements         one for each actuator
    displacement.error, .smooth_error, .reference       x_m − x_I and x_I [m], shape (n,)
    displacement.low, displacement.high                 90 % band of x_m − x_I [m], shape (n,)

What is assumed: the structure is linear with the stated properties (or its specimen has a model), the command
solves its equation of motion, and the fed-back force is that of the piston's true displacement, without the
sensor's noise and offset. An offset that the sensor shows before the test moves is the sensor's and is taken
away; `sensor_offset=0.0` says that the loop felt it. A sensor with a wrong scale, a channel that is shifted
in time, or a force that is fed back late looks exactly like an actuator error: state a tolerance for each,
and the interval includes it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from reliab.assessment.inference.channel_spectra import ChannelSpectra
from reliab.assessment.inference.experiment import Experiment
from reliab.assessment.inference.posterior import DRAWS
from reliab.assessment.inference.uncertain_quantity import EXACTLY_KNOWN, Circumstances, PriorKnowledge
from reliab.assessment.inferred_error import InferredError, infer_errors
from reliab.assessment.parts import DividedError, ErrorPart, Parts, divide, fit_followers, part_of_tracking
from reliab.assessment.rebuilt_error.histories import Histories, samples_in_step
from reliab.assessment.rebuilt_error.initial import Start, check_histories, examine_starts
from reliab.assessment.rebuilt_error.noise import SensorNoise, are_moving, estimate_noises
from reliab.assessment.rebuilt_error.readings import require_lag
from reliab.assessment.rebuilt_error.size import require_fitting, samples_in_step_of_structure
from reliab.assessment.rebuilt_error.spread import UNKNOWN, DisplacementError, ErrorDraws, Estimate
from reliab.assessment.recorded_ground import ShownGround, examine_ground
from reliab.assessment.uncertainty_budget import BudgetItem
from reliab.core.arrays import Array
from reliab.core.vocabulary import Metric
from reliab.structures.partition import Partition, whole_structure
from reliab.structures.structure import Structure

if TYPE_CHECKING:
    from reliab.assessment.measured_specimen.force_channel import ForceChannel
    from reliab.assessment.measured_specimen.rebuild import MeasuredSpecimen
    from reliab.simulation.hybrid_test.model_file import UpdatedModel

_RESONANT = 10.0  # error of a command over the tracking error, at most, that a test may begin with
_DRAWS_OF_NOISE = 16  # that show how much of a displacement noise leaves open


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
        shape (p, p), the identity by default; `ground` [m/s²]; `force` at the actuators [N], of one mass over
        the mass [N/kg], shape (n,) or (p, n); `sensor_offsets`, NaN where it is not known, and `resolution`
        of the displacement sensors [m].
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
            force=None if force is None else np.atleast_2d(force),
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

    @cached_property
    def tracking(self) -> tuple[Array, Array]:
        """Gains [-] and delays [s] of each actuator for the commands of all, by least squares, (p, p)."""
        return fit_followers(self.command, self.read, self.time_step)[:2]

    @property
    def smoothed(self) -> Histories:
        """Histories of one actuator, whose measured displacement is smoothed."""
        difference = self.noises[0].smooth(self.command[0] - self.read[0])[np.newaxis]
        return Histories(
            command=self.command,
            measured=self.command - difference,
            fed_back=difference,
            time_step=self.time_step,
            standing=np.zeros(1),
            carry=self.channels.to_interface,
        )

    def rebuilt(self, inferred: InferredError) -> "RebuiltError":
        """Put the posterior of a test into the form of a rebuilt error."""
        world = inferred.typical_world()
        return self.error_with(self._histories(world), world.structure(self.partition), inferred)

    def error_with(
        self, histories: Histories, structure: Partition, inferred: InferredError
    ) -> "RebuiltError":
        """Put together what draws say of the error, and the histories and the structure of its parts."""
        read = self.channels.to_interface @ self.read
        noise = self._noise_left(np.abs(inferred.exact).max(axis=1))
        return RebuiltError(
            readings=self,
            structure=structure,
            histories=histories,
            displacements=tuple(
                inferred.displacement(place, read[place], name=name, noise=float(noise[place]))
                for place, name in enumerate(self.partition.names)
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

    def _noise_left(self, peaks: Array) -> Array:
        """Return what noise leaves open of x_m at the interface, one standard deviation over peaks [m], (p,).

        Of an actuator that is not told to move, all that its sensor shows is open; infinite where nothing
        moves. An only displacement is judged whatever its noise.
        """
        if peaks.size == 1:
            return np.zeros(1)
        channels, carry = self.channels, self.channels.to_interface
        generator = np.random.default_rng(0)
        draws = [
            channels.band.history(carry @ channels.draw_noise(generator)) for _ in range(_DRAWS_OF_NOISE)
        ]
        still = ~are_moving(self.command, self.read)
        mean_squares = np.where(still, np.mean((self.command - self.read) ** 2, axis=1), 0.0)
        open_squares = np.mean(np.square(draws), axis=(0, 2)) + carry**2 @ mean_squares
        shares = np.divide(np.sqrt(open_squares), peaks, out=np.full(peaks.size, np.inf), where=peaks > 0.0)
        return np.asarray(shares)


@dataclass(frozen=True, kw_only=True, eq=False)
class RebuiltError:
    """The errors of a test's interface displacements with their uncertainty; the largest one governs."""

    readings: Readings
    structure: Partition  # The structure with which the parts are found
    histories: Histories  # Histories without noise, of which the parts are made
    displacements: tuple[DisplacementError, ...]  # In the order of the interface displacements
    inferred: InferredError  # Draws of everything that is uncertain, and what they say of the error
    ground: ShownGround = ShownGround()  # noqa: RUF009 - What the recorded ground acceleration shows
    # What was learned of the specimen from its own force, where it is known by that only
    specimen: "MeasuredSpecimen | None" = None

    @property
    def time_step(self) -> float:
        """Step between samples [s]."""
        return self.readings.time_step

    @property
    def command(self) -> Array:
        """x_c at the interface [m], shape (p, n)."""
        return np.asarray(self.histories.carry @ self.histories.command)

    @property
    def judged(self) -> tuple[DisplacementError, ...]:
        """Displacements that move enough for their noise."""
        return tuple(degree for degree in self.displacements if degree.judged)

    def governing(self, metric: Metric) -> DisplacementError | None:
        """Return the displacement with the largest error; None where all are lost in noise."""
        return max(self.judged, key=lambda degree: degree.estimate(metric).value, default=None)

    @property
    def rms(self) -> Estimate:
        """RMS^R of the governing displacement with its 90 % interval."""
        return self.estimate(Metric.RMS)

    @property
    def mte(self) -> Estimate:
        """MTE^R of the governing displacement with its 90 % interval."""
        return self.estimate(Metric.MTE)

    def estimate(self, metric: Metric) -> Estimate:
        """RMS^R or MTE^R of the governing displacement with its interval; NaN where all are lost in noise."""
        governing = self.governing(metric)
        return UNKNOWN if governing is None else governing.estimate(metric)

    @cached_property
    def draws(self) -> ErrorDraws:
        """Draws of the largest error of the judged displacements; of the first where none is judged."""
        degrees = self.judged or self.displacements[:1]
        rms, mte = (np.max([degree.errors(metric) for degree in degrees], axis=0) for metric in Metric)
        return replace(degrees[0].draws, rms=rms, mte=mte)

    def probability(self, threshold: float, metric: Metric = Metric.RMS) -> float:
        """Probability that the errors of all judged displacements are below a threshold [-]."""
        return self.draws.probability_below(threshold, metric) if self.judged else 0.5

    @cached_property
    def division(self) -> DividedError:
        """The errors divided by actuator and by cause."""
        return divide(self.histories, self.structure, self.inferred.band)

    def parts(self, place: int = 0) -> Parts:
        """Parts of the error of one interface displacement."""
        if self.specimen is not None:
            return self.specimen.parts(self._peak)
        return self.division.parts(place)

    def part_of_tracking(self, followed_command: Array) -> ErrorPart:
        """Part of the error that an only actuator with this displacement [m] accounts for, shape (n,)."""
        if self.specimen is not None:
            return self.specimen.part_of_tracking(followed_command, self._peak)
        return part_of_tracking(self.histories, self.structure, self.inferred.band, followed_command)

    def budget(self, metric: Metric, place: int = 0) -> tuple[BudgetItem, ...]:
        """Say what makes the interval of a displacement, the largest contribution first."""
        items = self.inferred.budget(metric, place)
        if self.specimen is not None:
            items = (*items, self.specimen.budget_item(self.inferred, metric))
        return tuple(sorted(items, key=lambda item: -item.contribution))

    @property
    def _peak(self) -> float:
        """Largest exact response of an only displacement [m]."""
        return float(np.abs(self.displacements[0].reference).max())


def rebuild(
    command: Array,
    measured_displacement: Array,
    time_step: float,
    structure: "Structure | Partition | UpdatedModel",
    *,
    to_interface: Array | None = None,
    feedback_lag: float = 0.0,
    sensor_offset: Array | float | None = None,
    resolution: float | None = None,
    ground: Array | None = None,
    force: Array | None = None,
    ignores_force: bool = False,
    force_channel: "ForceChannel | None" = None,
    known: PriorKnowledge = EXACTLY_KNOWN,
    draws: int = DRAWS,
    seed: int = 0,
) -> RebuiltError:
    """Rebuild the errors of a test from its commands and measured displacements.

    `command`, `measured_displacement` [m], shape (n,), or (p, n) of several actuators; `time_step`,
    `feedback_lag` [s]; `structure`: with a linear specimen, or a model with a calibrated one, whose errors
    are divided into parts to first order; `to_interface`: interface displacements of unit displacements of
    the actuators [-], shape (p, p), the identity by default; `sensor_offset` [m], of several sensors shape
    (p,), NaN where it is not known; `resolution` [m]; `ground`: recorded ground acceleration [m/s²], shape
    (n,), of which one in another unit, or beside a model, shows nothing; `force`: recorded at the actuators
    [N], of one mass over the mass [N/kg], which is not compared with that of a linear specimen if
    `ignores_force`; `force_channel`: of a specimen that is learned from its force [N], which was fed back,
    what that holds beside it; `draws`: at most, as one that is not linear has fewer.

    An actuator that moves 1 % too little under a steady sine at resonance:

    >>> time = np.arange(0.0, 60.0, 1.0 / 256.0)
    >>> command = np.minimum(time / 20.0, 1.0) * np.sin(2.0 * np.pi * time)
    >>> error = rebuild(command, 0.99 * command, 1.0 / 256.0, Structure(frequency=1.0, damping_ratio=0.05))
    >>> round(error.rms.value, 3)
    0.06

    Two actuators of which one moves 1 % too little:

    >>> partition = Partition(mass=np.eye(2), damping=0.5 * np.eye(2), stiffness=40.0 * np.eye(2),
    ...                       interface=np.eye(2), specimen_stiffness=40.0 * np.eye(2))
    >>> command = np.minimum(time / 20.0, 1.0) * np.sin(np.sqrt(40.0) * time) * np.ones((2, 1))
    >>> error = rebuild(command, command * [[0.99], [1.0]], 1.0 / 256.0, partition)
    >>> round(error.displacements[0].rms.value, 2), error.displacements[1].rms.value < 1e-3
    (0.07, True)
    """
    model = None if isinstance(structure, Structure | Partition) else structure
    partition = _whole_structure(structure)
    readings = Readings.from_histories(
        command,
        measured_displacement,
        time_step,
        partition,
        to_interface=to_interface,
        ground=ground if model is None else None,
        force=force,
        sensor_offsets=sensor_offset,
        resolution=resolution,
    )
    duration = (readings.command.shape[1] - 1) * time_step
    require_lag(feedback_lag, duration)
    shown = examine_ground(readings.channels, partition, duration=duration, feedback_lag=feedback_lag)
    circumstances = Circumstances(
        **vars(known),
        partition=partition,
        channels=replace(readings.channels, ground=shown.evidence(readings.channels.ground)),
        specimen_force=force is not None and not ignores_force,
        feedback_lag=feedback_lag,
    )
    if model is not None:
        from reliab.assessment.modelled_test import infer_modelled

        inferred = infer_modelled(readings.command[0], model, circumstances, draws=draws, seed=seed)
        rebuilt = readings.error_with(readings.smoothed, partition, inferred)
    elif force_channel is not None:
        from reliab.assessment.measured_specimen.rebuild import infer_learned

        histories, noise = readings.smoothed, readings.noises[0]
        inferred, specimen = infer_learned(
            histories, force, noise, force_channel, circumstances, draws=draws, seed=seed
        )
        rebuilt = replace(readings.error_with(histories, partition, inferred), specimen=specimen)
    else:
        rebuilt = readings.rebuilt(infer_errors(circumstances, readings.stride, seed, draws=draws))
    return replace(rebuilt, ground=shown)


def _whole_structure(structure: "Structure | Partition | UpdatedModel") -> Partition:
    """Structure with its linear specimen, of a model with the tangent one."""
    if isinstance(structure, Structure | Partition):
        return whole_structure(structure)
    from reliab.assessment.modelled_test import tangent_structure

    return tangent_structure(structure.test)
