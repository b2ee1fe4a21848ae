"""A ground motion that was played with a wrong time step."""

from dataclasses import dataclass

import numpy as np

from reliab.core.arrays import Array
from reliab.core.vocabulary import Block
from reliab.effects.effect import Parameter, RecordEffect, Role


@dataclass(frozen=True, kw_only=True)
class TimeStepError(RecordEffect):
    """The ground acceleration that acted was a_g(t/q): the record was played with q times its time step."""

    name = "time_step_error"
    block = Block.EXCITATION
    role = Role.RECORD
    description = "the ground motion was played with a wrong time step"
    parameters = (
        Parameter(
            name="ratio",
            units="-",
            meaning="time step played over time step recorded",
            signed=True,
            neutral=1.0,
            typical=0.1,
            precise=True,
            lower=0.2,
            upper=5.0,
            starts=(0.9995, 1.0005, 0.996, 1.004, 0.97, 1.03, 0.9, 1.1, 0.5, 2.0),
        ),
    )

    ratio: float  # Ratio q of the time steps [-]

    def applied(self, acceleration: Array, step: float) -> Array:
        """Ground acceleration [m/s²] on the stretched time axis, zero after its end."""
        times = step * np.arange(acceleration.size, dtype=np.float64)
        return np.interp(times / self.ratio, times, acceleration, right=0.0)
