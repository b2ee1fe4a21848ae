"""A test while it runs: its error sample by sample, and the damping that its actuator leaves.

The same recursion as in `rebuild` goes on from chunk to chunk, so that the error history is the one that
is rebuilt afterwards. Its response to a constant runs beside it: a sensor offset that is found later is
taken away from all that went before. At stretches that grow with the test the whole of `rebuild` is
asked, which gives intervals; between them errors are those of the histories so far.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reliab.compiled import compiled
from reliab.errors import InputError
from reliab.loop.partition.partition import Partition
from reliab.loop.structure import Structure
from reliab.rebuilt_error.channels import FEWEST_SAMPLES
from reliab.rebuilt_error.feedback import delayed
from reliab.rebuilt_error.rebuild import rebuild
from reliab.rebuilt_error.rebuilt import RebuiltError
from reliab.rebuilt_error.recursion import Recursion, advance
from reliab.rebuilt_error.stability_indicator import SETTLED, Damping
from reliab.rebuilt_error.tolerances import Tolerances
from reliab.rebuilt_error.whole_structure import WholeStructure, whole_structure
from reliab.vocabulary import Metric

Array = NDArray[np.float64]

DRAWS = 64
"""Draws behind the intervals of a running test."""

_GROWTH = 0.25  # by which a test must grow before its intervals are computed again
_PERIODS_BETWEEN = 2.0  # of the structure, at least
_ROWS = 4  # command, measured, error, response to a constant
_SUMS = 5  # see `_follow`
_BEYOND_NOISE = 20.0  # times the noise that the response must reach before an error of it is judged
_LARGEST_NOISE = 4.0  # standard deviations that noise adds to a peak at most


@dataclass(frozen=True, kw_only=True)
class Now:
    """What is known of a running test at its last sample.

    Attributes
    ----------
    samples : int
        Samples so far.
    time : float
        Time since the first sample [s].
    error : float
        x_m − x_I [m].
    rms, mte : float
        RMS^R and MTE^R so far [-], sensor noise included; zero while nothing moves.
    damping_ratio : float or None
        Net damping ratio ξ_net [-] that the actuator leaves; None before the motion has settled.
    """

    samples: int
    time: float
    error: float
    rms: float
    mte: float
    damping_ratio: float | None


class Monitor:
    """Follow the error of a test while it runs.

    Parameters
    ----------
    structure : Structure, Partition or WholeStructure
        The whole structure under test.
    time_step : float
        Step between samples [s].
    feedback_lag : float, optional
        Time by which the force is fed back late [s].
    sensor_offset : float, optional
        Offset of the displacement sensor [m]; read from rest by default.
    tolerances : Tolerances, optional
        How far stated values may be off.
    seed : int, optional
        Seed of the draws.

    Examples
    --------
    >>> time = np.arange(0.0, 30.0, 1.0 / 256.0)
    >>> command = np.minimum(time / 10.0, 1.0) * np.sin(2.0 * np.pi * time)
    >>> monitor = Monitor(Structure(frequency=1.0, damping_ratio=0.05), 1.0 / 256.0)
    >>> for chunk in np.array_split(np.stack([command, 0.99 * command]), 7, axis=1):
    ...     monitor.feed(*chunk)
    >>> whole = rebuild(command, 0.99 * command, 1.0 / 256.0, Structure(frequency=1.0, damping_ratio=0.05))
    >>> bool(np.abs(monitor.error - whole.error).max() < 1e-12)
    True
    """

    def __init__(
        self,
        structure: Structure | Partition | WholeStructure,
        time_step: float,
        *,
        feedback_lag: float = 0.0,
        sensor_offset: float | None = None,
        tolerances: Tolerances | None = None,
        seed: int = 0,
    ) -> None:
        self.structure = whole_structure(structure)
        if not (np.isfinite(time_step) and time_step > 0.0):
            raise InputError("The time step must be positive", value=f"{time_step} s")
        self.time_step = time_step
        self._lag = feedback_lag
        self._stated_offset = sensor_offset
        self._tolerances = tolerances or Tolerances()
        self._seed = seed
        self._recursion = Recursion.of_displacement(self.structure, time_step)
        self._damping = Damping.of(self.structure, time_step)
        self._period = 1.0 / (float(self.structure.natural_frequencies[0]) or 1.0)
        self._table = np.zeros((_ROWS, 4096))
        self._size = 0
        self._states = np.zeros((2, self._recursion.order))
        self._offset = sensor_offset or 0.0
        self._sums = np.zeros(_SUMS)
        self._energy = np.zeros(3)
        self._before = np.zeros(2)
        self._asked = 0
        self._result: RebuiltError | None = None

    @property
    def samples(self) -> int:
        """Samples so far."""
        return self._size

    @property
    def error(self) -> Array:
        """x_m − x_I so far, the sensor's offset taken away [m], shape (samples,)."""
        return self._table[2, : self._size] + self._offset * self._table[3, : self._size]

    @property
    def result(self) -> RebuiltError | None:
        """The last whole rebuilding with its intervals; None before there was one."""
        return self._result

    def feed(self, command: Array, measured: Array) -> None:
        """Go on with the next samples.

        Parameters
        ----------
        command, measured : numpy.ndarray
            x_c and x_m [m], shape (k,), k ≥ 1.

        Raises
        ------
        InputError
            If the two differ in length or a value is not finite.
        """
        if command.shape != measured.shape or command.ndim != 1:
            raise InputError(
                "Command and measured displacement must have one length",
                value=f"{command.shape} and {measured.shape}",
            )
        if not (np.isfinite(command).all() and np.isfinite(measured).all()):
            raise InputError("Every value must be a finite number", remedy="Repair the row")
        first, last = self._size, self._size + command.size
        self._reserve(last)
        self._table[0, first:last], self._table[1, first:last] = command, measured
        self._size = last
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
            self._sums,
            self._energy,
            self._offset,
            self._damping.forgetting,
        )

    def _fed_back(self, first: int, last: int) -> Array:
        """x_c minus the displacement whose force was fed back, for the new samples."""
        context = min(first, int(self._lag / self.time_step) + 4)
        felt = delayed(self._table[1, first - context : last], self._lag, self.time_step)[context:]
        return np.asarray(self._table[0, first:last] - felt)

    def _reserve(self, size: int) -> None:
        if size > self._table.shape[1]:
            larger = np.zeros((_ROWS, max(2 * self._table.shape[1], size)))
            larger[:, : self._size] = self._table[:, : self._size]
            self._table = larger

    @property
    def now(self) -> Now:
        """What is known at the last sample.

        Raises
        ------
        InputError
            If there is no sample yet.
        """
        if self._size == 0:
            raise InputError("A running test must have a sample", remedy="Feed one first")
        square, ends, peak, ideal, error = self._sums
        mean = max(square - ends, 0.0) / max(self._size - 1, 1)
        return Now(
            samples=self._size,
            time=(self._size - 1) * self.time_step,
            error=float(error),
            rms=float(np.sqrt(mean) / ideal) if ideal > 0.0 else 0.0,
            mte=float(peak / ideal) if ideal > 0.0 else 0.0,
            damping_ratio=self._net_damping(),
        )

    def _net_damping(self) -> float | None:
        work, speed, moving = self._energy
        if moving * self.time_step < SETTLED * self._period or not speed > 0.0:
            return None
        return float(self._damping.ratio + self._damping.factor * work * self.time_step / speed)

    def exceeds(self, threshold: float, metric: Metric = Metric.RMS) -> bool:
        """Whether the error so far is above a threshold, beyond what the sensor's noise explains.

        Parameters
        ----------
        threshold : float
            Relative error [-].
        metric : Metric, optional
            Which error; RMS^R by default.

        Returns
        -------
        bool
            False before the first whole rebuilding and while the motion is within the noise.
        """
        if self._result is None:
            return False
        noise = self._result.noise
        level = float(np.hypot(noise.white, noise.slow))
        square, ends, peak, ideal, _ = self._sums
        if not ideal > _BEYOND_NOISE * level:
            return False
        mean = max((square - ends) / max(self._size - 1, 1) - level**2, 0.0)
        size = float(np.sqrt(mean)) if metric is Metric.RMS else max(peak - _LARGEST_NOISE * level, 0.0)
        return bool(size > threshold * ideal)

    @property
    def due(self) -> bool:
        """Whether the test has grown so much that intervals are worth computing again."""
        grown = self._size - self._asked
        least = max(FEWEST_SAMPLES, int(_PERIODS_BETWEEN * self._period / self.time_step))
        moving = bool(self._energy[2] > 0.0)
        return moving and grown >= max(least, int(_GROWTH * self._asked))

    def ask(self, *, draws: int = DRAWS) -> RebuiltError:
        """Rebuild the error of the test so far, with intervals.

        Parameters
        ----------
        draws : int, optional
            Draws behind the intervals, a power of two.

        Returns
        -------
        RebuiltError
            As `rebuild` returns for the samples so far.

        Raises
        ------
        InputError
            As `rebuild`.
        """
        self._asked = self._size
        self._result = rebuild(
            self._table[0, : self._size],
            self._table[1, : self._size],
            self.time_step,
            self.structure,
            feedback_lag=self._lag,
            sensor_offset=self._stated_offset,
            tolerances=self._tolerances,
            draws=draws,
            seed=self._seed,
        )
        if self._result.start.offset != self._offset:
            self._offset = self._result.start.offset
            self._sum_again()
        return self._result

    def _sum_again(self) -> None:
        error = self.error
        ideal = self._table[1, : self._size] - self._offset - error
        self._sums[:] = (
            error @ error,
            0.5 * (error[0] ** 2 + error[-1] ** 2),
            np.abs(error).max(),
            np.abs(ideal).max(),
            error[-1],
        )


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
    energy: Array,
    offset: float,
    forgetting: float,
) -> None:
    """Advance error and response to a constant, in place.

    `sums` holds Σr², half the squares of its first and last value, max|r|, max|x_I| and r of the last sample;
    `energy` the forgetting sums of (x_m − x_c)Δx_c and Δx_c², and the samples of motion.
    """
    scratch = np.empty(states.shape[1])
    start = 0.0
    if first > 0:
        held = table[2, 0] + offset * table[3, 0]
        start = 0.5 * held * held
    for i in range(first, last):
        now = fed_back[i - first]
        if i > 0:
            advance(decay, early, late, before[0], now, states[0], scratch)
            advance(decay, early, late, before[1], 1.0, states[1], scratch)
            step = table[0, i] - table[0, i - 1]
            strayed = 0.5 * (table[1, i] - table[0, i] + table[1, i - 1] - table[0, i - 1]) - offset
            energy[0] = forgetting * energy[0] + strayed * step
            energy[1] = forgetting * energy[1] + step * step
            energy[2] += 1.0 if step != 0.0 else 0.0
        before[0], before[1] = now, 1.0
        response, constant = feed_through * now, feed_through
        for column in range(states.shape[1]):
            response += output[column] * states[0, column]
            constant += output[column] * states[1, column]
        table[2, i] = response - (table[0, i] - table[1, i])
        table[3, i] = constant - 1.0
        error = table[2, i] + offset * table[3, i]
        ideal = table[1, i] - offset - error
        if i == 0:
            start = 0.5 * error * error
        sums[0] += error * error
        sums[1] = start + 0.5 * error * error
        sums[2] = max(sums[2], abs(error))
        sums[3] = max(sums[3], abs(ideal))
        sums[4] = error
