"""Noise spectra of known processes, the converter's error against Monte Carlo, smoothing against truth."""

import numpy as np
import pytest
from scipy import signal

from reliab.discrepancy.spectra.noise import Periodogram, fit_noise
from reliab.discrepancy.spectra.quantisation import converter_step, expected_error
from reliab.discrepancy.spectra.smoothing import reliable_frequency, smoothed_motion

RATE = 1024.0


def periodogram(values):
    power = np.abs(np.fft.rfft(values))[1:] ** 2 / values.size
    return Periodogram(frequency=np.fft.rfftfreq(values.size, 1.0 / RATE)[1:], power=power)


@pytest.mark.parametrize("memory", [0.0, 0.9, 0.95, 0.98])
def test_spectrum_of_autoregressive_noise(memory):
    random = np.random.default_rng(3)
    runs = [signal.lfilter([1.0], [1.0, -memory], random.normal(size=40_000)) for _ in range(4)]
    found = fit_noise([periodogram(run) for run in runs], RATE)
    frequency = np.geomspace(0.5, 400.0, 40)
    turn = 2.0 * np.pi * frequency / RATE
    expected = 1.0 / (1.0 - 2.0 * memory * np.cos(turn) + memory**2)
    assert np.abs(np.log(found.density(frequency) / expected)).max() < 0.25
    assert found.rms == pytest.approx(1.0 / np.sqrt(1.0 - memory**2), rel=0.05)


def test_lines_of_the_mains_are_left_out():
    time = np.arange(40_000) / RATE
    noise = np.random.default_rng(4).normal(size=time.size)
    hum = 5.0 * np.sin(2.0 * np.pi * 50.01 * time) + 2.0 * np.sin(2.0 * np.pi * 150.03 * time)
    found = fit_noise([periodogram(noise + hum)], RATE)
    assert found.rms == pytest.approx(1.0, rel=0.1)


@pytest.mark.parametrize("spread", [0.0, 0.1, 0.3])
def test_expected_error_of_a_converter_against_simulation(spread):
    step, level = 0.2, 0.05
    signal_values = np.linspace(-0.5, 0.5, 31) + 0.003
    found = expected_error(signal_values, step, spread * step, level)
    noise = spread * step * np.random.default_rng(6).normal(size=(20_000, 1))
    noisy = signal_values + noise
    converted = step * np.round((noisy - level) / step) + level
    np.testing.assert_allclose(found, (converted - signal_values).mean(axis=0), atol=0.02 * step)


def test_much_noise_leaves_nothing_to_correct():
    assert expected_error(np.zeros(3), 1.0, 0.6, 0.0) is None


def test_steps_are_found_where_they_are():
    wave = np.sin(np.linspace(0.0, 60.0, 4000))
    assert converter_step(0.03 * np.round(wave / 0.03)) == pytest.approx(0.03)
    assert converter_step(wave) == 0.0


def test_smoothing_leaves_forces_unattenuated():
    random = np.random.default_rng(8)
    time = np.arange(int(40 * RATE)) / RATE
    truth = signal.lfilter(*signal.butter(2, [0.3, 2.0], "bandpass", fs=RATE), random.normal(size=time.size))
    noise = 0.05 * truth.std() * random.normal(size=time.size)
    found = smoothed_motion(truth + noise, 1.0 / RATE, 45.0).values[0]
    slope = (found @ truth) / (found @ found)
    assert slope == pytest.approx(1.0, abs=2e-3)
    inner = slice(1024, -1024)
    assert np.std((found - truth)[inner]) < 0.3 * np.std(noise)
    assert 1.5 < reliable_frequency([truth + noise], 1.0 / RATE, 45.0) < 20.0
