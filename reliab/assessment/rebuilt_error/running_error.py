"""The error history of a running test, sample by sample.

The recursion of `rebuild` continues from chunk to chunk, and so do sums over the error. Only the latest
samples are kept: what is forgotten stays in the sums. Two more responses are computed with it: the response
to a constant, with which a sensor offset that is found later is subtracted from all samples so far, and the
decay from the static state under a constant x_c − x_m, for tests that began in equilibrium under an
offset. Where a model says what a nonlinear specimen does, its share is computed with the offset at hand.
"""

import numpy as np

from reliab.arrays import Array
from reliab.assessment.rebuilt_error.feedback import delayed
from reliab.assessment.rebuilt_error.recursion import Recursion, advance
from reliab.assessment.rebuilt_error.running_specimen import RunningSpecimen
from reliab.assessment.rebuilt_error.running_sums import RunningSums
from reliab.compiled import compiled
from reliab.simulation.hybrid_test import HybridTest
from reliab.structures import Partition

_ROWS = 6  # command, measured, error, response to a constant, decay from equilibrium, nonlinear share
_CAPACITY = 4096


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
        self._recursion = Recursion.of_displacement(structure, time_step)
        self._step, self._lag = time_step, feedback_lag
        self._specimen = None
        if test is not None:
            slowest = 2.0 * np.pi * float(structure.natural_frequencies[0])
            by_force = Recursion.of_force(structure, time_step)
            self._specimen = RunningSpecimen(test, by_force, slowest, time_step)
        self._table = np.zeros((_ROWS, _CAPACITY))
        self._states = np.zeros((3, self._recursion.order))
        self._states[2] = self._recursion.static[:, 0]
        self._inputs = np.zeros((3, 1, 2))

    @property
    def kept(self) -> int:
        """Number of samples that are kept, the latest ones."""
        return self.size - self._forgotten

    @property
    def command(self) -> Array:
        """x_c of the samples that are kept [m], shape (kept,)."""
        return self._table[0, : self.kept]

    @property
    def measured(self) -> Array:
        """x_m as read of the samples that are kept [m], shape (kept,)."""
        return self._table[1, : self.kept]

    @property
    def error(self) -> Array:
        """x_m − x_I of the samples that are kept, the sensor's offset taken away [m], shape (kept,)."""
        return self._error(0, self.kept)

    def _error(self, first: int, last: int) -> Array:
        rows = self._table[2:, first:last]
        return np.asarray(rows[0] + self.offset * rows[1] + self.standing * rows[2] + rows[3])

    def feed(self, command: Array, measured: Array) -> None:
        """Add the next samples.

        `command`, `measured` [m].
        """
        first, last = self.kept, self.kept + command.size
        self._reserve(last)
        self._table[0, first:last], self._table[1, first:last] = command, measured
        self.size += command.size
        _follow(
            self._recursion.transition,
            self._recursion.early,
            self._recursion.late,
            self._recursion.output[0],
            self._recursion.feed_through[0, 0],
            self._table,
            self._fed_back(first, last),
            first,
            last,
            self._states,
            self._inputs,
        )
        self._conclude(first, last)

    def _conclude(self, first: int, last: int) -> None:
        """Add samples to the sums, after the share of a nonlinear specimen."""
        command, measured = self._table[0, first:last], self._table[1, first:last]
        if self._specimen is not None:
            self._table[5, first:last] = 0.0
            linear = measured - self.offset - self._error(first, last)
            fed_back = self._fed_back(first, last) + self.offset
            self._table[5, first:last] = self._specimen.follow(
                command, linear, fed_back, self._forgotten + first
            )
        error = self._error(first, last)
        self.sums.add(error, measured - self.offset - error)

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
        self._conclude(0, self.kept)

    def forget(self, count: int) -> None:
        """Forget the earliest of the samples that are kept; the sums go on over all of them."""
        self._table[:, : self.kept - count] = self._table[:, count : self.kept].copy()
        self._forgotten += count

    def _fed_back(self, first: int, last: int) -> Array:
        """x_c minus the displacement whose force was fed back, for the new samples."""
        context = int(self._lag / self._step) + 4
        known = min(first, context)
        measured = np.pad(self._table[1, first - known : last], (context - known, 0), mode="edge")
        felt = delayed(measured, self._lag, self._step)[context:]
        return np.asarray(self._table[0, first:last] - felt)

    def _reserve(self, size: int) -> None:
        if size > self._table.shape[1]:
            larger = np.zeros((_ROWS, max(2 * self._table.shape[1], size)))
            larger[:, : self._table.shape[1]] = self._table
            self._table = larger


@compiled
def _follow(
    transition: Array,
    early: Array,
    late: Array,
    output: Array,
    feed_through: float,
    table: Array,
    fed_back: Array,
    first: int,
    last: int,
    states: Array,
    inputs: Array,
) -> None:
    """Advance the error, the response to a constant and the decay from equilibrium, in place.

    `inputs`: of each at the sample before and at this one.
    """
    scratch = np.empty(states.shape[1])
    inputs[1, 0, 1] = 1.0
    for i in range(first, last):
        inputs[0, 0, 1] = fed_back[i - first]
        difference = table[0, i] - table[1, i]
        for row in range(3):
            if i > 0:
                advance((0,), transition, early, late, inputs[row], 1, states[row], scratch)
            inputs[row, 0, 0] = inputs[row, 0, 1]
            response = feed_through * inputs[row, 0, 1]
            for column in range(states.shape[1]):
                response += output[column] * states[row, column]
            table[2 + row, i] = response
        table[2, i] -= difference
        table[3, i] -= 1.0
