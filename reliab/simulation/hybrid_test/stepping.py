"""Effects in a compiled loop: their kernels prepared once, and called one after the other at each instant."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.compiled import compiled
from reliab.core.errors import InputError
from reliab.effects.effect import Effect, Setting, SteppedEffect
from reliab.effects.kernel import call_kernel, pointer_to

STATES = 16
"""Largest state of an effect."""


class Plan(NamedTuple):
    """Kernels that are called one after the other."""

    addresses: NDArray[np.int64]  # Addresses of the kernels, shape (effects,)
    coefficients: Array  # Coefficients of each kernel, shape (effects, longest)


@lru_cache(maxsize=512)
def plan(effects: tuple[Effect, ...], setting: Setting) -> Plan:
    """Prepare effects for a compiled loop, once for all the tests that they act in."""
    stepped = [_require_kernel(effect) for effect in effects]
    rows = [effect.coefficients(setting) for effect in stepped]
    table = np.zeros((len(rows), max((row.size for row in rows), default=1)))
    for place, row in enumerate(rows):
        table[place, : row.size] = row
    return Plan(np.array([effect.kernel.address for effect in stepped], dtype=np.int64), table)


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
    added = 0.0
    for k in range(addresses.size):
        added += call_kernel(
            addresses[k],
            pointer_to(motion, 0),
            time,
            step,
            pointer_to(coefficients, k * coefficients.shape[1]),
            pointer_to(states, (first + k) * states.shape[1]),
        )
    return added
