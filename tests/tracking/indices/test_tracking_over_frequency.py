"""A(f) and d(f) against actuators whose transfer function is known."""

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.tracking.indices.frequency_evaluation import (
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


def lagged(history, time):
    """First-order lag 1/(1 + time·s), in the frequency domain."""
    s = 2j * np.pi * np.fft.rfftfreq(history.size, STEP)
    return np.fft.irfft(np.fft.rfft(history) / (1.0 + time * s), history.size)


def test_a_lag_has_its_own_amplitude_and_delay_at_every_frequency(command):
    found = tracking_over_frequency(command, lagged(command, 0.02), STEP)
    omega = 2.0 * np.pi * found.frequency
    assert found.frequency[-1] > 5.0
    assert found.amplitude == pytest.approx(1.0 / np.sqrt(1.0 + (0.02 * omega) ** 2), abs=2e-3)
    assert found.delay == pytest.approx(np.arctan(0.02 * omega) / omega, abs=2e-4)


def test_standard_deviations_hold_for_their_share_of_draws(command):
    exact, inside = tracking_over_frequency(command, command, STEP), []
    for seed in range(30):
        noise = 5e-5 * np.random.default_rng(seed).standard_normal(command.size)
        found = tracking_over_frequency(command, command + noise, STEP)
        near = np.isin(found.frequency, exact.frequency) & (found.frequency < 4.0)
        inside.append(np.abs(found.delay[near]) < found.delay_deviation[near])
    assert 0.55 < np.concatenate(inside).mean() < 0.8  # 0.683 of a normal distribution


def test_following_gives_back_the_measured_displacement(command):
    measured = lagged(command, 0.004)
    found = tracking_over_frequency(command, measured, STEP)
    error, strayed = found.follow(command, STEP) - measured, measured - command
    inside = slice(2000, -2000)  # the command begins and ends in motion
    assert np.std(error[inside]) < 0.05 * np.std(strayed[inside])


def test_noise_alone_is_refused(command):
    noise = np.random.default_rng(1).standard_normal(command.size)
    with pytest.raises(InputError, match="hardly follows the command"):
        tracking_over_frequency(command, noise, STEP)


@pytest.mark.parametrize(("samples", "spacing"), [(40_000, 1.0 / 8.0), (5_120, 2.5 / 10.0)])
def test_resolution_is_that_of_eight_seconds_or_of_two_fifths_of_a_shorter_test(command, samples, spacing):
    part = command[:samples]
    found = tracking_over_frequency(part, part, STEP)
    assert np.diff(found.frequency).min() == pytest.approx(spacing)


def test_deviations_follow_from_coherence_and_the_number_of_stretches(command):
    """Half-overlapping stretches of 8 s, each worth 1/1.06 of an independent one (Bendat and Piersol)."""
    noise = 3e-5 * np.random.default_rng(0).standard_normal(command.size)
    found = tracking_over_frequency(command, command + noise, STEP)
    stretches = len(range(0, command.size - 4095, 2048)) / 1.06
    relative = np.sqrt((1.0 - found.coherence) / (2.0 * found.coherence * stretches))
    assert found.coherence.min() >= 0.98
    assert found.amplitude_deviation == pytest.approx(found.amplitude * relative, rel=0.03)
    assert found.delay_deviation == pytest.approx(relative / (2.0 * np.pi * found.frequency), rel=0.03)


def test_where_both_sensors_have_their_zero_changes_nothing(command):
    measured, offset = lagged(command, 0.01), np.ptp(command)
    found = tracking_over_frequency(command, measured, STEP)
    shifted = tracking_over_frequency(command + offset, measured + offset, STEP)
    near = (found.frequency > 0.5) & (found.frequency < 3.0)
    assert shifted.interpolate(found.frequency[near])[0] == pytest.approx(found.amplitude[near], abs=5e-4)
    assert shifted.interpolate(found.frequency[near])[1] == pytest.approx(found.delay[near], abs=1e-4)
    assert found.follow(command + offset, STEP) - offset == pytest.approx(
        found.follow(command, STEP), abs=1e-9 * offset
    )


def test_between_known_frequencies_values_are_interpolated_and_beyond_them_held():
    found = TrackingOverFrequency(
        frequency=np.array([1.0, 3.0]),
        amplitude=np.array([0.9, 1.1]),
        delay=np.array([0.01, 0.03]),
        amplitude_deviation=np.zeros(2),
        delay_deviation=np.zeros(2),
        coherence=np.ones(2),
    )
    assert found.interpolate(np.array([0.0, 2.0, -2.0, 9.0]))[0] == pytest.approx([0.9, 1.0, 1.0, 1.1])
    assert found.interpolate(2.0)[1] == pytest.approx(0.02)
    assert [found.covers(frequency) for frequency in (0.99, 1.0, 3.0, 3.01)] == [False, True, True, False]
    assert found.spread == pytest.approx((0.2, 0.02))
    s = 2j * np.pi * np.array([2.0, -2.0])
    assert found.transfer(s) == pytest.approx(np.exp([-0.08j * np.pi, 0.08j * np.pi]))


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
def test_a_history_that_is_advanced_rests_midway_between_its_ends_afterwards(steps):
    history = np.random.default_rng(3).standard_normal(200) + np.linspace(1.0, 9.0, 200)
    advanced = _advance(history, steps * 0.01, 0.01)
    assert advanced[:-steps] == pytest.approx(history[steps:])
    assert advanced[-steps:] == pytest.approx(np.full(steps, 0.5 * (history[0] + history[-1])))
