"""What is diagnosed beside the library: clocks that differ, and a damping that is not the stated one."""

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from reliab.core.arrays import Array
from reliab.core.compiled import compiled
from reliab.core.stated_value import RANGES
from reliab.core.vocabulary import Block
from reliab.effects.effect import Effect, Parameter, RecordEffect, Role, SteppedEffect
from reliab.effects.kernel import Kernel, Numbers
from reliab.effects.viscous_damping import ViscousDamping
from reliab.signals.cubic_path import CubicPath
from reliab.simulation.hybrid_test.model import HybridTest


def _nothing(_motion: Numbers, _time: float, _step: float, _coefficients: Numbers, _state: Numbers) -> float:
    return 0.0


_STRAIGHT: Final = 2.0  # steps
_TIME: Final = (("displacement", 1.0), ("velocity", -1.0))
_LEAST_DAMPING_RATIO = RANGES["damping ratio"].lowest  # a structure has some


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
        return read_late(path_through(acceleration), -self.ground_lag_s / step)


def lag_of(model: HybridTest) -> float:
    """Time by which the clocks of a model record a channel later than the other [s]."""
    late = sum(effect.lag_s for effect in model.effects if isinstance(effect, ClockOffset))
    return late - sum(effect.lead_s for effect in model.effects if isinstance(effect, LeadingReading))


def record_late(values: Array, lag: float, step: float) -> Array:
    """Read a channel at steps [s] so much later [s], shape (n,).

    Beyond its ends it goes on straight for two steps, and keeps that value.
    """
    return read_late(path_through(values), lag / step) if lag else values


def path_through(values: Array) -> Array:
    """Coefficients of the cubic path through a channel, shape (4, n − 1)."""
    return CubicPath.interpolate(np.arange(values.size, dtype=np.float64), values).coefficients


@compiled
def read_late(coefficients: Array, late: float) -> Array:
    """Read a path through samples at 0, 1, …, n − 1 so many steps late, straight beyond its ends."""
    last = coefficients.shape[1]
    values = np.empty(last + 1)
    for place in range(last + 1):
        position = place - late
        inner_position = min(max(position, 0.0), float(last))
        excess = min(max(position - inner_position, -_STRAIGHT), _STRAIGHT)
        knot = min(int(inner_position), last - 1)
        since = inner_position - knot
        cubic, square, slope = coefficients[0, knot], coefficients[1, knot], coefficients[2, knot]
        values[place] = coefficients[3, knot] + since * (slope + since * (square + since * cubic))
        if excess != 0.0:
            values[place] += excess * (slope + since * (2.0 * square + 3.0 * since * cubic))
    return values


@dataclass(frozen=True, kw_only=True)
class StatedDamping(Effect):
    """Damping of the controller's structure beside the stated one, c(1 + Δ) in the place of c.

    In one channel it can hardly be told from a damper in the specimen, nor, where it is negative, from an
    added mass with a gain. Its prior is that of a damper.
    """

    name = "structure_damping"
    block = Block.NUMERICAL
    role = Role.INTEGRATION
    description = "the damping ratio of the structure is not the stated one"
    parameters = ViscousDamping.parameters

    damping_n_s_per_m: float  # Δc [N·s/m]


def apply_damping(model: HybridTest) -> HybridTest:
    """Return a model whose structure has the damping that its effects give it."""
    changes = [effect for effect in model.effects if isinstance(effect, StatedDamping)]
    if not changes or model.structure is None:
        return model
    damping = model.mass * model.substructure.damping
    factor = 1.0 + sum(change.damping_n_s_per_m for change in changes) / damping
    ratio = max(factor * model.structure.damping_ratio, _LEAST_DAMPING_RATIO)
    other_effects = tuple(effect for effect in model.effects if not isinstance(effect, StatedDamping))
    return replace(model, structure=replace(model.structure, damping_ratio=ratio), effects=other_effects)
