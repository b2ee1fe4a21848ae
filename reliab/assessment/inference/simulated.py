"""The error of a test that is simulated anew with its specimen, in one possible world."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from reliab.assessment.inference.channel_spectra import ChannelSpectra
from reliab.assessment.inference.experiment import Experiment
from reliab.core.arrays import Array


@dataclass(frozen=True, kw_only=True, eq=False)
class SimulatedTest:
    """A test with one actuator as it is simulated; solutions are histories, shape (2, 1, m)."""

    channels: ChannelSpectra
    recorded_command: Array  # x_c at the samples of the record [m], shape (n,)
    every: int  # Number of samples of the record of which one is simulated

    @property
    def time_step(self) -> float:
        """Step of the simulation [s]."""
        return self.every * self.channels.band.record_step

    @cached_property
    def command(self) -> Array:
        """x_c at the simulated samples [m], shape (m,)."""
        return np.ascontiguousarray(self.recorded_command[:: self.every])

    @property
    def places(self) -> Array:
        """Numbers of the record's samples between the simulated ones, shape (n,)."""
        return np.arange(self.recorded_command.size) / self.every

    def displacement(self, world: Experiment) -> Array:
        """Return the true displacement at the simulated samples [m], shape (m,)."""
        displacement = self.channels.band.full_history(world.displacement(self.channels))[0]
        standing = float(np.atleast_1d(self.channels.standing)[0])
        return np.ascontiguousarray(displacement[:: self.every] + standing)

    def histories(self, solution: Array) -> Array:
        """x_m − x_I and x_I at the simulated samples [m], shape (2, 1, m)."""
        return solution

    def on_record(self, solution: Array) -> Array:
        """Both at the samples of the record [m], shape (2, 1, n); x_I moves between them like x_c."""
        error, exact = solution[:, 0]
        exact = self.recorded_command - self.interpolate(self.command - exact)
        return np.stack([self.interpolate(error), exact])[:, np.newaxis]

    def interpolate(self, values: Array) -> Array:
        """Values at the simulated samples, shape (m,), at those of the record, shape (n,)."""
        return np.interp(self.places, np.arange(values.size), values)
