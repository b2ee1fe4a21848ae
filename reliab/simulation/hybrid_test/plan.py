"""Effects prepared for compiled loops: addresses and coefficients."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from reliab.effects import Effect, Setting, SteppedEffect
from reliab.errors import InputError

STATES = 16
"""Largest state of an effect."""


class Plan(NamedTuple):
    """Kernels that are called one after the other."""

    addresses: NDArray[np.int64]  # Addresses of the kernels, shape (effects,)
    coefficients: NDArray[np.float64]  # Coefficients of each kernel, shape (effects, longest)


@lru_cache(maxsize=512)
def plan(effects: tuple[Effect, ...], setting: Setting) -> Plan:
    """Prepare effects for a compiled loop, once for all the tests that they act in."""
    stepped = [_checked(effect) for effect in effects]
    rows = [effect.coefficients(setting) for effect in stepped]
    table = np.zeros((len(rows), max((row.size for row in rows), default=1)))
    for place, row in enumerate(rows):
        table[place, : row.size] = row
    return Plan(np.array([effect.kernel.address for effect in stepped], dtype=np.int64), table)


def _checked(effect: Effect) -> SteppedEffect:
    if not isinstance(effect, SteppedEffect):
        raise InputError(f"An effect with the role {effect.role} needs a kernel", value=effect.name)
    if effect.kernel.states > STATES:
        raise InputError(
            f"The state of an effect holds at most {STATES} numbers",
            value=effect.kernel.states,
            where=effect.name,
        )
    return effect
