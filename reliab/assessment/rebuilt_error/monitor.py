"""A linear or modelled test while it runs: its error sample by sample, and the net damping with its actuator.

The error history equals the one that `rebuild` gives after the test. From time to time, at spacings that grow
with the test, intervals are computed as by `rebuild`; in between, errors are known from sums over the samples
so far, without intervals. A long test is judged stretch by stretch, and what is judged is forgotten: two
stretches are held in memory at most, however long the test lasts. Where a model says what a nonlinear
specimen does, the intervals are those of `rebuild_with_specimen` and the test is held whole.
"""

import sys

import numpy as np

from reliab.arrays import Array
from reliab.assessment.rebuilt_error.nonlinear_reference import (
    DRAWS as DRAWS_OF_MODEL,
    rebuild_with_specimen,
    tangent_structure,
)
from reliab.assessment.rebuilt_error.rebuild import DRAWS as DRAWS_AT_END
from reliab.assessment.rebuilt_error.rebuilt import RebuiltError
from reliab.assessment.rebuilt_error.running_error import RunningError
from reliab.assessment.rebuilt_error.running_test import Now, RunningTest, require_readings
from reliab.assessment.rebuilt_error.stretches import (
    ErrorSoFar,
    Stated,
    error_of_stretch,
    samples_in_stretch,
)
from reliab.assessment.rebuilt_error.tolerances import Tolerances
from reliab.errors import InputError
from reliab.simulation.hybrid_test import UpdatedModel
from reliab.structures import Partition, Structure, whole_structure

DRAWS = 64
"""Draws behind the intervals of a running test."""


class Monitor(RunningTest):
    """Follow the error of a test while it runs.

    `time_step`, `feedback_lag` [s]; `sensor_offset` [m].

    >>> time = np.arange(0.0, 30.0, 1.0 / 256.0)
    >>> command = np.minimum(time / 10.0, 1.0) * np.sin(2.0 * np.pi * time)
    >>> monitor = Monitor(Structure(frequency=1.0, damping_ratio=0.05), 1.0 / 256.0)
    >>> for chunk in np.array_split(np.stack([command, 0.99 * command]), 7, axis=1):
    ...     monitor.feed(*chunk)
    >>> from reliab.assessment.rebuilt_error import rebuild
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
        )
        self._test = Stated(
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
    def error(self) -> Array:
        """x_m − x_I of the stretch that is not yet forgotten, without the sensor's offset [m], shape (k,)."""
        return self._running.error

    def feed(self, command: Array, measured: Array) -> None:
        """Add the next samples.

        `command`, `measured` [m].
        """
        if command.shape != measured.shape or command.ndim != 1:
            raise InputError(
                "Command and measured displacement must have one length",
                value=f"{command.shape} and {measured.shape}",
            )
        require_readings(command, measured)
        begin = 0
        while begin < command.size:
            end = min(begin + self._room, command.size)
            self._running.feed(command[begin:end], measured[begin:end])
            self._energy.feed(command[begin:end], measured[begin:end])
            if self._model is None and self._running.kept > 2 * self._stretch:
                self._judge_and_forget()
            begin = end

    @property
    def _room(self) -> int:
        """Samples until a stretch is judged and forgotten."""
        if self._model is not None:
            return sys.maxsize
        return max(2 * self._stretch + 1 - self._running.kept, 1)

    def _judge_and_forget(self) -> None:
        """Forget the first stretch of those that are kept, after its error was drawn."""
        if self._before is None and not np.ptp(self._running.command[: self._stretch + 1]) > 0.0:
            self._rest += self._stretch
        else:
            self._before = self._drawn(self._stretch + 1, DRAWS_AT_END)
        self._running.forget(self._stretch)

    def _drawn_with_model(self, model: UpdatedModel, draws: int) -> RebuiltError:
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

    def _drawn(self, samples: int, draws: int) -> ErrorSoFar:
        """Draw the error up to the first of the samples that are kept."""
        running = self._running
        last = running.kept if self._before is None else samples
        error = error_of_stretch(
            running.command[:last],
            running.measured[:last],
            self._test,
            draws=draws,
            samples=samples,
            before=self._before,
        )
        if self._before is not None:
            return error
        running.begin_anew(error.start.offset, -error.start.standing)
        return error.after_rest(self._rest)

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
            self._drawn(self._running.kept, draws)
            if self._model is None
            else self._drawn_with_model(self._model, draws)
        )
        self._conclude(error)
        return error
