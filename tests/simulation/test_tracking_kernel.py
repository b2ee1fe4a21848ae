"""The compiled sums behind the index, against SciPy's recursive filters."""

import numpy as np
import pytest
from scipy import signal

from reliab.simulation.linear_loop.tracking_sums import LANES, _accumulate

BEFORE, WINDOW = 40, 300
SIZE = BEFORE + WINDOW
RNG = np.random.default_rng(11)


def pairs_of_poles():
    """Coefficients of two stable pairs of poles for each lane, and of what drives them, shape (12, lanes)."""
    rows = []
    for _ in range(2):
        modulus, angle = RNG.uniform(0.5, 0.98, LANES), RNG.uniform(0.1, 1.5, LANES)
        rows += [np.stack([2.0 * modulus * np.cos(angle), -(modulus**2)]), RNG.standard_normal((4, LANES))]
    return np.concatenate(rows)


def displacement(coefficients, edges):
    """Sum of both pairs at the end of each block but the first, shape (lanes, blocks − 1)."""
    drives = np.concatenate([edges[:, 1:], edges[:, :-1]])
    moved = []
    for lane in coefficients.T:
        both = [
            signal.lfilter([1.0], [1.0, -pair[0], -pair[1]], pair[2:] @ drives) for pair in lane.reshape(2, 6)
        ]
        moved.append(np.sum(both, axis=0))
    return np.array(moved)


def earlier(values, steps):
    return np.concatenate([np.zeros((len(values), steps)), values[:, :-steps]], axis=1)


def test_sums_are_those_of_filtered_histories():
    straight, aside, ahead = RNG.standard_normal((3, 2, SIZE - 1))
    command, measured = pairs_of_poles(), pairs_of_poles()
    taper = np.sin(np.pi * np.arange(WINDOW) / (WINDOW - 1)) ** 2
    found = _accumulate(straight, aside, ahead, taper, BEFORE, command, measured)
    x, q, reached = (
        displacement(command, straight),
        displacement(command, aside),
        displacement(measured, ahead),
    )
    weight = np.zeros(SIZE - 2)
    weight[BEFORE - 2 :] = taper
    turned = [q * earlier(x, steps) - x * earlier(q, steps) for steps in (1, 2)]
    expected = [reached * x, -reached * q, 0.5 * (x**2 + q**2), 0.5 * turned[0], 0.5 * turned[1]]
    for row, history in zip(found, expected, strict=True):
        assert row == pytest.approx(history @ weight, rel=1e-9, abs=1e-9)
