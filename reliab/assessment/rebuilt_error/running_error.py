"""The error of a test sample by sample, of one actuator or of several.

The recursion of `rebuild` continues from chunk to chunk, and so do sums over the error. An offset of a sensor
that is found later, or an x_c − x_m under which the test began in equilibrium, is taken from all samples so
far: those that are kept are followed anew, from where a rest that was forgotten left the structure.
"""

from collections.abc import Iterator

import numpy as np

from reliab.assessment.rebuilt_error.readings import delay_from_sample
from reliab.assessment.rebuilt_error.recursion import Recursion
from reliab.assessment.rebuilt_error.running_specimen import RunningSpecimen
from reliab.assessment.rebuilt_error.running_test import RunningResponse, RunningSums
from reliab.core.arrays import Array
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.structures.partition import Partition

_CAPACITY = 4096


class RunningError:
    """Latest histories of a running test with p actuators, and sums over all of it.

    `time_step`, `feedback_lag` [s]; `offsets` of the sensors [m], shape (p,); `carry`: interface
    displacements of unit displacements of the sensors [-], shape (p, p), the identity by default;
    `recursion`: of the ideal test as the computer steps it, exact by default; `test`: with a nonlinear
    specimen of one actuator.
    `size`: Samples so far.
    `offsets, standing`: Sensor offsets that are taken away, and x_c − x_m at the interface under which the
    test began in equilibrium [m], shape (p,).
    `sums`: over the error x_m − x_I of all samples, of each interface displacement.
    """

    def __init__(
        self,
        structure: Partition,
        time_step: float,
        feedback_lag: float,
        offsets: Array,
        *,
        carry: Array | None = None,
        recursion: Recursion | None = None,
        test: HybridTest | None = None,
    ) -> None:
        self.size = self._forgotten = 0
        self._carry = np.eye(offsets.size) if carry is None else carry
        self._step, self._lag = time_step, feedback_lag
        recursion = recursion or Recursion.from_displacement(structure, time_step)
        # left by what was forgotten: of the test, of a unit offset of each sensor, of a unit x_c − x_m under
        # which it stood
        self._left = [RunningResponse(recursion) for _ in range(1 + offsets.size)]
        self._left += [RunningResponse(recursion, state) for state in recursion.static.T]
        self._specimen = None
        if test is not None:
            slowest = 2.0 * np.pi * float(structure.natural_frequencies[0])
            force_recursion = Recursion.from_force(structure, time_step)
            self._specimen = RunningSpecimen(test, force_recursion, slowest, time_step)
        self._table = np.zeros((3, offsets.size, _CAPACITY))  # command, measured, error
        self._begin(offsets, np.zeros(offsets.size))

    def _begin(self, offsets: Array, standing: Array) -> None:
        """Begin where what was forgotten left the structure."""
        self.offsets, self.standing = offsets, standing
        self.sums = [RunningSums(self._forgotten) for _ in offsets]
        self._response = RunningResponse.sum_of(self._left, [1.0, *offsets.tolist(), *standing.tolist()])
        if self._specimen is not None:
            self._specimen.begin()

    @property
    def kept_samples(self) -> int:
        """Number of samples that are kept, the latest ones."""
        return self.size - self._forgotten

    @property
    def command(self) -> Array:
        """x_c of the samples that are kept [m], shape (p, kept)."""
        return self._table[0, :, : self.kept_samples]

    @property
    def measured(self) -> Array:
        """x_m as read of the samples that are kept [m], shape (p, kept)."""
        return self._table[1, :, : self.kept_samples]

    @property
    def error(self) -> Array:
        """x_m − x_I of the samples that are kept, the sensors' offsets taken away [m], shape (p, kept)."""
        return self._table[2, :, : self.kept_samples]

    def feed(self, command: Array, measured_displacement: Array) -> None:
        """Add the next samples, shape (p, k); `command`, `measured_displacement` [m]."""
        first, last = self.kept_samples, self.kept_samples + command.shape[1]
        self._reserve(last)
        self._table[0, :, first:last], self._table[1, :, first:last] = command, measured_displacement
        self.size += command.shape[1]
        self._follow(first, last)

    def _follow(self, first: int, last: int) -> None:
        """Advance the errors by samples that are kept."""
        command, read = self._table[:2, :, first:last]
        interface_command = self._carry @ command
        fed_back = self._fed_back(first, last) + (self._carry @ self.offsets)[:, np.newaxis]
        ideal = interface_command - self._response.follow(fed_back)
        if self._specimen is not None:
            ideal[0] -= self._specimen.follow(command[0], ideal[0], fed_back[0], self._forgotten + first)
        error = self._carry @ (read - self.offsets[:, np.newaxis]) - ideal
        self._table[2, :, first:last] = error
        for sums, row, exact in zip(self.sums, error, ideal, strict=True):
            sums.add(np.ascontiguousarray(row), np.ascontiguousarray(exact))

    def begin_anew(self, offsets: Array, standing: Array) -> None:
        """Change the offsets and the initial equilibrium for all samples so far.

        Samples of the motion must not be forgotten yet, only a rest before it.

        `offsets`, `standing` [m], shape (p,).
        """
        if np.array_equal(offsets, self.offsets) and np.array_equal(standing, self.standing):
            return
        self._begin(offsets, standing)
        self._follow(0, self.kept_samples)

    def forget(self, count: int) -> None:
        """Forget the earliest of the samples that are kept; the sums go on over all of them."""
        for response, inputs in zip(self._left, self._inputs_left(count), strict=True):
            response.follow(inputs)
        kept = self.kept_samples
        self._table[:, :, : kept - count] = self._table[:, :, count:kept].copy()
        self._forgotten += count

    def _inputs_left(self, count: int) -> Iterator[Array]:
        """Give the inputs of what is forgotten to the responses that it leaves."""
        yield self._fed_back(0, count)
        yield from (np.tile(column[:, np.newaxis], count) for column in self._carry.T)
        yield from np.zeros((*self._carry.shape, count))

    def _fed_back(self, first: int, last: int) -> Array:
        """x_c minus the displacement as read whose force was fed back, at the interface [m], shape (p, k)."""
        command, read = self._table[:2, :, :last]
        felt = np.stack([delay_from_sample(row, first, self._lag, self._step) for row in read])
        return np.asarray(self._carry @ (command[:, first:] - felt))

    def _reserve(self, size: int) -> None:
        if size > self._table.shape[2]:
            larger = np.zeros((*self._table.shape[:2], max(2 * self._table.shape[2], size)))
            larger[:, :, : self._table.shape[2]] = self._table
            self._table = larger
