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
from reliab.simulation.hybrid_test.model import HybridTest


def _nothing(_motion: Numbers, _time: float, _step: float, _coefficients: Numbers, _state: Numbers) -> float:
    return 0.0


_STRAIGHT: Final = 2.0  # steps
_NEAREST: Final = 6  # samples
_SAME: Final = 1e-9  # steps
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
        return record_late(acceleration, -self.ground_lag_s, step)


def lag_of(model: HybridTest) -> float:
    """Time by which the clocks of a model record a channel later than the other [s]."""
    late = sum(effect.lag_s for effect in model.effects if isinstance(effect, ClockOffset))
    return late - sum(effect.lead_s for effect in model.effects if isinstance(effect, LeadingReading))


def record_late(values: Array, lag: float, step: float) -> Array:
    """Read a channel at steps [s] so much later [s], shape (n,).

    Beyond its ends it goes on straight for two steps, and keeps that value.
    """
    return _read_late(values, lag / step) if lag else values


@compiled
def _read_late(values: Array, late: float) -> Array:
    """Read samples so many steps late: between them by Lagrange's polynomial through the nearest ones."""
    last, count = values.size - 1, min(values.size, _NEAREST)
    weights, since = np.zeros(count), np.nan
    out = np.empty(values.size)
    for place in range(values.size):
        position = place - late
        inner_position = min(max(position, 0.0), float(last))
        first = min(max(int(inner_position) - count // 2 + 1, 0), last + 1 - count)
        if not abs(inner_position - first - since) < _SAME:
            since = inner_position - first
            for k in range(count):
                weights[k] = 1.0
                for other in range(count):
                    if other != k:
                        weights[k] *= (since - other) / (k - other)
        total = 0.0
        for k in range(count):
            total += weights[k] * values[first + k]
        excess = min(max(position - inner_position, -_STRAIGHT), _STRAIGHT)
        if excess < 0.0:
            total += excess * (2.0 * values[1] - 1.5 * values[0] - 0.5 * values[2])
        elif excess > 0.0:
            total += excess * (1.5 * values[last] - 2.0 * values[last - 1] + 0.5 * values[last - 2])
        out[place] = total
    return out


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
