"""Histories of a test with several actuators, from which its error is rebuilt."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from reliab.arrays import Array
from reliab.assessment.rebuilt_error.feedback import delayed
from reliab.assessment.rebuilt_error.recursion import Recursion, respond


@dataclass(frozen=True, kw_only=True, eq=False)
class CoupledHistories:
    """Smoothed histories at the sensors, without their offsets."""

    command: Array  # command, measured: At the sensors [m], shape (p, n)
    measured: Array
    carry: Array  # From sensors to the interface [-], shape (p, p)
    feedback_lag: float  # s
    time_step: float  # s
    standing: Array  # At the interface [m], shape (p,)
    recursion: Recursion  # Of the ideal test from sample to sample

    @cached_property
    def difference(self) -> Array:
        """τ at the interface [m], shape (p, n)."""
        return np.asarray(self.carry @ (self.command - self.measured))

    @cached_property
    def fed_back(self) -> Array:
        """Command minus the displacement whose force was fed back, at the interface [m], shape (p, n)."""
        felt = np.stack([delayed(row, self.feedback_lag, self.time_step) for row in self.measured])
        return np.asarray(self.carry @ (self.command - felt))

    @cached_property
    def response(self) -> Array:
        """Answer e of the interface to the test as recorded [m], shape (p, n)."""
        return self.respond(self.recursion, self.fed_back)

    def respond(self, recursion: Recursion, differences: Array) -> Array:
        """Answer e of the interface to τ, which begins where the structure stood [m]."""
        return respond(recursion, differences, recursion.static @ self.standing)
