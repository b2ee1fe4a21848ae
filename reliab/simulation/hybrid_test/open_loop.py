"""Single blocks of a hybrid test: actuator under a command, specimen under a motion, sensors."""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.compiled import compiled
from reliab.core.errors import InputError
from reliab.effects.effect import Effect, Role, Setting, SteppedEffect
from reliab.effects.kernel import Kernel, call_kernel, pointer_to
from reliab.signals.cubic_path import CubicPath
from reliab.simulation.hybrid_test.model import HybridTest

STATES = 40
"""Largest state of an effect."""


class Plan(NamedTuple):
    """Kernels that are called one after the other."""

    addresses: NDArray[np.int64]  # Addresses of the kernels, shape (effects,)
    coefficients: Array  # Coefficients of each kernel, shape (effects, longest)


@lru_cache(maxsize=512)
def plan(effects: tuple[Effect, ...], setting: Setting) -> Plan:
    """Prepare effects for a compiled loop, once for all the tests that they act in."""
    stepped_effects = [_require_kernel(effect) for effect in effects]
    rows = [effect.coefficients(setting) for effect in stepped_effects]
    table = np.zeros((len(rows), max((row.size for row in rows), default=1)))
    for place, row in enumerate(rows):
        table[place, : row.size] = row
    return Plan(np.array([effect.kernel.address for effect in stepped_effects], dtype=np.int64), table)


def _require_kernel(effect: Effect) -> SteppedEffect:
    if not isinstance(effect, SteppedEffect):
        raise InputError(f"An effect with the role {effect.role} needs a kernel", value=effect.name)
    if effect.kernel.states > STATES:
        raise InputError(
            f"The state of an effect holds at most {STATES} numbers",
            value=effect.kernel.states,
            where=effect.name,
        )
    return effect


@compiled
def read_delayed(command: Array, place: float, last: int, motion: Array) -> None:
    """Motion of the command between its samples: cubic in the displacement, linear in the acceleration."""
    if place <= 0.0:
        motion[0] = command[0, 0]
        motion[1] = motion[2] = 0.0
        return
    j = min(int(place), last)
    s = place - j
    x0, v0, v1 = command[0, j], command[1, j], command[1, j + 1]
    rise = command[0, j + 1] - x0
    # x = x₀ + v₀s + (3Δ − 2v₀ − v₁)s² + (v₀ + v₁ − 2Δ)s³
    square, cube = 3.0 * rise - 2.0 * v0 - v1, v0 + v1 - 2.0 * rise
    motion[0] = x0 + s * (v0 + s * (square + s * cube))
    motion[1] = v0 + s * (2.0 * square + 3.0 * s * cube)
    motion[2] = command[2, j] + s * (command[2, j + 1] - command[2, j])


@compiled
def call_all(
    addresses: NDArray[np.int64],
    coefficients: Array,
    states: Array,
    first: int,
    motion: Array,
    time: float,
    step: float,
) -> float:
    """Call kernels one after the other, their states in rows from `first`, and add up what they return."""
    total = 0.0
    for k in range(addresses.size):
        total += call_kernel(
            addresses[k],
            pointer_to(motion, 0),
            time,
            step,
            pointer_to(coefficients, k * coefficients.shape[1]),
            pointer_to(states, (first + k) * states.shape[1]),
        )
    return total


@dataclass(frozen=True, kw_only=True)
class Motion3:
    """Displacement, velocity and acceleration at equal steps."""

    values: Array  # Displacement [m], velocity [m/s] and acceleration [m/s²], shape (3, n)
    step: float  # Step [s]

    @classmethod
    def interpolate(cls, displacement: Array, step: float, *, parts: int = 1) -> "Motion3":
        """Motion along the cubic spline through sampled displacements.

        `displacement` [m]; `step` [s].
        """
        path = CubicPath.interpolate(np.arange(displacement.size) * step, displacement)
        if parts == 1:
            return cls(values=path.read_samples(), step=step)
        times = np.arange((displacement.size - 1) * parts + 1) * (step / parts)
        return cls(values=path.read(times, (0, 1, 2)), step=step / parts)

    @cached_property
    def differences(self) -> Array:
        """Displacement and its derivatives by the number of steps [m], shape (3, n)."""
        return np.ascontiguousarray(self.values * np.array([[1.0], [self.step], [self.step**2]]))

    def thin(self, thinning: int) -> "Motion3":
        """Return the motion at each `thinning`-th instant."""
        return Motion3(values=np.ascontiguousarray(self.values[:, ::thinning]), step=thinning * self.step)


def drive(test: HybridTest, command: Motion3) -> Motion3:
    """Move the piston as the actuator follows a command.

    >>> from reliab.simulation.hybrid_test.model import Actuator
    >>> time = np.arange(0.0, 2.0, 0.001)
    >>> command = Motion3.interpolate(np.sin(time) ** 2, 0.001)
    >>> late = drive(HybridTest(actuator=Actuator(delay=0.25)), command)
    >>> round(float(np.abs(late.values[0, 250:] - command.values[0, :-250]).max()), 9)
    0.0
    """
    h = command.step
    setting = test.setting(h)
    values = _drive(
        command.differences,
        h,
        test.actuator.gain,
        test.actuator.delay,
        *plan(test.acting(Role.DELAY), setting),
        *plan(test.acting(Role.PISTON), setting),
        STATES,
    )
    return Motion3(values=values, step=h)


@compiled
def _drive(
    command: Array,
    step: float,
    gain: float,
    delay: float,
    delays: NDArray[np.int64],
    delay_coefficients: Array,
    elements: NDArray[np.int64],
    element_coefficients: Array,
    states: int,
) -> Array:
    n = command.shape[1]
    out = np.empty((3, n))
    motion = np.zeros(3)
    delay_states = np.zeros((delays.size, states))
    element_states = np.zeros((elements.size, states))
    for i in range(n):
        late = delay
        if delays.size > 0:
            motion[0] = command[0, i]
            motion[1], motion[2] = command[1, i] / step, command[2, i] / step**2
            late += call_all(delays, delay_coefficients, delay_states, 0, motion, i * step, step)
        read_delayed(command, i - late / step, n - 2, motion)
        motion[0] *= gain
        motion[1] *= gain / step
        motion[2] *= gain / step**2
        call_all(elements, element_coefficients, element_states, 0, motion, i * step, step)
        out[0, i], out[1, i], out[2, i] = motion[0], motion[1], motion[2]
    return out


def load(test: HybridTest, piston: Motion3) -> Array:
    """Force of the specimen under a motion of the piston.

    Returns [N].
    """
    if test.specimen is None:
        raise InputError("A force needs a specimen", remedy="Add a [structure] or a [specimen] table")
    setting = test.setting(piston.step)
    linear = np.array([test.specimen.stiffness, test.specimen.damping, test.specimen.mass])
    return np.asarray(linear @ piston.values) + _sum(piston, test, Role.FORCE, setting)


def read_displacement(test: HybridTest, piston: Motion3) -> Array:
    """Displacement as the sensor reads it [m], shape (n,)."""
    read = _sum(piston, test, Role.DISPLACEMENT_READING, test.setting(piston.step))
    return np.asarray(piston.values[0] + read)


def read_force(test: HybridTest, piston: Motion3, force: Array) -> Array:
    """Force as the load cell reads it [N], shape (n,), from the true one."""
    return force + _sum(piston, test, Role.FORCE_READING, test.setting(piston.step))


def follow(kernel: Kernel, coefficients: tuple[float, ...], piston: Motion3) -> Array:
    """Evaluate one kernel along a motion."""
    addresses = np.array([kernel.address], dtype=np.int64)
    values = np.ascontiguousarray(piston.values)
    return np.asarray(_follow(values, piston.step, addresses, np.array([coefficients]), STATES))


def _sum(piston: Motion3, test: HybridTest, role: Role, setting: Setting) -> Array:
    effects = test.acting(role)
    if not effects:
        return np.zeros(piston.values.shape[1])
    return _follow(np.ascontiguousarray(piston.values), piston.step, *plan(effects, setting), STATES)


@compiled
def _follow(
    piston: Array, step: float, addresses: NDArray[np.int64], coefficients: Array, states: int
) -> Array:
    out = np.empty(piston.shape[1])
    motion = np.empty(3)
    state = np.zeros((addresses.size, states))
    for i in range(out.size):
        motion[0], motion[1], motion[2] = piston[0, i], piston[1, i], piston[2, i]
        out[i] = call_all(addresses, coefficients, state, 0, motion, i * step, step)
    return out
