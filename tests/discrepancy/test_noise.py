"""Noise spectra of known processes, the converter's error against Monte Carlo, smoothing against truth."""

import numpy as np
import pytest
from scipy import signal

from reliab.discrepancy.spectra.noise import (
    CORNERS,
    NoiseModel,
    Periodogram,
    fit_noise,
    line_places,
    mains_frequencies,
    near_mains,
)
from reliab.discrepancy.spectra.quantisation import converter_step, expected_error
from reliab.discrepancy.spectra.smoothing import _spectra, reliable_frequency, smoothed_motion

RATE = 1024.0


def periodogram(values, rate=RATE):
    power = np.abs(np.fft.rfft(values))[1:] ** 2 / values.size
    return Periodogram(frequency=np.fft.rfftfreq(values.size, 1.0 / rate)[1:], power=power)


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


@pytest.mark.parametrize("part", range(1 + len(CORNERS)))
def test_each_part_is_white_noise_or_first_order_autoregressive(part):
    """Level at zero frequency w; beyond it w(1 − ρ)²/|1 − ρe^(−iω)|², of variance w(1 − ρ)/(1 + ρ)."""
    weights = np.zeros(1 + len(CORNERS))
    weights[part] = 4.0
    model = NoiseModel(rate=RATE, weights=weights)
    rho = 0.0 if part == 0 else np.exp(-2.0 * np.pi * CORNERS[part - 1] / RATE)
    frequency = np.array([0.0, 0.3, 5.0, 60.0, 0.5 * RATE])
    turn = np.exp(-2j * np.pi * frequency / RATE)
    assert model.density(frequency) == pytest.approx(4.0 * np.abs((1.0 - rho) / (1.0 - rho * turn)) ** 2)
    assert model.rms == pytest.approx(2.0 * np.sqrt((1.0 - rho) / (1.0 + rho)), rel=1e-3)


def test_white_noise_has_its_variance():
    white = NoiseModel.white(RATE, 9.0)
    assert white.density(np.array([1.0, 100.0])) == pytest.approx([9.0, 9.0])
    assert white.rms == pytest.approx(3.0)


def test_a_power_that_is_a_sum_of_the_parts_comes_back():
    """Without scatter the likelihood is highest at the spectrum itself."""
    frequency = np.arange(1, 4001) * 0.5 * RATE / 4000
    truth = NoiseModel(rate=RATE, weights=np.array([1.0, 0.0, 50.0, 0.0, 0.0, 10.0, 0.0, 0.0]))
    power = truth.density(frequency)
    found = fit_noise([Periodogram(frequency=frequency, power=power)], RATE)
    centre = frequency[20:-20]
    assert found.density(centre) == pytest.approx(truth.density(centre), rel=0.03)
    assert found.rms == pytest.approx(truth.rms, rel=3e-3)


def test_noise_that_is_there_in_any_case_is_never_undercut():
    frequency = np.arange(1, 2001) * 0.5 * RATE / 2000
    found = fit_noise([Periodogram(frequency=frequency, power=np.full(2000, 1e-3))], RATE, least=2.0)
    assert (found.density(frequency) >= 2.0).all()
    assert found.density(frequency).max() < 2.01


def test_harmonics_of_the_mains_fold_at_the_nyquist_frequency():
    """At 256 Hz the third of 50 Hz, 150 Hz, appears at 106 Hz; the fifth, 250 Hz, at 6 Hz, too low."""
    expected = [16.0, 44.0, 50.0, 56.0, 60.0, 76.0, 92.0, 94.0, 100.0, 104.0, 106.0, 120.0]
    assert mains_frequencies(128.0) == pytest.approx(expected)
    near = near_mains(np.array([49.2, 49.4, 50.6, 50.8, 30.0]), 128.0)
    assert near.tolist() == [False, True, True, False, False]


def test_lines_of_the_mains_are_left_out():
    time = np.arange(40_000) / RATE
    noise = np.random.default_rng(4).normal(size=time.size)
    hum = 5.0 * np.sin(2.0 * np.pi * 50.01 * time) + 2.0 * np.sin(2.0 * np.pi * 150.03 * time)
    found = fit_noise([periodogram(noise + hum)], RATE)
    assert found.rms == pytest.approx(1.0, rel=0.1)


def cut(whole, low, high):
    inside = (whole.frequency > low) & (whole.frequency <= high)
    return Periodogram(frequency=whole.frequency[inside], power=whole.power[inside])


@pytest.mark.parametrize("rate", [200.0, 512.0, 1024.0, 2048.0])
@pytest.mark.parametrize("band", [(0.0, 45.0), (45.0, np.inf), (30.0, 70.0)])
def test_lines_lie_where_the_mains_fold_whatever_the_band(rate, band):
    """The highest frequency of a band is no Nyquist frequency, nor is its first one zero."""
    time = np.arange(20_000) / rate
    noise = np.random.default_rng(4).normal(size=time.size)
    loud = cut(periodogram(noise + np.sin(2.0 * np.pi * 50.01 * time), rate), *band)
    places = line_places(loud, 0.5 * rate)
    for begin, end in places:
        assert 0 <= begin < end <= loud.power.size
    assert sum(end - begin for begin, end in places) < 0.1 * loud.power.size
    at_mains = [loud.frequency[begin] < 50.01 < loud.frequency[end - 1] for begin, end in places]
    assert any(at_mains) == (band[0] < 50.0 < band[1])
    found = fit_noise([loud], rate).density(loud.frequency)
    assert 0.7 < np.median(found) < 1.5


@pytest.mark.parametrize("signal_up_to", [3.0, 8.0])
def test_coloured_noise_is_followed_below_the_signal_free_band(signal_up_to):
    random = np.random.default_rng(12)
    time = np.arange(int(40 * RATE)) / RATE
    band = signal.butter(4, [0.3, signal_up_to], "bandpass", fs=RATE)
    truth = signal.lfilter(*band, random.normal(size=time.size))
    coloured = signal.lfilter([1.0], [1.0, -0.95], random.normal(size=time.size))
    noise = 0.03 * truth.std() * coloured / coloured.std()
    moved = truth + noise
    _, frequency, _, floor = _spectra(moved, 1.0 / RATE, 45.0)
    turn = 2.0 * np.pi * frequency / RATE
    variance = (0.03 * truth.std() / coloured.std()) ** 2
    expected = variance / (1.0 - 2.0 * 0.95 * np.cos(turn) + 0.95**2)
    inside = (frequency > 1.0) & (frequency < 45.0)
    ratio = (floor / expected)[inside]
    assert 0.5 < ratio.min() < ratio.max() < 2.0


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
