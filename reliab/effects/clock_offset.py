"""Channels that were recorded by clocks which differ.

A diagnosis finds these effects. They are no members of the library: no model is changed for them.
"""

from dataclasses import dataclass

from reliab.core.arrays import Array
from reliab.core.vocabulary import Block
from reliab.effects.effect import Parameter, RecordEffect, Role, SteppedEffect
from reliab.effects.kernel import Kernel, Numbers
from reliab.signals.late_reading import record_late

_TIME = (("displacement", 1.0), ("velocity", -1.0))


def _nothing(_motion: Numbers, _time: float, _step: float, _coefficients: Numbers, _state: Numbers) -> float:
    return 0.0


@dataclass(frozen=True, kw_only=True)
class ClockOffset(SteppedEffect):
    """The whole force F(t − τ) in the place of F(t).

    A force that lags the displacement gives energy, which no passive specimen does. One that leads it looks
    like a damper c = kτ with a mass kτ²/2 to second order in ωτ: where the data do not show the mass, neither
    is preferred to the other.
    """

    name = "clock_offset"
    block = Block.SENSOR
    role = Role.FORCE_READING
    description = "force and displacement were recorded by clocks or filters that differ by a time"
    parameters = (
        Parameter(
            name="lag_s", units="s", meaning="time by which the force is recorded later",
            signed=True, typical=0.005, lower=-0.5, upper=0.5, starts=(0.002,),
        ),
    )  # fmt: skip
    kernel = Kernel(function=_nothing)

    lag_s: float  # τ [s], negative where the force is recorded earlier


@dataclass(frozen=True, kw_only=True)
class LeadingReading(SteppedEffect):
    """The displacement x(t + τ) in the place of x(t).

    One that lags cannot be told from the delay of the actuator, which makes up for a part of a lead, too: how
    large it is follows from the stated delay.
    """

    name = "leading_displacement"
    reported_name = "clock_offset"
    block = Block.SENSOR
    role = Role.DISPLACEMENT_READING
    description = "the measured displacement leads the command, which no actuator does: the clocks differ"
    parameters = (
        Parameter(
            name="lead_s", units="s", meaning="time by which the displacement is recorded earlier",
            scale=_TIME, typical=0.03, spread=1.5, lower=1e-4, upper=0.5, starts=(0.02,),
        ),
    )  # fmt: skip
    kernel = Kernel(function=_nothing)

    lead_s: float  # τ [s]


@dataclass(frozen=True, kw_only=True)
class LateGround(RecordEffect):
    """The ground acceleration a_g(t + τ) in the place of a_g(t).

    Unless it is told, a record that is 4 ms late looks like an integration with a numerical damping, and one
    that is 20 ms late like one that was played with another time step.
    """

    name = "late_ground"
    reported_name = "clock_offset"
    block = Block.SENSOR
    role = Role.RECORD
    description = "ground acceleration and command were recorded by clocks or filters that differ by a time"
    parameters = (
        Parameter(
            name="ground_lag_s", units="s", meaning="time by which the ground acceleration is recorded later",
            signed=True, typical=0.005, lower=-0.5, upper=0.5, starts=(0.002, -0.002, 0.02, -0.02),
        ),
    )  # fmt: skip

    ground_lag_s: float  # τ [s], negative where the ground acceleration is recorded earlier

    def applied(self, acceleration: Array, step: float) -> Array:
        """Ground acceleration that acted [m/s²], that of τ later in the record."""
        return record_late(acceleration, -self.ground_lag_s, step)
