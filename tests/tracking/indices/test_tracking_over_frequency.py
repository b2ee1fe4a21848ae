"""A(f) and d(f) against actuators whose transfer function is known."""

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.tracking.indices.tracking import (
    TrackingOverFrequency,
    _advance,
    tracking_over_frequency,
)

STEP = 1.0 / 512.0


@pytest.fixture(scope="module")
def command():
    generator = np.random.default_rng(4)
    spectrum = np.fft.rfft(generator.standard_normal(40_000))
    frequency = np.fft.rfftfreq(40_000, STEP)
    resonant = 1.0 / (1.0 - (frequency / 1.5) ** 2 + 0.06j * frequency / 1.5)
    return 1e-3 * np.fft.irfft(spectrum * resonant, 40_000)


def apply_lag(history, time):
    """First-order lag 1/(1 + time·s), in the frequency domain."""
    s = 2j * np.pi * np.fft.rfftfreq(history.size, STEP)
    return np.fft.irfft(np.fft.rfft(history) / (1.0 + time * s), history.size)


def test_a_lag_has_its_own_amplitude_and_delay_at_every_frequency(command):
    result = tracking_over_frequency(command, apply_lag(command, 0.02), STEP)
    omega = 2.0 * np.pi * result.frequency
    assert result.frequency[-1] > 5.0
    assert result.amplitude == pytest.approx(1.0 / np.sqrt(1.0 + (0.02 * omega) ** 2), abs=2e-3)
    assert result.delay == pytest.approx(np.arctan(0.02 * omega) / omega, abs=2e-4)


def test_standard_deviations_hold_for_their_share_of_draws(command):
    exact, is_inside = tracking_over_frequency(command, command, STEP), []
    for seed in range(30):
        noise = 5e-5 * np.random.default_rng(seed).standard_normal(command.size)
        result = tracking_over_frequency(command, command + noise, STEP)
        near = np.isin(result.frequency, exact.frequency) & (result.frequency < 4.0)
        is_inside.append(np.abs(result.delay[near]) < result.delay_deviation[near])
    assert 0.55 < np.concatenate(is_inside).mean() < 0.8  # 0.683 of a normal distribution


def test_following_gives_back_the_measured_displacement(command):
    reading = apply_lag(command, 0.004)
    result = tracking_over_frequency(command, reading, STEP)
    error, deviation = result.follow(command, STEP) - reading, reading - command
    is_inside = slice(2000, -2000)  # the command begins and ends in motion
    assert np.std(error[is_inside]) < 0.05 * np.std(deviation[is_inside])


def test_noise_alone_is_refused(command):
    noise = np.random.default_rng(1).standard_normal(command.size)
    with pytest.raises(InputError, match="hardly follows the command"):
        tracking_over_frequency(command, noise, STEP)


@pytest.mark.parametrize(("samples", "spacing"), [(40_000, 1.0 / 8.0), (5_120, 2.5 / 10.0)])
def test_resolution_is_eight_seconds_or_two_fifths_of_the_test(command, samples, spacing):
    part = command[:samples]
    result = tracking_over_frequency(part, part, STEP)
    assert np.diff(result.frequency).min() == pytest.approx(spacing)


def test_deviations_follow_from_coherence_and_the_number_of_stretches(command):
    """Half-overlapping stretches of 8 s, each worth 1/1.06 of an independent one (Bendat and Piersol)."""
    noise = 3e-5 * np.random.default_rng(0).standard_normal(command.size)
    result = tracking_over_frequency(command, command + noise, STEP)
    stretches = len(range(0, command.size - 4095, 2048)) / 1.06
    relative = np.sqrt((1.0 - result.coherence) / (2.0 * result.coherence * stretches))
    assert result.coherence.min() >= 0.98
    assert result.amplitude_deviation == pytest.approx(result.amplitude * relative, rel=0.03)
    assert result.delay_deviation == pytest.approx(relative / (2.0 * np.pi * result.frequency), rel=0.03)


def test_where_both_sensors_have_their_zero_changes_nothing(command):
    reading, offset = apply_lag(command, 0.01), np.ptp(command)
    result = tracking_over_frequency(command, reading, STEP)
    shift = tracking_over_frequency(command + offset, reading + offset, STEP)
    near = (result.frequency > 0.5) & (result.frequency < 3.0)
    assert shift.interpolate(result.frequency[near])[0] == pytest.approx(result.amplitude[near], abs=5e-4)
    assert shift.interpolate(result.frequency[near])[1] == pytest.approx(result.delay[near], abs=1e-4)
    followed = result.follow(command + offset, STEP) - offset
    np.testing.assert_allclose(followed, result.follow(command, STEP), rtol=0.0, atol=1e-9 * offset)


def test_between_known_frequencies_values_are_interpolated_and_beyond_them_held():
    result = TrackingOverFrequency(
        frequency=np.array([1.0, 3.0]),
        amplitude=np.array([0.9, 1.1]),
        delay=np.array([0.01, 0.03]),
        amplitude_deviation=np.zeros(2),
        delay_deviation=np.zeros(2),
        coherence=np.ones(2),
    )
    assert result.interpolate(np.array([0.0, 2.0, -2.0, 9.0]))[0] == pytest.approx([0.9, 1.0, 1.0, 1.1])
    assert result.interpolate(2.0)[1] == pytest.approx(0.02)
    assert [result.covers(frequency) for frequency in (0.99, 1.0, 3.0, 3.01)] == [False, True, True, False]
    assert result.spread == pytest.approx((0.2, 0.02))
    s = 2j * np.pi * np.array([2.0, -2.0])
    assert result.transfer(s) == pytest.approx(np.exp([-0.08j * np.pi, 0.08j * np.pi]))


def test_only_frequencies_between_the_first_and_the_last_are_known():
    nothing = np.zeros(3)
    tracking = TrackingOverFrequency(
        frequency=np.array([0.5, 1.0, 4.0]),
        amplitude=np.array([1.0, 0.9, 0.8]),
        delay=np.array([0.01, 0.02, 0.03]),
        amplitude_deviation=nothing,
        delay_deviation=nothing,
        coherence=1.0 + nothing,
    )
    assert [tracking.covers(frequency) for frequency in (0.49, 0.5, 2.0, 4.0, 4.01)] == [0, 1, 1, 1, 0]


@pytest.mark.parametrize("steps", [1, 7])
def test_advanced_history_rests_midway_between_its_ends(steps):
    history = np.random.default_rng(3).standard_normal(200) + np.linspace(1.0, 9.0, 200)
    advanced_history = _advance(history, steps * 0.01, 0.01)
    assert advanced_history[:-steps] == pytest.approx(history[steps:])
    assert advanced_history[-steps:] == pytest.approx(np.full(steps, 0.5 * (history[0] + history[-1])))
