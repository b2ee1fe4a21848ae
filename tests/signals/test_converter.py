"""Steps of a converter, and what they add, by their definitions and against simulation."""

import numpy as np
import pytest
from scipy.stats import norm

from reliab.signals.noise import converter_step, expect_rounding_error


def test_all_levels_are_whole_steps_apart():
    places = np.array([0, 1, 3, 4, 9, 15, 16, 20])
    reading = np.tile(0.7 + 0.25 * places, 20)
    assert converter_step(reading) == pytest.approx(0.25)
    broken = reading.copy()
    broken[5] += 0.1
    assert converter_step(broken) == 0.0


def test_converters_have_three_levels_and_four_samples_for_each():
    assert converter_step(np.tile([0.0, 0.1, 0.3], 9)) == pytest.approx(0.1)
    assert converter_step(np.tile([0.0, 0.1], 9)) == 0.0
    levels = 0.5 * np.arange(8.0)
    assert converter_step(np.concatenate([levels, np.zeros(25)])) == pytest.approx(0.5)
    assert converter_step(np.concatenate([levels, np.zeros(24)])) == 0.0
    for off, step in ((0.015, 0.5), (0.025, 0.0)):
        shift = np.tile(levels + np.where(levels == 0.5, 0.5 * off, 0.0), 9)
        assert converter_step(shift) == pytest.approx(step, rel=2e-3)


def test_levels_differing_by_rounding_are_one():
    levels = 0.1 * np.arange(10.0)
    reading = np.concatenate([levels, levels * (1.0 + 1e-15), np.tile(levels, 30)])
    assert converter_step(reading) == pytest.approx(0.1)


@pytest.mark.parametrize("spread", [0.0, 0.1, 0.3])
def test_expected_error_of_a_converter_against_simulation(spread):
    step, level = 0.2, 0.05
    signal_values = np.linspace(-0.5, 0.5, 31) + 0.003
    result = expect_rounding_error(signal_values, step, spread * step, level)
    noise = spread * step * np.random.default_rng(6).normal(size=(20_000, 1))
    noisy = signal_values + noise
    conversion = step * np.round((noisy - level) / step) + level
    np.testing.assert_allclose(result, (conversion - signal_values).mean(axis=0), atol=0.02 * step)


def test_much_noise_leaves_nothing_to_correct():
    assert expect_rounding_error(np.zeros(3), 1.0, 0.6, 0.0) is None


def test_steps_are_found_where_they_are():
    wave = np.sin(np.linspace(0.0, 60.0, 4000))
    assert converter_step(0.03 * np.round(wave / 0.03)) == pytest.approx(0.03)
    assert converter_step(wave) == 0.0


@pytest.mark.parametrize("share", [0.03, 0.06, 0.2, 0.449])
def test_the_error_of_a_converter_is_the_mean_over_normal_noise(share):
    """E[round(u + z)] = Σ k (Φ((k + ½ − u)/σ) − Φ((k − ½ − u)/σ))."""
    step, level = 0.2, 0.05
    values = np.linspace(-0.5, 0.5, 23) + 0.003
    turns = (values - level) / step
    k = np.arange(-9.0, 10.0)[:, np.newaxis]
    chance = norm.cdf((k + 0.5 - turns) / share) - norm.cdf((k - 0.5 - turns) / share)
    expected = step * ((k * chance).sum(axis=0) - turns)
    exact = share < 0.05  # there the noise is left out
    assert expect_rounding_error(values, step, share * step, level) == pytest.approx(
        step * (np.round(turns) - turns) if exact else expected, abs=1e-9 if exact else 1e-6
    )


@pytest.mark.parametrize("decimals", [5, 6, 7])
def test_text_rounding_hides_no_step(decimals):
    """12 bits over 0.3 m in a text: 73.2 µm become 70 or 80, 73 or 74, and so on."""
    step = 0.3 / 4096
    motion = 0.1 * np.sin(np.linspace(0.0, 400.0, 16_000)) * np.linspace(0.1, 1.0, 16_000)
    text = np.round(step * np.round(motion / step), decimals)
    expected = pytest.approx(step, rel=1e-3) if decimals > 5 else 0.0  # a grid of 10 µm is not one of 73
    assert converter_step(text) == expected
