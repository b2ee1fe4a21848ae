"""A channel read by a clock that is late, between samples too."""

from typing import Final

import numpy as np

from reliab.core.arrays import Array
from reliab.core.compiled import compiled

_STRAIGHT: Final = 2.0  # steps
_NEAREST: Final = 6  # samples
_SAME: Final = 1e-9  # steps


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
