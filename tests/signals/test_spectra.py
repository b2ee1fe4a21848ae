"""A periodogram by its definition."""

import numpy as np
import pytest

from reliab.signals.spectra import periodogram, upper_level

TAPER = np.hanning(512)
NOISE = np.random.default_rng(8).normal(0.0, 2.0, 512)


def test_it_is_the_sum_over_the_tapered_history():
    times = np.arange(512)
    values = (NOISE - NOISE.mean()) * TAPER
    expected = [abs(np.sum(values * np.exp(-2j * np.pi * k * times / 512))) ** 2 for k in range(1, 257)]
    assert periodogram(NOISE, TAPER) == pytest.approx(np.array(expected) / np.sum(TAPER**2))


def test_a_constant_has_no_power_whatever_the_taper_is():
    assert periodogram(NOISE + 100.0, TAPER) == pytest.approx(periodogram(NOISE, TAPER), rel=1e-6)


def test_the_level_of_noise_is_its_mean_square_though_a_motion_stands_below():
    long = np.random.default_rng(9).normal(0.0, 2.0, 8192)
    moved = long + 50.0 * np.sin(0.1 * np.arange(8192))
    assert upper_level(periodogram(moved, np.hanning(8192))) == pytest.approx(4.0, rel=0.1)
