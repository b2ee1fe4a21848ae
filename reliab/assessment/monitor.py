"""A test while it runs: its errors and its net damping.

From time to time, at spacings that grow with the test, intervals are computed as by `rebuild` after the test;
in between, errors are known from sums over the samples so far, without intervals. Of a long test samples are
held at a lower rate, so that it takes no more memory than a shorter one; one whose nonlinear specimen has a
model is held whole.

A specimen that is known by its force only is learned and judged anew whenever the test has grown by a fourth.
While held-out parts of the force are predicted badly it counts as not learned, and no error is stated. Such a
test is held whole.
"""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import ClassVar

import numpy as np

from reliab.assessment.inference.posterior import DRAWS as DRAWS_AT_END
from reliab.assessment.inference.uncertain_quantity import EXACTLY_KNOWN, PriorKnowledge
from reliab.assessment.measured_specimen.force_channel import NOTHING_STATED, ForceChannel
from reliab.assessment.measured_specimen.rebuild import MeasuredSpecimen
from reliab.assessment.modelled_test import tangent_structure
from reliab.assessment.rebuild import RebuiltError, rebuild
from reliab.assessment.rebuilt_error.initial import Start, examine_starts
from reliab.assessment.rebuilt_error.noise import estimate_noise, is_lost_in_noise
from reliab.assessment.rebuilt_error.running_error import RunningError
from reliab.assessment.rebuilt_error.running_test import Now, RunningSums, RunningTest, require_readings
from reliab.assessment.rebuilt_error.size import samples_in_step_of_structure
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.vocabulary import Metric
from reliab.simulation.hybrid_test.model_file import UpdatedModel
from reliab.structures.partition import Partition, whole_structure
from reliab.structures.structure import Structure

_MOST_HELD = 1 << 19  # samples before two of a long test are joined
_COARSEST = 4  # times the step that resolves the structure's modes, to which samples are joined at most
_STRETCH = 1 << 14  # samples that resolve the structure's modes

DRAWS = 64
"""Draws behind the intervals of a running test."""


class HeldSamples:
    """Samples of a test so far; of a long test means of as many samples as its structure allows.

    `most`: number of samples that are held before two of them are joined to their mean; `most_joined`: number
    of samples that are joined to one at most.
    """

    def __init__(self, most: int, most_joined: int) -> None:
        self.joined, self._most, self._most_joined = 1, most, most_joined
        self._parts: list[Array] = []
        self._size, self._waiting = 0, np.zeros((0, 0))  # for others with which they are joined

    def feed(self, rows: Array) -> None:
        """Add the next samples of all channels, shape (channels, k)."""
        rows = np.concatenate([self._waiting, rows], axis=1) if self._parts else rows
        size = rows.shape[1] // self.joined
        self._parts.append(_join(rows, self.joined))
        self._waiting, self._size = rows[:, size * self.joined :].copy(), self._size + size
        while self._size > self._most and 2 * self.joined <= self._most_joined:
            held, self._size = self.rows, self._size // 2
            single = np.repeat(held[:, 2 * self._size :], self.joined, axis=1)
            self._waiting = np.concatenate([single, self._waiting], axis=1)
            self._parts, self.joined = [_join(held, 2)], 2 * self.joined

    @property
    def rows(self) -> Array:
        """All channels so far, shape (channels, n)."""
        self._parts = [np.concatenate(self._parts, axis=1)]
        return self._parts[0]


def _join(rows: Array, count: int) -> Array:
    """Means of so many samples each, without those that are too few at the end."""
    size = rows.shape[1] // count
    return np.asarray(rows[:, : size * count].reshape(-1, size, count).mean(axis=2))


class Monitor(RunningTest):
    """Follow the errors of a test while it runs.

    `time_step`, `feedback_lag` [s]; `sensor_offset` of an only actuator [m]; `to_interface`: interface
    displacements of unit displacements of the actuators [-], shape (p, p), the identity by default;
    `metric`: by which the governing displacement is the one with the largest error; `stretch`: samples after
    which the errors of those of a test with one actuator are forgotten, but for sums over them.

    >>> time = np.arange(0.0, 30.0, 1.0 / 256.0)
    >>> command = np.minimum(time / 10.0, 1.0) * np.sin(2.0 * np.pi * time)
    >>> monitor = Monitor(Structure(frequency=1.0, damping_ratio=0.05), 1.0 / 256.0)
    >>> for chunk in np.array_split(np.stack([command, 0.99 * command]), 7, axis=1):
    ...     monitor.feed(*chunk)
    >>> from reliab.assessment.rebuild import rebuild
    >>> whole = rebuild(command, 0.99 * command, 1.0 / 256.0, Structure(frequency=1.0, damping_ratio=0.05))
    >>> monitor.ask(draws=256).rms == whole.rms
    True

    Several actuators, of which one moves too little:

    >>> partition = Partition(mass=np.eye(2), damping=0.5 * np.eye(2), stiffness=40.0 * np.eye(2),
    ...                       interface=np.eye(2), specimen_stiffness=40.0 * np.eye(2))
    >>> command = np.minimum(time / 20.0, 1.0) * np.sin(np.sqrt(40.0) * time) * np.ones((2, 1))
    >>> monitor = Monitor(partition, 1.0 / 256.0)
    >>> for chunk in np.array_split(np.stack([command, command * [[0.99], [1.0]]]), 7, axis=2):
    ...     monitor.feed(*chunk)
    >>> monitor.governing, round(monitor.now.rms, 2)
    ('1', 0.06)
    """

    def __init__(
        self,
        structure: Structure | Partition | UpdatedModel,
        time_step: float,
        *,
        to_interface: Array | None = None,
        feedback_lag: float = 0.0,
        sensor_offset: float | None = None,
        known: PriorKnowledge = EXACTLY_KNOWN,
        metric: Metric = Metric.RMS,
        seed: int = 0,
        stretch: int | None = None,
    ) -> None:
        self._model = structure if isinstance(structure, UpdatedModel) else None
        self._partition = (
            tangent_structure(structure.test)
            if isinstance(structure, UpdatedModel)
            else whole_structure(structure)
        )
        self._has_several = self._partition.degrees > 1
        super().__init__(
            self._partition.nonsingular_form if self._has_several else self._partition,
            time_step,
            known.skew_deviation(time_step),
        )
        self._lag, self._sensor_offset = feedback_lag, sensor_offset
        self._known, self._seed = replace(known, equipment=known.equipment.fix_skew(time_step)), seed
        is_held = self._has_several or self._model is not None
        stride = samples_in_step_of_structure(self.structure, time_step)
        self._stretch = sys.maxsize if is_held else stretch or stride * _STRETCH
        if feedback_lag > self._stretch * time_step:
            raise InputError(
                "The lag of the fed-back force must be shorter than a stretch", value=f"{feedback_lag:g} s"
            )
        self._carry = np.eye(self._partition.degrees) if to_interface is None else np.asarray(to_interface)
        self._metric = metric
        self._running = RunningError(
            self.structure,
            time_step,
            feedback_lag,
            np.full(self._partition.degrees, sensor_offset or 0.0),
            carry=self._carry,
            test=None if self._model is None else self._model.test,
        )
        most_joined = 1 if is_held else _COARSEST * stride
        self._held = HeldSamples(stretch or _MOST_HELD, most_joined)
        self._has_begun = False  # whether samples of the motion were forgotten
        self._judged: tuple[str, ...] = self._partition.names

    @property
    def samples(self) -> int:
        """Samples so far."""
        return self._running.size

    @property
    def is_whole(self) -> bool:
        """Whether no stretch was forgotten yet."""
        return self._running.kept_samples == self._running.size

    @property
    def error(self) -> Array:
        """x_m − x_I of the stretch that is not yet forgotten, without offsets [m], shape (k,) or (p, k)."""
        return self._running.error if self._has_several else self._running.error[0]

    def feed(self, command: Array, measured_displacement: Array, ground: Array | None = None) -> None:
        """Add the next samples, shape (k,), or (p, k) of several; `command`, `measured_displacement` [m].

        `ground`: recorded ground acceleration [m/s²], shape (k,), with all samples or with none.
        """
        if self._has_several and command.shape[:-1] != (self._partition.degrees,):
            raise InputError(
                f"Commands and measured displacements must be those of {self._partition.degrees} actuators",
                value=f"shapes {command.shape} and {measured_displacement.shape}",
            )
        if command.shape != measured_displacement.shape or command.ndim != 1 + self._has_several:
            raise InputError(
                "Command and measured displacement must have the same length",
                value=f"{command.shape} and {measured_displacement.shape}",
            )
        require_readings(command, measured_displacement)
        rows = np.stack([np.atleast_2d(command), np.atleast_2d(measured_displacement)])
        self._held.feed(np.concatenate([*rows, *([] if ground is None else [ground[np.newaxis]])]))
        begin = 0
        while begin < rows.shape[2]:
            room = max(2 * self._stretch + 1 - self._running.kept_samples, 1)
            some = rows[:, :, begin : min(begin + room, rows.shape[2])]
            self._running.feed(*some)
            self._energy.feed(*(self._carry @ some if self._has_several else some[:, 0]))
            if self._running.kept_samples > 2 * self._stretch:
                self._forget()
            begin += some.shape[2]

    def _forget(self) -> None:
        """Forget the first stretch of those that are kept, after its sensor's offset was read."""
        command, measured_displacement = self._running.command[0], self._running.measured[0]
        if not self._has_begun and np.ptp(command[: self._stretch + 1]) > 0.0:
            noise = estimate_noise(command, measured_displacement, self.time_step)
            histories = command[np.newaxis], measured_displacement[np.newaxis], self.time_step
            starts = examine_starts(*histories, self.structure, [noise], self._carry, self._sensor_offset)
            self._begin_anew(starts)
            self._has_begun = True
        self._running.forget(self._stretch)

    def _begin_anew(self, starts: Sequence[Start]) -> None:
        """Take how the channels begin from all samples so far, unless the first of them were forgotten."""
        if not self._has_begun:
            offsets, standing = (
                np.array([getattr(start, name) for start in starts]) for name in ("offset", "standing")
            )
            self._running.begin_anew(offsets, self._carry @ -standing)

    def _draw(self, draws: int) -> RebuiltError:
        """Draw the errors of the test so far."""
        rows, degrees = self._held.rows, self._partition.degrees
        command, measured_displacement = rows[:degrees], rows[degrees : 2 * degrees]
        step = self._held.joined * self.time_step
        return rebuild(
            command,
            measured_displacement,
            step,
            self._model or self._partition,
            to_interface=self._carry,
            feedback_lag=self._lag,
            sensor_offset=self._sensor_offset,
            ground=rows[-1] if len(rows) > 2 * degrees else None,
            known=self._known,
            draws=draws,
            seed=self._seed,
        )

    @property
    def displacements(self) -> Mapping[str, Now]:
        """What is known of each interface displacement at the last sample, by name."""
        errors = [self._now(sums.latest, sums.rms, sums.mte) for sums in self._running.sums]
        return MappingProxyType(dict(zip(self._partition.names, errors, strict=True)))

    @property
    def judged(self) -> tuple[str, ...]:
        """Displacements that moved enough for their noise when intervals were last computed."""
        return self._judged

    @property
    def governing(self) -> str:
        """Name of the displacement with the largest error so far."""
        names, sizes = self._judged or self._partition.names, self.displacements
        return max(names, key=lambda name: sizes[name].size(self._metric) or 0.0)

    @property
    def now(self) -> Now:
        """What is known of the governing displacement at the last sample."""
        if self.samples == 0:
            raise InputError("A running test must have a sample", remedy="Pass a sample first")
        return self.displacements[self.governing]

    def _calm(self, name: str) -> float:
        return self._running.sums[self._partition.names.index(name)].calm * self.time_step

    def ask(self, *, draws: int = DRAWS) -> RebuiltError:
        """Compute the error of the test so far with its intervals."""
        if draws > DRAWS_AT_END:
            raise InputError(f"A running test has {DRAWS_AT_END} draws at most", value=draws)
        error = self._draw(draws)
        self._begin_anew(error.readings.starts)
        self._judged = tuple(degree.name for degree in error.judged)
        running = self._running
        is_lost = not self._has_several and is_lost_in_noise(
            running.command[0] - running.measured[0], running.sums[0].largest
        )
        judged = {degree.name: degree for degree in error.judged}
        self._conclude(error if judged else None, judged, lost_in_noise=is_lost)
        return error


_ENOUGH = 0.1  # of the force on held-out parts, above which a running test has not shown enough


class MeasuredMonitor(RunningTest):
    """Follow the error of a test whose specimen is learned from its force; `time_step`, `feedback_lag` [s].

    `structure` [kg, N·s/m, N/m]: the computer's part and the specimen's initial stiffness; `channel`: what
    the force holds beside that of the specimen; `known`: how far what is stated may be off.
    """

    growth: ClassVar[float] = 0.25

    def __init__(
        self,
        structure: Partition,
        time_step: float,
        *,
        feedback_lag: float = 0.0,
        channel: ForceChannel = NOTHING_STATED,
        known: PriorKnowledge = EXACTLY_KNOWN,
    ) -> None:
        super().__init__(structure, time_step, known.skew_deviation(time_step))
        self._lag, self._channel, self._prior = feedback_lag, channel, known
        self._parts: list[Array] = []
        self._samples = 0
        self._learned: RebuiltError | None = None  # last, if anything was
        self._known: RebuiltError | None = None  # the same, if it counts as learned

    @property
    def samples(self) -> int:
        """Samples so far."""
        return self._samples

    @property
    def specimen(self) -> MeasuredSpecimen | None:
        """What was learned last; None before anything could be."""
        return None if self._learned is None else self._learned.specimen

    @property
    def learning_time(self) -> float | None:
        """Time up to which the specimen was learned last [s]; None before it was tried."""
        return (self._asked - 1) * self.time_step if self._asked else None

    def feed(self, command: Array, measured_displacement: Array, force: Array) -> None:
        """Add the next samples.

        `command`, `measured_displacement` [m]; `force` [N].
        """
        require_readings(command, measured_displacement)
        self._parts.append(np.stack([command, measured_displacement, force]))
        self._samples += command.size
        self._energy.feed(command, measured_displacement)

    @property
    def now(self) -> Now:
        """What is known at the last sample, errors as they were last computed."""
        last = self._known
        if last is None:
            return self._now(None, None, None)
        return self._now(float(last.displacements[0].error[-1]), last.rms.value, last.mte.value)

    def _calm(self, name: str) -> float:  # noqa: ARG002 - of the only displacement
        if self._known is None:
            return 0.0
        sums = RunningSums()
        reference = self._known.displacements[0].reference
        sums.add(np.zeros_like(reference), reference)
        return sums.calm * self.time_step

    def ask(self, *, at_end: bool = False) -> RebuiltError | None:
        """Learn the specimen from all samples so far, and compute the error; None while it is not learned.

        At the end it counts as learned where `assess` takes it so, which is less than while it runs.
        """
        self._learned, self._known = self._learn(at_end=at_end), None
        if self.specimen is not None:
            is_known = self.specimen.learned if at_end else self.specimen.held_out <= _ENOUGH
            self._known = self._learned if is_known else None
        error = self._known
        if error is None:
            self._conclude(None, {})
            return None
        command, measured_displacement, _ = self._parts[0]
        peak = float(np.abs(error.displacements[0].reference).max())
        is_lost = is_lost_in_noise(command - measured_displacement, peak)
        self._conclude(error, {"": error}, lost_in_noise=is_lost)
        return error

    def _learn(self, *, at_end: bool) -> RebuiltError | None:
        """Learn the specimen from all samples so far; None while they are too few to learn anything."""
        self._parts = [np.concatenate(self._parts, axis=1)]
        command, measured_displacement, force = self._parts[0]
        try:
            return rebuild(
                command,
                measured_displacement,
                self.time_step,
                self.structure,
                feedback_lag=self._lag,
                force=force,
                force_channel=self._channel,
                known=self._prior,
            )
        except InputError:
            if at_end:
                raise
            return None
