"""A test with several actuators while it runs: the error of each displacement, and the loop's net damping.

Errors follow sample by sample from the recursion of one actuator with vectors in place of numbers. Intervals
are those of `rebuild_coupled` for the samples so far, from time to time; offsets of the sensors that it finds
are taken from all samples. The test is held whole.
"""

from collections.abc import Iterator, Mapping
from types import MappingProxyType

import numpy as np

from reliab.assessment.coupled_error.coupled_error import CoupledError
from reliab.assessment.coupled_error.rebuild import DRAWS, rebuild_coupled
from reliab.assessment.rebuilt_error.readings import delay_from_sample
from reliab.assessment.rebuilt_error.recursion import Recursion
from reliab.assessment.rebuilt_error.running_test import (
    Now,
    RunningResponse,
    RunningSums,
    RunningTest,
    require_readings,
)
from reliab.assessment.rebuilt_error.tolerances import Tolerances
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.vocabulary import Metric
from reliab.structures.partition import Partition

_RUNNING_DRAWS = 64  # behind the intervals of a running test
_INTERPOLATION_SAMPLES = 4  # samples beyond a lag that its interpolation uses


class CoupledMonitor(RunningTest):
    """Follow the errors of a test with several actuators while it runs.

    `time_step`, `feedback_lag` [s]; `to_interface`: interface displacements of unit displacements of the
    actuators [-], shape (p, p), the identity by default; `recursion`: of the ideal test as the computer steps
    it, exact by default; `metric`: by which the governing displacement is the one with the largest error.

    >>> time = np.arange(0.0, 30.0, 1.0 / 256.0)
    >>> partition = Partition(mass=np.eye(2), damping=0.5 * np.eye(2), stiffness=40.0 * np.eye(2),
    ...                       interface=np.eye(2), specimen_stiffness=40.0 * np.eye(2))
    >>> command = np.minimum(time / 20.0, 1.0) * np.sin(np.sqrt(40.0) * time) * np.ones((2, 1))
    >>> monitor = CoupledMonitor(partition, 1.0 / 256.0)
    >>> for chunk in np.array_split(np.stack([command, command * [[0.99], [1.0]]]), 7, axis=2):
    ...     monitor.feed(*chunk)
    >>> monitor.governing, round(monitor.now.rms, 2)
    ('1', 0.06)
    """

    def __init__(
        self,
        structure: Partition,
        time_step: float,
        *,
        to_interface: Array | None = None,
        feedback_lag: float = 0.0,
        tolerances: Tolerances | None = None,
        recursion: Recursion | None = None,
        metric: Metric = Metric.RMS,
        seed: int = 0,
    ) -> None:
        tolerances = tolerances or Tolerances()
        super().__init__(structure.nonsingular_form, time_step, tolerances.time_shift)
        self._partition, self._lag, self._metric, self._seed = structure, feedback_lag, metric, seed
        self._carry = np.eye(structure.degrees) if to_interface is None else np.asarray(to_interface)
        self._tolerances, self._stated_recursion = tolerances, recursion
        self._recursion = recursion or Recursion.from_displacement(self.structure, time_step)
        self._parts = [np.zeros((2, structure.degrees, 0))]
        self._lows: dict[str, dict[Metric, float]] = {}
        self._judged: tuple[str, ...] = structure.names
        self._begin(np.zeros(structure.degrees), np.zeros(structure.degrees))

    def _begin(self, offsets: Array, standing: Array) -> None:
        """Begin at the first sample with offsets of the sensors and a standing x_c − x_m at each [m]."""
        self._offsets = offsets[:, np.newaxis]
        stands = standing.any()  # else it needs no stiffness that holds it
        state = self._recursion.static @ (self._carry @ standing) if stands else None
        self._response = RunningResponse(self._recursion, state)
        self._sums = {name: RunningSums() for name in self._partition.names}
        self._latest = np.zeros((2, offsets.size, 0))

    @property
    def samples(self) -> int:
        """Samples so far."""
        return sum(part.shape[2] for part in self._parts)

    def feed(self, command: Array, measured_displacement: Array) -> None:
        """Add the next samples of all channels, shape (p, k); `command`, `measured_displacement` [m]."""
        if command.shape != measured_displacement.shape or command.shape[:-1] != (self._partition.degrees,):
            raise InputError(
                f"Commands and measured displacements must be those of {self._partition.degrees} actuators",
                value=f"shapes {command.shape} and {measured_displacement.shape}",
            )
        require_readings(command, measured_displacement)
        self._parts.append(np.stack([command, measured_displacement]))
        self._energy.feed(self._carry @ command, self._carry @ measured_displacement)
        self._follow(command, measured_displacement)

    def _follow(self, command: Array, measured_displacement: Array) -> None:
        """Advance the errors by the next samples."""
        earlier_samples = self._latest.shape[2]
        rows = np.concatenate(
            [self._latest, np.stack([command, measured_displacement - self._offsets])], axis=2
        )
        self._latest = rows[:, :, -(int(self._lag / self.time_step) + _INTERPOLATION_SAMPLES) :]
        delayed_reading = np.stack(
            [delay_from_sample(row, earlier_samples, self._lag, self.time_step) for row in rows[1]]
        )
        ideal = self._carry @ command - self._response.follow(self._carry @ (command - delayed_reading))
        errors = self._carry @ rows[1, :, earlier_samples:] - ideal
        for sums, error, exact in zip(self._sums.values(), errors, ideal, strict=True):
            sums.add(np.ascontiguousarray(error), np.ascontiguousarray(exact))

    @property
    def displacements(self) -> Mapping[str, Now]:
        """What is known of each interface displacement at the last sample, by name."""
        return MappingProxyType({name: self._now(sums) for name, sums in self._sums.items()})

    @property
    def judged(self) -> tuple[str, ...]:
        """Displacements that moved enough for their noise when intervals were last computed."""
        return self._judged

    @property
    def governing(self) -> str:
        """Name of the displacement with the largest error so far."""
        names = self._judged or self._partition.names
        sizes = self.displacements
        return max(names, key=lambda name: sizes[name].size(self._metric) or 0.0)

    @property
    def now(self) -> Now:
        """What is known of the governing displacement at the last sample."""
        if self.samples == 0:
            raise InputError("A running test must have a sample", remedy="Pass a sample first")
        return self.displacements[self.governing]

    @property
    def _calm(self) -> float:
        return self._sums[self.governing].calm * self.time_step

    def _lowest_so_far(self, metric: Metric) -> Iterator[tuple[float, float]]:
        for name in self._judged:
            sums = self._sums[name]
            share = self._lows.get(name, {}).get(metric, 0.0)
            yield sums.calm * self.time_step, share * (self._now(sums).size(metric) or 0.0)

    def ask(self, *, at_end: bool = False) -> CoupledError:
        """Compute the error of the test so far with its intervals, as `rebuild_coupled` finds it.

        At the end it has as many draws as that of a test that is assessed.
        """
        self._parts = [np.concatenate(self._parts, axis=2)]
        command, measured_displacement = self._parts[0]
        error = rebuild_coupled(
            command,
            measured_displacement,
            self.time_step,
            self._partition,
            to_interface=self._carry,
            feedback_lag=self._lag,
            tolerances=self._tolerances,
            recursion=self._stated_recursion,
            draws=DRAWS if at_end else _RUNNING_DRAWS,
            seed=self._seed,
        )
        self._judged = tuple(degree.name for degree in error.judged)
        offsets = np.array([start.offset for start in error.starts])
        standing = np.array([-start.standing for start in error.starts])
        self._begin(offsets, standing)
        self._follow(command, measured_displacement)
        self._conclude_degrees(error)
        return error

    def _conclude_degrees(self, error: CoupledError) -> None:
        self._conclude(error.governing(self._metric))
        so_far = self.displacements
        self._lows = {
            degree.name: {
                metric: degree.estimate(metric).low / (so_far[degree.name].size(metric) or np.inf)
                for metric in Metric
            }
            for degree in error.judged
        }
