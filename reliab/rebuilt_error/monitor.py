"""A test while it runs: its error sample by sample, and the net damping with its actuator.

The error history equals the one that `rebuild` gives after the test. From time to time, at spacings that grow
with the test, `rebuild` is called with all samples so far, which gives intervals; in between, errors are
computed from the histories so far, without intervals.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reliab.errors import InputError
from reliab.loop.partition.partition import Partition
from reliab.loop.structure import Structure
from reliab.rebuilt_error.channels import FEWEST_SAMPLES
from reliab.rebuilt_error.rebuild import rebuild
from reliab.rebuilt_error.rebuilt import RebuiltError
from reliab.rebuilt_error.running_error import RunningError
from reliab.rebuilt_error.size import MOST_DRAWN, fits, samples_in_step_of_structure
from reliab.rebuilt_error.stability_indicator import Damping, NetDamping
from reliab.rebuilt_error.tolerances import Tolerances
from reliab.rebuilt_error.whole_structure import WholeStructure, whole_structure
from reliab.vocabulary import Metric

Array = NDArray[np.float64]

DRAWS = 64
"""Draws behind the intervals of a running test."""

_GROWTH = 0.5  # by which a test must grow before its intervals are computed again
_PERIODS_BETWEEN = 4.0  # of the structure, at least
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
    damping : NetDamping or None
        Net damping of the loop with its actuator; None before enough motion was recorded.
    """

    samples: int
    time: float
    error: float
    rms: float
    mte: float
    damping: NetDamping | None


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
    most_drawn : int, optional
        Largest number of samples at which histories are drawn for the intervals. A longer test is followed
        without new intervals.

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
        most_drawn: int = MOST_DRAWN,
    ) -> None:
        self.structure = whole_structure(structure)
        if not (np.isfinite(time_step) and time_step > 0.0):
            raise InputError("The time step must be positive", value=f"{time_step} s")
        self.time_step = time_step
        self._lag = feedback_lag
        self._stated_offset = sensor_offset
        self._tolerances = tolerances or Tolerances()
        self._seed = seed
        self._most_drawn = most_drawn
        self._damping = Damping.of(self.structure, time_step)
        self._period = 1.0 / (float(self.structure.natural_frequencies[0]) or 1.0)
        self._running = RunningError(
            self.structure, time_step, feedback_lag, self._damping.forgetting, sensor_offset or 0.0
        )
        self._asked = 0
        self._result: RebuiltError | None = None

    @property
    def samples(self) -> int:
        """Samples so far."""
        return self._running.size

    @property
    def error(self) -> Array:
        """x_m − x_I so far, the sensor's offset taken away [m], shape (samples,)."""
        return self._running.error

    @property
    def result(self) -> RebuiltError | None:
        """The last whole rebuilding with its intervals; None before there was one."""
        return self._result

    def feed(self, command: Array, measured: Array) -> None:
        """Add the next samples.

        Parameters
        ----------
        command, measured : numpy.ndarray
            x_c and x_m [m], shape (k,), k ≥ 1.

        Raises
        ------
        InputError
            If the two differ in length or a value is not finite or beyond what a sensor reads.
        """
        self._running.feed(command, measured)

    @property
    def now(self) -> Now:
        """What is known at the last sample.

        Raises
        ------
        InputError
            If there is no sample yet.
        """
        if self._running.size == 0:
            raise InputError("A running test must have a sample", remedy="Pass a sample first")
        square, ends, peak, ideal, error = self._running.sums
        mean = max(square - ends, 0.0) / max(self._running.size - 1, 1)
        return Now(
            samples=self._running.size,
            time=(self._running.size - 1) * self.time_step,
            error=float(error),
            rms=float(np.sqrt(mean) / ideal) if ideal > 0.0 else 0.0,
            mte=float(peak / ideal) if ideal > 0.0 else 0.0,
            damping=self._damping.net(self._running.moments, self._running.motion),
        )

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
        square, ends, peak, ideal, _ = self._running.sums
        if not ideal > _BEYOND_NOISE * level:
            return False
        mean = max((square - ends) / max(self._running.size - 1, 1) - level**2, 0.0)
        size = float(np.sqrt(mean)) if metric is Metric.RMS else max(peak - _LARGEST_NOISE * level, 0.0)
        return bool(size > threshold * ideal)

    @property
    def answerable(self) -> bool:
        """Whether the test is still short enough for intervals."""
        every = samples_in_step_of_structure(self.structure, self.time_step)
        return fits(self._running.size, every, self._most_drawn)

    @property
    def due(self) -> bool:
        """Whether the test has grown so much that intervals are worth computing again."""
        grown = self._running.size - self._asked
        least = max(FEWEST_SAMPLES, int(_PERIODS_BETWEEN * self._period / self.time_step))
        moving = bool(self._running.motion[0] > 0.0)
        return moving and self.answerable and grown >= max(least, int(_GROWTH * self._asked))

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
        self._asked = self._running.size
        self._result = rebuild(
            self._running.command,
            self._running.measured,
            self.time_step,
            self.structure,
            feedback_lag=self._lag,
            sensor_offset=self._stated_offset,
            tolerances=self._tolerances,
            draws=draws,
            seed=self._seed,
        )
        start = self._result.start
        self._running.begin_anew(start.offset, -start.standing)
        return self._result
