"""A test while it runs: its error sample by sample, and the net damping with its actuator.

The error history equals the one that `rebuild` gives after the test. From time to time, at spacings that grow
with the test, intervals are computed as by `rebuild`; in between, errors are known from sums over the samples
so far, without intervals. A long test is judged stretch by stretch, and what is judged is forgotten: two
stretches are held in memory at most, however long the test lasts. Where a model says what a nonlinear
specimen does, the intervals are those of `rebuild_with_specimen` and the test is held whole.

Two alarms are raised while the test runs. That of the energy is stated in `stability_indicator`. That of the
error compares an error so far with the threshold, though its peak, by which it is divided, may still grow and
a quiet end may dilute it. It waits until the peak of the response has not doubled for 12 s, and is raised
when the low end of the interval is above twice the threshold: of the responses of 450 structures (0.4 to 4
Hz, damping ratios of 1 to 6 %) to synthetic earthquakes, with errors that grow with the motion and such that
do not, one in a hundred fell to less than half of its error after that.
"""

import sys
from dataclasses import dataclass

import numpy as np

from reliab.arrays import Array
from reliab.assessment.rebuilt_error.channels import FEWEST_SAMPLES
from reliab.assessment.rebuilt_error.loop_energy import LoopEnergy
from reliab.assessment.rebuilt_error.nonlinear_reference import (
    DRAWS as DRAWS_OF_MODEL,
    rebuild_with_specimen,
    tangent_structure,
)
from reliab.assessment.rebuilt_error.rebuild import DRAWS as DRAWS_AT_END
from reliab.assessment.rebuilt_error.rebuilt import RebuiltError
from reliab.assessment.rebuilt_error.running_error import RunningError
from reliab.assessment.rebuilt_error.stability_indicator import NetDamping
from reliab.assessment.rebuilt_error.stretches import (
    ErrorSoFar,
    Stated,
    error_of_stretch,
    samples_in_stretch,
)
from reliab.assessment.rebuilt_error.tolerances import Tolerances
from reliab.assessment.rebuilt_error.watched_modes import modes_of_structure
from reliab.assessment.rebuilt_error.whole_structure import WholeStructure, whole_structure
from reliab.errors import InputError
from reliab.recordings import LARGEST_READING
from reliab.simulation.hybrid_test import UpdatedModel
from reliab.structures import Partition, Structure
from reliab.vocabulary import Metric

DRAWS = 64
"""Draws behind the intervals of a running test."""

_GROWTH = 0.5  # by which a test must grow before its intervals are computed again
_PERIODS_BETWEEN = 4.0  # of the structure, at least
CALM = 12.0  # s for which the peak of the response must not have doubled before an error is judged
SHRINKS = 0.5  # share of itself to which an error may still fall then
FALSE_ERROR_ALARMS = 0.01  # share of tests that end below the threshold and have an alarm of the error


@dataclass(frozen=True, kw_only=True)
class Now:
    """What is known of a running test at its last sample."""

    samples: int  # Samples so far
    time: float  # Time since the first sample [s]
    error: float  # x_m − x_I [m]
    rms: float  # rms, mte: RMS^R and MTE^R so far [-], sensor noise included; zero while nothing moves
    mte: float
    # Smallest net damping of the watched modes; None where too little motion was recorded
    damping: NetDamping | None


class Monitor:
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
        structure: Structure | Partition | WholeStructure | UpdatedModel,
        time_step: float,
        *,
        feedback_lag: float = 0.0,
        sensor_offset: float | None = None,
        tolerances: Tolerances | None = None,
        seed: int = 0,
        stretch: int | None = None,
    ) -> None:
        self._model = structure if isinstance(structure, UpdatedModel) else None
        self.structure = (
            tangent_structure(structure.test)
            if isinstance(structure, UpdatedModel)
            else whole_structure(structure)
        )
        if not (np.isfinite(time_step) and time_step > 0.0):
            raise InputError("The time step must be positive", value=f"{time_step} s")
        self.time_step = time_step
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
        self._period = 1.0 / (float(self.structure.natural_frequencies[0]) or 1.0)
        self._running = RunningError(
            self.structure,
            time_step,
            feedback_lag,
            sensor_offset or 0.0,
            None if self._model is None else self._model.test,
        )
        self._energy = LoopEnergy(modes_of_structure(self.structure, time_step))
        self._asked = self._rest = 0
        self._before: ErrorSoFar | None = None
        self._result: ErrorSoFar | RebuiltError | None = None
        self._low = dict.fromkeys(Metric, 0.0)

    @property
    def samples(self) -> int:
        """Samples so far."""
        return self._running.size

    @property
    def error(self) -> Array:
        """x_m − x_I of the stretch that is not yet forgotten, without the sensor's offset [m], shape (k,)."""
        return self._running.error

    @property
    def gains_energy_since(self) -> float | None:
        """Time from which on the loop may diverge [s]; None while nothing points to it."""
        return None if self._energy.since is None else self._energy.since * self.time_step

    @property
    def gaining_frequency(self) -> float | None:
        """Natural frequency of the mode that may diverge [Hz]; None while nothing points to it."""
        mode = self._energy.gaining
        return None if mode is None else mode.circular_frequency / (2.0 * np.pi)

    @property
    def result(self) -> ErrorSoFar | RebuiltError | None:
        """The last error with its intervals; None before there was one."""
        return self._result

    def feed(self, command: Array, measured: Array) -> None:
        """Add the next samples.

        `command`, `measured` [m].
        """
        if command.shape != measured.shape or command.ndim != 1:
            raise InputError(
                "Command and measured displacement must have one length",
                value=f"{command.shape} and {measured.shape}",
            )
        if not (np.abs([command, measured]) < LARGEST_READING).all():
            raise InputError(
                f"Every value must be a finite number below {LARGEST_READING:g}", remedy="Repair the row"
            )
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
        peak, ideal, error = self._running.sums[2:5]
        return Now(
            samples=self._running.size,
            time=(self._running.size - 1) * self.time_step,
            error=float(error),
            rms=float(np.sqrt(self._running.mean_square) / ideal) if ideal > 0.0 else 0.0,
            mte=float(peak / ideal) if ideal > 0.0 else 0.0,
            damping=self._energy.net,
        )

    def exceeds(self, threshold: float, metric: Metric = Metric.RMS) -> bool:
        """Whether the error will stay above a threshold, whatever peak and quiet end are still to come.

        `threshold` [-].
        Returns false before there were intervals, and until the peak of the response has not doubled for 12
        s.
        """
        if self._running.calm < CALM:
            return False
        low = self._low[metric] * (self.now.rms if metric is Metric.RMS else self.now.mte)
        return bool(SHRINKS * low > threshold)

    @property
    def due(self) -> bool:
        """Whether the test has grown so much that intervals are worth computing again."""
        grown = self._running.size - self._asked
        least = max(FEWEST_SAMPLES, int(_PERIODS_BETWEEN * self._period / self.time_step))
        return self._energy.moves and grown >= max(least, int(_GROWTH * self._asked))

    def ask(self, *, draws: int = DRAWS) -> ErrorSoFar | RebuiltError:
        """Compute the error of the test so far with its intervals.

        Returns as `rebuild` finds it for the samples so far, where they are at most two stretches.
        """
        if draws > DRAWS_AT_END:
            raise InputError(f"A running test has {DRAWS_AT_END} draws at most", value=draws)
        self._asked = self._running.size
        self._result = (
            self._drawn(self._running.kept, draws)
            if self._model is None
            else self._drawn_with_model(self._model, draws)
        )
        now = self.now
        for metric, so_far in ((Metric.RMS, now.rms), (Metric.MTE, now.mte)):
            self._low[metric] = self._result.estimate(metric).low / so_far if so_far > 0.0 else 0.0
        return self._result
