"""A linear or modelled test while it runs: its errors sample by sample, and its net damping.

The error histories equal those that `rebuild` or `rebuild_coupled` gives after the test. From time to time,
at spacings that grow with the test, intervals are computed as by these; in between, errors are known from
sums over the samples so far, without intervals. A long test with one actuator is judged stretch by stretch,
and what is judged is forgotten: two stretches are held in memory at most, however long the test lasts. One
with several actuators is held whole, and one whose nonlinear specimen has a model, whose intervals are those
of `rebuild_with_specimen`.
"""

import sys
from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from reliab.assessment.coupled_error.coupled_error import CoupledError
from reliab.assessment.coupled_error.rebuild import rebuild_coupled
from reliab.assessment.rebuilt_error.noise import is_lost_in_noise
from reliab.assessment.rebuilt_error.nonlinear_reference import (
    DRAWS as DRAWS_OF_MODEL,
    rebuild_with_specimen,
    tangent_structure,
)
from reliab.assessment.rebuilt_error.rebuild import DRAWS as DRAWS_AT_END, RebuiltError
from reliab.assessment.rebuilt_error.recursion import Recursion
from reliab.assessment.rebuilt_error.running_error import RunningError
from reliab.assessment.rebuilt_error.running_test import Now, RunningTest, require_readings
from reliab.assessment.rebuilt_error.stretches import (
    ErrorSoFar,
    StatedTest,
    error_of_stretch,
    samples_in_stretch,
)
from reliab.assessment.rebuilt_error.tolerances import Tolerances
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.vocabulary import Metric
from reliab.simulation.hybrid_test.model_file import UpdatedModel
from reliab.structures.partition import Partition, whole_structure
from reliab.structures.structure import Structure

DRAWS = 64
"""Draws behind the intervals of a running test."""


class Monitor(RunningTest):
    """Follow the errors of a test while it runs.

    `time_step`, `feedback_lag` [s]; `sensor_offset` of an only actuator [m]; `to_interface`: interface
    displacements of unit displacements of the actuators [-], shape (p, p), the identity by default;
    `recursion`: of the ideal test of several actuators as the computer steps it, exact by default; `metric`:
    by which the governing displacement is the one with the largest error; `stretch`: samples after which a
    test with one actuator is judged and forgotten.

    >>> time = np.arange(0.0, 30.0, 1.0 / 256.0)
    >>> command = np.minimum(time / 10.0, 1.0) * np.sin(2.0 * np.pi * time)
    >>> monitor = Monitor(Structure(frequency=1.0, damping_ratio=0.05), 1.0 / 256.0)
    >>> for chunk in np.array_split(np.stack([command, 0.99 * command]), 7, axis=1):
    ...     monitor.feed(*chunk)
    >>> from reliab.assessment.rebuilt_error.rebuild import rebuild
    >>> whole = rebuild(command, 0.99 * command, 1.0 / 256.0, Structure(frequency=1.0, damping_ratio=0.05))
    >>> bool(np.abs(monitor.error - whole.error).max() < 1e-12)
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
        tolerances: Tolerances | None = None,
        recursion: Recursion | None = None,
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
            (tolerances or Tolerances()).time_shift,
        )
        self._test = StatedTest(
            structure=self.structure,
            time_step=time_step,
            feedback_lag=feedback_lag,
            sensor_offset=sensor_offset,
            tolerances=tolerances or Tolerances(),
            seed=seed,
        )
        is_held = self._has_several or self._model is not None
        self._stretch = sys.maxsize if is_held else stretch or samples_in_stretch(self.structure, time_step)
        if feedback_lag > self._stretch * time_step:
            raise InputError(
                "The lag of the fed-back force must be shorter than a stretch", value=f"{feedback_lag:g} s"
            )
        self._carry = np.eye(self._partition.degrees) if to_interface is None else np.asarray(to_interface)
        self._recursion, self._metric = recursion, metric
        self._running = RunningError(
            self.structure,
            time_step,
            feedback_lag,
            np.full(self._partition.degrees, sensor_offset or 0.0),
            carry=self._carry,
            recursion=recursion,
            test=None if self._model is None else self._model.test,
        )
        self._rest = 0
        self._before: ErrorSoFar | None = None
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

    def feed(self, command: Array, measured_displacement: Array) -> None:
        """Add the next samples, shape (k,), or (p, k) of several; `command`, `measured_displacement` [m]."""
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
        rows, begin = np.stack([np.atleast_2d(command), np.atleast_2d(measured_displacement)]), 0
        while begin < rows.shape[2]:
            room = max(2 * self._stretch + 1 - self._running.kept_samples, 1)
            some = rows[:, :, begin : min(begin + room, rows.shape[2])]
            self._running.feed(*some)
            self._energy.feed(*(self._carry @ some if self._has_several else some[:, 0]))
            if self._running.kept_samples > 2 * self._stretch:
                self._judge_and_forget()
            begin += some.shape[2]

    def _judge_and_forget(self) -> None:
        """Forget the first stretch of those that are kept, after its error was drawn."""
        if self._before is None and not np.ptp(self._running.command[:, : self._stretch + 1]) > 0.0:
            self._rest += self._stretch
        else:
            self._before = self._draw_stretch(self._stretch + 1, DRAWS_AT_END)
        self._running.forget(self._stretch)

    def _draw_with_model(self, model: UpdatedModel, draws: int) -> RebuiltError:
        """Draw the error of the whole test so far with the model's specimen."""
        running, test = self._running, self._test
        error = rebuild_with_specimen(
            running.command[0],
            running.measured[0],
            test.time_step,
            model.test,
            deviations=model.deviations,
            sensor_offset=test.sensor_offset,
            tolerances=test.tolerances,
            draws=min(draws, DRAWS_OF_MODEL),
            seed=test.seed,
        )
        running.begin_anew(np.array([error.start.offset]), np.array([-error.start.standing]))
        return error

    def _draw_stretch(self, samples: int, draws: int) -> ErrorSoFar:
        """Draw the error up to the first of the samples that are kept."""
        running = self._running
        last = running.kept_samples if self._before is None else samples
        error = error_of_stretch(
            running.command[0, :last],
            running.measured[0, :last],
            self._test,
            draws=draws,
            samples=samples,
            earlier=self._before,
        )
        if self._before is not None:
            return error
        running.begin_anew(np.array([error.start.offset]), np.array([-error.start.standing]))
        return error.prepend_rest(self._rest)

    def _draw_several(self, draws: int) -> CoupledError:
        """Draw the errors of all displacements of the test so far."""
        error = rebuild_coupled(
            self._running.command,
            self._running.measured,
            self.time_step,
            self._partition,
            to_interface=self._carry,
            feedback_lag=self._test.feedback_lag,
            tolerances=self._test.tolerances,
            recursion=self._recursion,
            draws=draws,
            seed=self._test.seed,
        )
        self._judged = tuple(degree.name for degree in error.judged)
        offsets, standing = (
            np.array([getattr(start, name) for start in error.starts]) for name in ("offset", "standing")
        )
        self._running.begin_anew(offsets, self._carry @ -standing)
        return error

    @property
    def displacements(self) -> Mapping[str, Now]:
        """What is known of each interface displacement at the last sample, by name."""
        errors = map(self._now, self._running.sums)
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

    def ask(self, *, draws: int = DRAWS) -> ErrorSoFar | RebuiltError | CoupledError:
        """Compute the error of the test so far with its intervals.

        Returns as `rebuild` or `rebuild_coupled` finds it for the samples so far, where they are at most two
        stretches.
        """
        if draws > DRAWS_AT_END:
            raise InputError(f"A running test has {DRAWS_AT_END} draws at most", value=draws)
        running = self._running
        if self._has_several:
            error = self._draw_several(draws)
            self._conclude(error.governing(self._metric), {degree.name: degree for degree in error.judged})
            return error
        single = (
            self._draw_stretch(running.kept_samples, draws)
            if self._model is None
            else self._draw_with_model(self._model, draws)
        )
        is_lost = is_lost_in_noise(running.command[0] - running.measured[0], running.sums[0].largest)
        self._conclude(single, {self.governing: single}, lost_in_noise=is_lost)
        return single
