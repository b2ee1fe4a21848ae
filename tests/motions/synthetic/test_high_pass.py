"""The high-pass filter and the removal of what a cut leaves."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, strategies as st
from numpy.typing import NDArray

from reliab.motions.synthetic.recording import corner_frequency, high_pass, padding, settle


def _rest(acceleration: NDArray[np.float64], step: float) -> tuple[float, float]:
    """Last velocity and displacement of a ground whose acceleration is linear between samples."""
    velocity = displacement = 0.0
    for start, end in pairwise(acceleration):
        displacement += step * velocity + step**2 * (start / 3.0 + end / 6.0)
        velocity += step * 0.5 * (start + end)
    return velocity, displacement


@pytest.mark.parametrize(("frequencies", "gain"), [(1.0, 0.5**0.5), (5.0, 1.0), (0.2, 1.6e-3)])
def test_gain_is_that_of_a_butterworth_filter(frequencies: float, gain: float) -> None:
    """A sine of so many corner frequencies, with a whole number of cycles in the record."""
    magnitude, count = 7.0, 20_000
    step = 100.0 / corner_frequency(magnitude) / count
    sine = np.sin(2.0 * np.pi * frequencies * corner_frequency(magnitude) * step * np.arange(count))
    assert high_pass(sine, magnitude, step) == pytest.approx(gain * sine, abs=1e-5)


def test_larger_earthquakes_keep_longer_waves() -> None:
    assert corner_frequency(6.5) > corner_frequency(7.5)
    assert padding(6.5, 0.01) < padding(7.5, 0.01)


def test_filter_leaves_no_velocity() -> None:
    magnitude, step = 6.8, 0.01
    quiet = padding(magnitude, step)
    noise = np.random.default_rng(1).standard_normal(3000)
    velocity = np.cumsum(high_pass(np.pad(noise, quiet), magnitude, step)) * step
    assert abs(velocity[-1]) < 1e-4 * np.abs(velocity).max()


@pytest.mark.slow
@given(st.integers(3, 400), st.integers(0, 2**32 - 1))
def test_settled_ground_is_at_rest_where_it_was(count: int, seed: int) -> None:
    acceleration = np.random.default_rng(seed).standard_normal(count)
    velocity, displacement = _rest(settle(acceleration), 0.01)
    assert velocity == pytest.approx(0.0, abs=1e-10)
    assert displacement == pytest.approx(0.0, abs=1e-10)


def test_settling_takes_out_a_straight_line_and_nothing_else() -> None:
    both = np.random.default_rng(2).standard_normal((2, 100))
    difference = both - settle(both)
    assert np.diff(difference, n=2, axis=1) == pytest.approx(np.zeros((2, 98)), abs=1e-12)
    assert settle(settle(both)) == pytest.approx(settle(both), abs=1e-12)
