"""The band of a block's input ends where a model no longer explains half of the output."""

from types import SimpleNamespace

import numpy as np
import pytest

from reliab.discrepancy.diagnose import _power_of, highest_informed_frequency
from reliab.discrepancy.segment import Segment

RATE, SIZE, HIGHEST = 256.0, 16384, 45.0
FREQUENCY = np.fft.rfftfreq(SIZE, 1.0 / RATE)
MODEL_FIT = SimpleNamespace(space=None, coordinates=None)


def draw_with_power(power):
    """Signal with a power at each frequency and random phases, without a mean."""
    phases = np.random.default_rng(3).uniform(0.0, 2.0 * np.pi, FREQUENCY.size)
    spectrum = np.sqrt(power) * np.exp(1j * phases)
    spectrum[0] = 0.0
    return np.fft.irfft(spectrum, SIZE)


def problem_of(power, remainder):
    return SimpleNamespace(
        segments=(Segment(test=0, begin=0, end=SIZE, rate=RATE, highest=HIGHEST),),
        measured=lambda _test: power,
        residuals=lambda _fit: {0: remainder},
    )


@pytest.mark.parametrize("crossing", [3.0, 12.0, 30.0])
def test_it_ends_where_half_of_a_falling_spectrum_is_left(crossing):
    power = draw_with_power((1.0 + FREQUENCY) ** -4.0)
    remainder = draw_with_power(np.full(FREQUENCY.size, 0.5 * (1.0 + crossing) ** -4.0))
    assert highest_informed_frequency(problem_of(power, remainder), MODEL_FIT) == pytest.approx(
        crossing, abs=0.3
    )


def test_frequencies_below_the_strongest_motion_do_not_end_it():
    power = draw_with_power(np.exp(-((FREQUENCY - 8.0) ** 2)) + 1e-6)
    remainder = draw_with_power(np.full(FREQUENCY.size, 1e-7))
    left_below = remainder + draw_with_power(np.where(FREQUENCY < 4.0, 1e-3, 0.0))
    assert highest_informed_frequency(problem_of(power, left_below), MODEL_FIT) == HIGHEST


def test_band_ends_at_the_first_remaining_line():
    """Half a hertz below the line, at the first frequency of a grid of 0.1 Hz."""
    power = draw_with_power((1.0 + FREQUENCY) ** -2.0)
    line = np.sin(2.0 * np.pi * 20.0 * np.arange(SIZE) / RATE)
    end = highest_informed_frequency(problem_of(power, line), MODEL_FIT)
    assert 19.5 <= end < 19.6


def test_band_of_a_useless_model_ends_at_the_strongest_motion():
    power = draw_with_power(np.exp(-((FREQUENCY - 8.0) ** 2)) + 1e-6)
    assert highest_informed_frequency(problem_of(power, power), MODEL_FIT) == pytest.approx(8.0, abs=0.5)


def test_power_is_the_mean_within_half_a_hertz_without_zero_frequency():
    segment = Segment(test=0, begin=0, end=640, rate=RATE, highest=HIGHEST)
    values = 5.0 + np.random.default_rng(6).standard_normal(640)
    power = np.abs(np.fft.rfft(values)) ** 2 / 640
    frequency = np.fft.rfftfreq(640, 1.0 / RATE)
    grid = np.array([0.1, 0.5, 3.3, 20.0])
    near = (np.abs(frequency - grid[:, None]) <= 0.5) & (frequency > 0.0)
    reference = [power[these].mean() for these in near]
    np.testing.assert_allclose(_power_of(segment, values, grid), reference, rtol=1e-9)
