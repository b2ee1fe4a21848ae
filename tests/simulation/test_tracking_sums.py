"""Sums of the tracking index, beside the loop and by its kernel."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import signal

from reliab.simulation.excitation import Excitation
from reliab.simulation.linear_loop.tracking_sums import (
    LANES,
    QuadraturePair,
    TrackedCells,
    _accumulate,
    tracking_sums,
)
from reliab.structures.structure import Structure

TIME = np.arange(0.0, 30.0, 0.01)
RECORD = np.sin(2.0 * np.pi * 0.9 * TIME) * np.exp(-(((TIME - 12.0) / 6.0) ** 2))
GAIN, DELAY = np.array([1.03, 0.97, 1.04, 0.95]), np.array([0.002, 0.03, -0.004, -0.03])
CELLS = TrackedCells(
    structure=Structure(frequency=1.0, damping_ratio=0.05, experimental_fraction=0.6), gain=GAIN, delay=DELAY
)


def sums_of(record, window):
    return tracking_sums(
        QuadraturePair.from_excitation(Excitation(acceleration=record, time_step=0.01, window=window)), CELLS
    )


@pytest.mark.parametrize("window", [(0.0, -1.0), (6.0, 21.0)])
def test_gain_and_delay_of_lags_and_leads_come_back(window):
    sums = sums_of(RECORD, window)
    assert np.abs(sums.cross) / sums.power == pytest.approx(GAIN, rel=2e-3)
    phase = -np.angle(sums.cross)
    assert phase / (2.0 * np.pi * sums.equivalent_frequency) == pytest.approx(DELAY, abs=3e-4)


def test_later_record_has_same_sums_over_later_window():
    """0.7 s of the strongest motion; the taper ends where the window does."""
    early, late = (
        sums_of(RECORD, (11.0, 11.7)),
        sums_of(np.concatenate([np.zeros(700), RECORD]), (18.0, 18.7)),
    )
    np.testing.assert_allclose(late.cross, early.cross, rtol=1e-6)
    np.testing.assert_allclose(late.power, early.power, rtol=1e-6)


def test_a_stiff_structure_is_summed_in_steps_of_its_own_period():
    """The same motion over a time fifteen times shorter has the same gain and phase."""
    shorter = 15.0
    fast = TrackedCells(
        structure=replace(CELLS.structure, frequency=shorter), gain=GAIN, delay=DELAY / shorter
    )
    pairs = [
        QuadraturePair.from_excitation(Excitation(acceleration=RECORD, time_step=step, window=window))
        for step, window in ((0.01, (6.0, 21.0)), (0.01 / shorter, (6.0 / shorter, 21.0 / shorter)))
    ]
    slow, quick = (tracking_sums(pair, cells) for pair, cells in zip(pairs, (CELLS, fast), strict=True))
    np.testing.assert_allclose(quick.cross / quick.power, slow.cross / slow.power, rtol=2e-3)
    np.testing.assert_allclose(quick.equivalent_frequency, shorter * slow.equivalent_frequency, rtol=1e-3)


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
    displacement = []
    for lane in coefficients.T:
        both = [
            signal.lfilter([1.0], [1.0, -pair[0], -pair[1]], pair[2:] @ drives) for pair in lane.reshape(2, 6)
        ]
        displacement.append(np.sum(both, axis=0))
    return np.array(displacement)


def earlier(values, steps):
    return np.concatenate([np.zeros((len(values), steps)), values[:, :-steps]], axis=1)


def test_sums_are_those_of_filtered_histories():
    straight, aside, ahead = RNG.standard_normal((3, 2, SIZE - 1))
    command, reading = pairs_of_poles(), pairs_of_poles()
    taper = np.sin(np.pi * np.arange(WINDOW) / (WINDOW - 1)) ** 2
    result = _accumulate(straight, aside, ahead, taper, BEFORE, command, reading)
    x, q, reach = (
        displacement(command, straight),
        displacement(command, aside),
        displacement(reading, ahead),
    )
    weight = np.zeros(SIZE - 2)
    weight[BEFORE - 2 :] = taper
    rotation = [q * earlier(x, steps) - x * earlier(q, steps) for steps in (1, 2)]
    expected = [reach * x, -reach * q, 0.5 * (x**2 + q**2), 0.5 * rotation[0], 0.5 * rotation[1]]
    for row, history in zip(result, expected, strict=True):
        assert row == pytest.approx(history @ weight, rel=1e-9, abs=1e-9)
