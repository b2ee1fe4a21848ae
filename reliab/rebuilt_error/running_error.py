"""The error history of a running test, sample by sample.

The recursion of `rebuild` continues from chunk to chunk. Two more responses are computed with it: the
response to a constant, with which a sensor offset that is found later is subtracted from all samples so far,
and the decay from the static state under a constant x_c − x_m, for tests that began in equilibrium under an
offset.
"""

import numpy as np
from numpy.typing import NDArray

from reliab.compiled import compiled
from reliab.errors import InputError
from reliab.rebuilt_error.feedback import delayed
from reliab.rebuilt_error.recursion import Recursion, advance, equilibrium
from reliab.rebuilt_error.size import LARGEST_READING
from reliab.rebuilt_error.whole_structure import WholeStructure

Array = NDArray[np.float64]

_ROWS = 5  # command, measured, error, response to a constant, decay from equilibrium
_SUMS = 5  # see `_follow`
_CAPACITY = 4096

MOST_FOLLOWED = 50_000_000
"""Largest number of samples of a running test, 54 h at 256 Hz; its histories then take 2 to 3 GB."""


class RunningError:
    """Histories of a running test and sums over them.

    Parameters
    ----------
    structure : WholeStructure
        The whole structure.
    time_step : float
        Step between samples [s].
    feedback_lag : float
        Time by which the force is fed back late [s].
    forgetting : float
        Weight that is left of the past of the energies after a step [-].
    offset : float
        Offset of the displacement sensor [m].
    most : int, optional
        Largest number of samples.

    Attributes
    ----------
    size : int
        Samples so far.
    offset, standing : float
        Sensor offset that is taken away, and x_c − x_m under which the test began in equilibrium [m].
    sums : numpy.ndarray
        Σr², half the squares of its first and last value, max|r|, max|x_I|, and r of the last sample, of the
        error r = x_m − x_I, shape (5,).
    moments : numpy.ndarray
        Forgetting sums of the products of x_c, x_c', one and x_m − x_c between samples, shape (4, 4).
    motion : numpy.ndarray
        Number of samples that moved, and the largest forgetting sum of x_c'² so far [m²/s²], shape (2,).
    """

    def __init__(
        self,
        structure: WholeStructure,
        time_step: float,
        feedback_lag: float,
        forgetting: float,
        offset: float,
        most: int = MOST_FOLLOWED,
    ) -> None:
        self.size, self._most = 0, most
        self.offset, self.standing = offset, 0.0
        self.sums, self.moments, self.motion = np.zeros(_SUMS), np.zeros((4, 4)), np.zeros(2)
        self._recursion = Recursion.of_displacement(structure, time_step)
        self._step, self._lag, self._forgetting = time_step, feedback_lag, forgetting
        self._table = np.zeros((_ROWS, _CAPACITY))
        self._states = np.zeros((3, self._recursion.order))
        self._states[2] = equilibrium(structure, 1.0)
        self._before = np.zeros(3)

    @property
    def command(self) -> Array:
        """x_c so far [m], shape (size,)."""
        return self._table[0, : self.size]

    @property
    def measured(self) -> Array:
        """x_m so far as read [m], shape (size,)."""
        return self._table[1, : self.size]

    @property
    def error(self) -> Array:
        """x_m − x_I so far, the sensor's offset taken away [m], shape (size,)."""
        rows = self._table[2:, : self.size]
        return np.asarray(rows[0] + self.offset * rows[1] + self.standing * rows[2])

    def feed(self, command: Array, measured: Array) -> None:
        """Add the next samples.

        Parameters
        ----------
        command, measured : numpy.ndarray
            x_c and x_m [m], shape (k,), k ≥ 1.

        Raises
        ------
        InputError
            If the two differ in length, a value is beyond what a sensor reads or not finite, or the test
            becomes too long.
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
        first, last = self.size, self.size + command.size
        self._reserve(last)
        self._table[0, first:last], self._table[1, first:last] = command, measured
        self.size = last
        _follow(
            self._recursion.decay,
            self._recursion.early,
            self._recursion.late,
            self._recursion.output[0],
            self._recursion.feed_through[0],
            self._table,
            self._fed_back(first, last),
            first,
            last,
            self._states,
            self._before,
            self.sums,
            self.moments,
            self.motion,
            np.array([self.offset, self.standing]),
            self._forgetting,
            self._step,
        )

    def begin_anew(self, offset: float, standing: float) -> None:
        """Change the offset and the initial equilibrium for all samples so far.

        Parameters
        ----------
        offset, standing : float
            As the attributes of the same names [m].
        """
        if (offset, standing) == (self.offset, self.standing):
            return
        self.offset, self.standing = offset, standing
        error = self.error
        ideal = self.measured - offset - error
        self.sums[:] = (
            error @ error,
            0.5 * (error[0] ** 2 + error[-1] ** 2),
            np.abs(error).max(),
            np.abs(ideal).max(),
            error[-1],
        )

    def _fed_back(self, first: int, last: int) -> Array:
        """x_c minus the displacement whose force was fed back, for the new samples."""
        context = min(first, int(self._lag / self._step) + 4)
        felt = delayed(self._table[1, first - context : last], self._lag, self._step)[context:]
        return np.asarray(self._table[0, first:last] - felt)

    def _reserve(self, size: int) -> None:
        if size > self._most:
            raise InputError(
                f"A running test may have {self._most:,} samples at most",
                value=f"{size:,}",
                remedy="Follow it anew from when everything stands still, or write fewer samples",
            )
        if size > self._table.shape[1]:
            larger = np.zeros((_ROWS, max(2 * self._table.shape[1], size)))
            larger[:, : self.size] = self._table[:, : self.size]
            self._table = larger


@compiled
def _follow(
    decay: Array,
    early: Array,
    late: Array,
    output: Array,
    feed_through: float,
    table: Array,
    fed_back: Array,
    first: int,
    last: int,
    states: Array,
    before: Array,
    sums: Array,
    moments: Array,
    motion: Array,
    beginning: Array,
    forgetting: float,
    time_step: float,
) -> None:
    """Advance the error, the response to a constant and the decay from equilibrium, in place.

    `beginning` holds the offset and the standing difference.
    """
    offset, standing = beginning
    scratch = np.empty(states.shape[1])
    inputs, between = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0, 0.0])
    begun = 0.0
    if first > 0:
        held = table[2, 0] + offset * table[3, 0] + standing * table[4, 0]
        begun = 0.5 * held * held
    for i in range(first, last):
        inputs[0] = fed_back[i - first]
        difference = table[0, i] - table[1, i]
        if i > 0:
            between[0] = 0.5 * (table[0, i] + table[0, i - 1])
            between[1] = (table[0, i] - table[0, i - 1]) / time_step
            between[3] = -0.5 * (difference + table[0, i - 1] - table[1, i - 1])
            for row in range(4):
                for column in range(4):
                    moments[row, column] = forgetting * moments[row, column] + between[row] * between[column]
            motion[0] += 1.0 if between[1] != 0.0 else 0.0
            motion[1] = max(motion[1], moments[1, 1])
        for row in range(3):
            if i > 0:
                advance(decay, early, late, before[row], inputs[row], states[row], scratch)
            before[row] = inputs[row]
            response = feed_through * inputs[row]
            for column in range(states.shape[1]):
                response += output[column] * states[row, column]
            table[2 + row, i] = response
        table[2, i] -= difference
        table[3, i] -= 1.0
        error = table[2, i] + offset * table[3, i] + standing * table[4, i]
        if i == 0:
            begun = 0.5 * error * error
        sums[0] += error * error
        sums[1] = begun + 0.5 * error * error
        sums[2] = max(sums[2], abs(error))
        sums[3] = max(sums[3], abs(table[1, i] - offset - error))
        sums[4] = error
