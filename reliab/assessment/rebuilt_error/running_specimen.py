"""What a nonlinear specimen with a model adds to the error of a running test, sample by sample.

With the linear specimen Z in the whole structure, what is left of the model's force, N, drives the error as a
force does::

    M e'' + C e' + K e = γ (Z (x_c − x_m) + N[x_I] − N[x_m]),   x_I = x_c − e

The first share is that of a linear test; the second is advanced here by the same exact recursion. Noise of
the sensor would be taken for friction and for cycles of a hysteresis. Therefore N sees of x_m the command
less a parabola that follows x_c − x_m with a fading memory (Morrison 1969, *Introduction to Sequential
Smoothing and Prediction*, ch. 13), as long as the noise, which third differences show, needs for velocities;
of x_c and x_I, which have no noise, derivatives are those of the parabola and the cubic through the latest
samples. N[x_I] at a sample depends on e at that sample: the equation is
solved by secants inside a bracket, of few steps, so that its work is bounded. `rebuild` draws
splines through the whole test and takes noise away in both directions of time, which a running test cannot.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from reliab.assessment.rebuilt_error.recursion import Recursion
from reliab.core.arrays import Array
from reliab.core.compiled import compiled
from reliab.effects.effect import Role
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.hybrid_test.open_loop import STATES, call_all, plan

LONGEST_MEMORY = 0.3
"""Longest memory of the parabola through x_c − x_m, in radians of the lowest mode."""

VELOCITY_NOISE = 1.5e-3
"""Share of the largest velocity so far to which noise of the parabola's velocity is kept."""

FORCE_TRIALS = 8
"""Forces that are tried for each sample."""

EQUATION_TOLERANCE = 1e-15
"""Share of the displacement to which x_I is found."""

SMALLEST_DIVISOR = 1e-12
"""Smallest velocity [m/s] and memory [s] by which is divided."""

SMALLEST_SLOPE = 0.5
"""Smallest slope of the equation of x_I that a secant takes."""


class _Effects(NamedTuple):
    """What the force of a specimen beside its linear one is computed with."""

    addresses: NDArray[np.int64]
    coefficients: Array
    longest: float  # Longest memory of the parabola [s]
    mass: float  # kg
    step: float  # s


class RunningSpecimen:
    """The nonlinear share of the error of a running test.

    `recursion` from a force to the error; `circular_frequency` [rad/s]; `step` [s].
    """

    def __init__(
        self, test: HybridTest, recursion: Recursion, circular_frequency: float, step: float
    ) -> None:
        longest = LONGEST_MEMORY / circular_frequency
        self._effects = _Effects(*plan(test.acting(Role.FORCE), test.setting(step)), longest, test.mass, step)
        self._recursion = recursion
        self.begin()

    def begin(self) -> None:
        """Return to the state before the first sample."""
        self._states = np.zeros((3, self._effects.addresses.size, STATES))
        self._state, self._force = np.zeros(self._recursion.order), np.zeros(1)
        self._past, self._path, self._noise = np.zeros((3, 3)), np.zeros(3), np.zeros(3)

    def follow(self, command: Array, linear: Array, fed_back: Array, first: int) -> Array:
        """Return the nonlinear share of e for the next samples [m].

        `linear`: x_c less the linear share of e; `fed_back`: x_c − x_m of the force that was fed back [m];
        `first`: number of the first of these samples.
        """
        return np.asarray(
            _follow(
                self._recursion.transition,
                self._recursion.early[:, 0],
                self._recursion.late[:, 0],
                self._effects,
                np.ascontiguousarray(command),
                np.ascontiguousarray(linear),
                np.ascontiguousarray(fed_back),
                first,
                self._states,
                self._state,
                self._force,
                self._past,
                self._path,
                self._noise,
            )
        )


@compiled
def _motion_of(now: float, past: Array, step: float, motion: Array) -> None:
    """Displacement, velocity and acceleration through the latest samples, the newest of `past` first."""
    last, previous, first = now - past[0], past[0] - past[1], past[1] - past[2]
    motion[0] = now
    motion[1] = (3.0 * last - previous) / (2.0 * step)
    motion[2] = (2.0 * last - 3.0 * previous + first) / (step * step)


@compiled
def _memory(noise: Array, now: float, past: Array, travel: float, longest: float, step: float) -> float:
    """Weight that a step leaves of the past, after the noise of a sample is counted.

    `noise`: sum of squares of third differences [m²], their number, and largest step of the command [m].
    """
    bend = now - 3.0 * past[0] + 3.0 * past[1] - past[2]
    noise[0] += bend * bend
    noise[1] += 1.0
    noise[2] = max(noise[2], travel)
    # the velocity of a parabola of memory T has the noise of one sample times (h/T³)^½
    deviation = math.sqrt(noise[0] / (20.0 * noise[1]))
    samples = deviation * math.sqrt(step) / max(VELOCITY_NOISE * noise[2] / step, SMALLEST_DIVISOR)
    return math.exp(-step / max(min(math.pow(samples, 2.0 / 3.0), longest), SMALLEST_DIVISOR))


@compiled
def _remember(now: float, past: Array) -> None:
    past[2], past[1], past[0] = past[1], past[0], now


@compiled
def _solve(
    unforced_displacement: float,
    gain: float,
    felt_force: float,
    time: float,
    effects: _Effects,
    states: Array,
    force: Array,
    past: Array,
    motion: Array,
) -> None:
    """Find the force N[x_I] − N[x_m] of x_I = unforced − gain·force, per unit mass, in place."""
    ideal = unforced_displacement - gain * force[0]
    low, high, previous, error_before = -np.inf, np.inf, 0.0, 0.0
    for attempt in range(FORCE_TRIALS):
        states[1] = states[2]
        _motion_of(ideal, past, effects.step, motion)
        resists = call_all(effects.addresses, effects.coefficients, states[1], 0, motion, time, effects.step)
        force[0] = (resists - felt_force) / effects.mass
        error = ideal - unforced_displacement + gain * force[0]
        if error > 0.0:
            high = ideal
        else:
            low = ideal
        slope = 1.0
        if attempt > 0 and ideal != previous:
            slope = max((error - error_before) / (ideal - previous), SMALLEST_SLOPE)
        better = ideal - error / slope
        if abs(better - ideal) <= EQUATION_TOLERANCE * abs(unforced_displacement):
            break
        if not low < better < high and high - low < np.inf:
            better = 0.5 * (low + high)
        previous, error_before, ideal = ideal, error, better


@compiled
def _follow(
    transition: Array,
    early: Array,
    late: Array,
    effects: _Effects,
    command: Array,
    linear: Array,
    fed_back: Array,
    first: int,
    states: Array,
    state: Array,
    force: Array,
    past: Array,
    path: Array,
    noise: Array,
) -> Array:
    """Advance the nonlinear share, in place.

    `states`: of x_m, of x_I, and of x_I before its sample; `past`: of x_c, x_I and x_c − x_m; `path`: of
    x_c − x_m.
    """
    step, motion, advanced = effects.step, np.empty(3), np.zeros(state.size)
    shares = np.empty(linear.size)
    for k in range(linear.size):
        begins = first + k == 0
        if begins:
            past[0, :], past[1, :], past[2, :], path[0] = command[k], linear[k], fed_back[k], fed_back[k]
        else:
            for row in range(state.size):
                advanced[row] = early[row] * force[0]
                for column in range(state.size):
                    advanced[row] += transition[row, column] * state[column]
            path[0] += step * (path[1] + 0.5 * step * path[2])
            path[1] += step * path[2]
        gain = 0.0 if begins else late[0]
        time = (first + k) * step
        memory = _memory(noise, fed_back[k], past[2], abs(command[k] - past[0, 0]), effects.longest, step)
        forgetting, deviation = 1.0 - memory, fed_back[k] - path[0]
        path[0] += (1.0 - memory * memory * memory) * deviation
        path[1] += 1.5 * forgetting * forgetting * (1.0 + memory) / step * deviation
        path[2] += forgetting * forgetting * forgetting / (step * step) * deviation
        _motion_of(command[k], past[0], step, motion)
        motion -= path
        felt_force = call_all(effects.addresses, effects.coefficients, states[0], 0, motion, time, step)
        states[2] = states[1]
        _solve(linear[k] - advanced[0], gain, felt_force, time, effects, states, force, past[1], motion)
        for row in range(state.size):
            state[row] = advanced[row] + (0.0 if begins else late[row] * force[0])
        shares[k] = state[0]
        _remember(command[k], past[0])
        _remember(linear[k] - state[0], past[1])
        _remember(fed_back[k], past[2])
    return shares
