"""A(f) and d(f) against actuators whose transfer function is known."""

import numpy as np
import pytest

from reliab.errors import InputError
from reliab.indices.tracking_over_frequency import tracking_over_frequency

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
    with pytest.raises(InputError, match="coherent"):
        tracking_over_frequency(command, noise, STEP)
