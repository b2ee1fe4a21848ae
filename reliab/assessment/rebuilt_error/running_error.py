"""A linear or modelled test while it runs: its error sample by sample, and the net damping with its actuator.

The error history equals the one that `rebuild` gives after the test. From time to time, at spacings that grow
with the test, intervals are computed as by `rebuild`; in between, errors are known from sums over the samples
so far, without intervals. A long test is judged stretch by stretch, and what is judged is forgotten: two
stretches are held in memory at most, however long the test lasts. Where a model says what a nonlinear
specimen does, the intervals are those of `rebuild_with_specimen` and the test is held whole.

The recursion of `rebuild` continues from chunk to chunk, and so do sums over the error. Two more responses
are computed with it: the response to a constant, with which a sensor offset that is found later is subtracted
from all samples so far, and the decay from the static state under a constant x_c − x_m, for tests that began
in equilibrium under an offset.
"""

import sys

import numpy as np

from reliab.assessment.rebuilt_error.noise import is_lost_in_noise
from reliab.assessment.rebuilt_error.nonlinear_reference import (
    DRAWS as DRAWS_OF_MODEL,
    rebuild_with_specimen,
    tangent_structure,
)
from reliab.assessment.rebuilt_error.readings import delay_from_sample
from reliab.assessment.rebuilt_error.rebuild import DRAWS as DRAWS_AT_END, RebuiltError
from reliab.assessment.rebuilt_error.recursion import Recursion
from reliab.assessment.rebuilt_error.running_specimen import RunningSpecimen
from reliab.assessment.rebuilt_error.running_test import (
    Now,
    RunningResponse,
    RunningSums,
    RunningTest,
    require_readings,
)
from reliab.assessment.rebuilt_error.stretches import (
    ErrorSoFar,
    StatedTest,
    error_of_stretch,
    samples_in_stretch,
)
from reliab.assessment.rebuilt_error.tolerances import Tolerances
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.hybrid_test.model_file import UpdatedModel
from reliab.structures.partition import Partition, whole_structure
from reliab.structures.structure import Structure

_ROWS = 6  # command, measured, error, response to a constant, decay from equilibrium, nonlinear share
_CAPACITY = 4096

DRAWS = 64
"""Draws behind the intervals of a running test."""


class RunningError:
    """Latest histories of a running test, and sums over all of it.

    `time_step`, `feedback_lag` [s]; `offset` [m].
    `size`: Samples so far.
    `offset, standing`: Sensor offset that is taken away, and x_c − x_m under which the test began in
    equilibrium [m].
    `sums`: over the error x_m − x_I of all samples.
    """

    def __init__(
        self,
        structure: Partition,
        time_step: float,
        feedback_lag: float,
        offset: float,
        test: HybridTest | None = None,
    ) -> None:
        self.size = self._forgotten = 0
        self.offset, self.standing = offset, 0.0
        self.sums = RunningSums()
        recursion = Recursion.from_displacement(structure, time_step)
        self._responses = RunningResponse(recursion), RunningResponse(recursion)  # to the test, to a constant
        self._decay = RunningResponse(recursion, recursion.static[:, 0])
        self._step, self._lag = time_step, feedback_lag
        self._specimen = None
        if test is not None:
            slowest = 2.0 * np.pi * float(structure.natural_frequencies[0])
            force_recursion = Recursion.from_force(structure, time_step)
            self._specimen = RunningSpecimen(test, force_recursion, slowest, time_step)
        self._table = np.zeros((_ROWS, _CAPACITY))

    @property
    def kept_samples(self) -> int:
        """Number of samples that are kept, the latest ones."""
        return self.size - self._forgotten

    @property
    def command(self) -> Array:
        """x_c of the samples that are kept [m], shape (kept,)."""
        return self._table[0, : self.kept_samples]

    @property
    def measured(self) -> Array:
        """x_m as read of the samples that are kept [m], shape (kept,)."""
        return self._table[1, : self.kept_samples]

    @property
    def error(self) -> Array:
        """x_m − x_I of the samples that are kept, the sensor's offset taken away [m], shape (kept,)."""
        return self._error(0, self.kept_samples)

    def _error(self, first: int, last: int) -> Array:
        rows = self._table[2:, first:last]
        return np.asarray(rows[0] + self.offset * rows[1] + self.standing * rows[2] + rows[3])

    def feed(self, command: Array, measured_displacement: Array) -> None:
        """Add the next samples.

        `command`, `measured_displacement` [m].
        """
        first, last = self.kept_samples, self.kept_samples + command.size
        self._reserve(last)
        self._table[0, first:last], self._table[1, first:last] = command, measured_displacement
        self.size += command.size
        test_response, constant_response = self._responses
        answer = test_response.follow(self._fed_back(first, last)[np.newaxis])[0]
        self._table[2, first:last] = answer - (command - measured_displacement)
        self._table[3, first:last] = constant_response.follow(np.ones((1, command.size)))[0] - 1.0
        self._table[4, first:last] = self._decay.follow(np.zeros((1, command.size)))[0]
        self._conclude(first, last)

    def _conclude(self, first: int, last: int) -> None:
        """Add samples to the sums, after the share of a nonlinear specimen."""
        command, measured_displacement = self._table[0, first:last], self._table[1, first:last]
        if self._specimen is not None:
            self._table[5, first:last] = 0.0
            linear = measured_displacement - self.offset - self._error(first, last)
            fed_back = self._fed_back(first, last) + self.offset
            self._table[5, first:last] = self._specimen.follow(
                command, linear, fed_back, self._forgotten + first
            )
        error = self._error(first, last)
        self.sums.add(error, measured_displacement - self.offset - error)

    def begin_anew(self, offset: float, standing: float) -> None:
        """Change the offset and the initial equilibrium for all samples so far.

        Samples of the motion must not be forgotten yet, only a rest before it.

        `offset`, `standing` [m].
        """
        if (offset, standing) == (self.offset, self.standing):
            return
        self.offset, self.standing = offset, standing
        self.sums = RunningSums(self._forgotten)
        if self._specimen is not None:
            self._specimen.begin()
        self._conclude(0, self.kept_samples)

    def forget(self, count: int) -> None:
        """Forget the earliest of the samples that are kept; the sums go on over all of them."""
        self._table[:, : self.kept_samples - count] = self._table[:, count : self.kept_samples].copy()
        self._forgotten += count

    def _fed_back(self, first: int, last: int) -> Array:
        """x_c minus the displacement whose force was fed back, for the new samples."""
        felt_displacement = delay_from_sample(self._table[1, :last], first, self._lag, self._step)
        return np.asarray(self._table[0, first:last] - felt_displacement)

    def _reserve(self, size: int) -> None:
        if size > self._table.shape[1]:
            larger = np.zeros((_ROWS, max(2 * self._table.shape[1], size)))
            larger[:, : self._table.shape[1]] = self._table
            self._table = larger


class Monitor(RunningTest):
    """Follow the error of a test while it runs.

    `time_step`, `feedback_lag` [s]; `sensor_offset` [m].

    >>> time = np.arange(0.0, 30.0, 1.0 / 256.0)
    >>> command = np.minimum(time / 10.0, 1.0) * np.sin(2.0 * np.pi * time)
    >>> monitor = Monitor(Structure(frequency=1.0, damping_ratio=0.05), 1.0 / 256.0)
    >>> for chunk in np.array_split(np.stack([command, 0.99 * command]), 7, axis=1):
    ...     monitor.feed(*chunk)
    >>> from reliab.assessment.rebuilt_error.rebuild import rebuild
    >>> whole = rebuild(command, 0.99 * command, 1.0 / 256.0, Structure(frequency=1.0, damping_ratio=0.05))
    >>> bool(np.abs(monitor.error - whole.error).max() < 1e-12)
    True
    """

    def __init__(
        self,
        structure: Structure | Partition | UpdatedModel,
        time_step: float,
        *,
        feedback_lag: float = 0.0,
        sensor_offset: float | None = None,
        tolerances: Tolerances | None = None,
        seed: int = 0,
        stretch: int | None = None,
    ) -> None:
        self._model = structure if isinstance(structure, UpdatedModel) else None
        super().__init__(
            tangent_structure(structure.test)
            if isinstance(structure, UpdatedModel)
            else whole_structure(structure),
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
        self._stretch = stretch or samples_in_stretch(self.structure, time_step)
        if feedback_lag > self._stretch * time_step:
            raise InputError(
                "The lag of the fed-back force must be shorter than a stretch", value=f"{feedback_lag:g} s"
            )
        self._running = RunningError(
            self.structure,
            time_step,
            feedback_lag,
            sensor_offset or 0.0,
            None if self._model is None else self._model.test,
        )
        self._rest = 0
        self._before: ErrorSoFar | None = None

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
        """x_m − x_I of the stretch that is not yet forgotten, without the sensor's offset [m], shape (k,)."""
        return self._running.error

    def feed(self, command: Array, measured_displacement: Array) -> None:
        """Add the next samples.

        `command`, `measured_displacement` [m].
        """
        if command.shape != measured_displacement.shape or command.ndim != 1:
            raise InputError(
                "Command and measured displacement must have the same length",
                value=f"{command.shape} and {measured_displacement.shape}",
            )
        require_readings(command, measured_displacement)
        begin = 0
        while begin < command.size:
            end = min(begin + self._room, command.size)
            self._running.feed(command[begin:end], measured_displacement[begin:end])
            self._energy.feed(command[begin:end], measured_displacement[begin:end])
            if self._model is None and self._running.kept_samples > 2 * self._stretch:
                self._judge_and_forget()
            begin = end

    @property
    def _room(self) -> int:
        """Samples until a stretch is judged and forgotten."""
        if self._model is not None:
            return sys.maxsize
        return max(2 * self._stretch + 1 - self._running.kept_samples, 1)

    def _judge_and_forget(self) -> None:
        """Forget the first stretch of those that are kept, after its error was drawn."""
        if self._before is None and not np.ptp(self._running.command[: self._stretch + 1]) > 0.0:
            self._rest += self._stretch
        else:
            self._before = self._draw_error(self._stretch + 1, DRAWS_AT_END)
        self._running.forget(self._stretch)

    def _draw_with_model(self, model: UpdatedModel, draws: int) -> RebuiltError:
        """Draw the error of the whole test so far with the model's specimen."""
        running, test = self._running, self._test
        error = rebuild_with_specimen(
            running.command,
            running.measured,
            test.time_step,
            model.test,
            deviations=model.deviations,
            sensor_offset=test.sensor_offset,
            tolerances=test.tolerances,
            draws=min(draws, DRAWS_OF_MODEL),
            seed=test.seed,
        )
        running.begin_anew(error.start.offset, -error.start.standing)
        return error

    def _draw_error(self, samples: int, draws: int) -> ErrorSoFar:
        """Draw the error up to the first of the samples that are kept."""
        running = self._running
        last = running.kept_samples if self._before is None else samples
        error = error_of_stretch(
            running.command[:last],
            running.measured[:last],
            self._test,
            draws=draws,
            samples=samples,
            earlier=self._before,
        )
        if self._before is not None:
            return error
        running.begin_anew(error.start.offset, -error.start.standing)
        return error.prepend_rest(self._rest)

    @property
    def now(self) -> Now:
        """What is known at the last sample."""
        if self._running.size == 0:
            raise InputError("A running test must have a sample", remedy="Pass a sample first")
        return self._now(self._running.sums)

    @property
    def _calm(self) -> float:
        return self._running.sums.calm * self.time_step

    def ask(self, *, draws: int = DRAWS) -> ErrorSoFar | RebuiltError:
        """Compute the error of the test so far with its intervals.

        Returns as `rebuild` finds it for the samples so far, where they are at most two stretches.
        """
        if draws > DRAWS_AT_END:
            raise InputError(f"A running test has {DRAWS_AT_END} draws at most", value=draws)
        error = (
            self._draw_error(self._running.kept_samples, draws)
            if self._model is None
            else self._draw_with_model(self._model, draws)
        )
        running = self._running
        is_lost = is_lost_in_noise(running.command - running.measured, running.sums.largest)
        self._conclude(error, lost_in_noise=is_lost)
        return error
