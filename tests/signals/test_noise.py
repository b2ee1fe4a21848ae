"""Noise spectra of known processes, and lines of the mains."""

import numpy as np
import pytest
from scipy import signal

from reliab.signals.noise import (
    CORNERS,
    NoiseModel,
    Periodogram,
    fit_noise,
    line_places,
    mains_frequencies,
    near_mains,
    noise_shapes,
)

RATE = 1024.0


def periodogram(values, rate=RATE):
    power = np.abs(np.fft.rfft(values))[1:] ** 2 / values.size
    return Periodogram(frequency=np.fft.rfftfreq(values.size, 1.0 / rate)[1:], power=power)


@pytest.mark.parametrize("memory", [0.0, 0.9, 0.95, 0.98])
def test_spectrum_of_autoregressive_noise(memory):
    random = np.random.default_rng(3)
    runs = [signal.lfilter([1.0], [1.0, -memory], random.normal(size=40_000)) for _ in range(4)]
    result = fit_noise([periodogram(run) for run in runs], RATE)
    frequency = np.geomspace(0.5, 400.0, 40)
    turn = 2.0 * np.pi * frequency / RATE
    expected = 1.0 / (1.0 - 2.0 * memory * np.cos(turn) + memory**2)
    assert np.abs(np.log(result.density(frequency) / expected)).max() < 0.25
    assert result.rms == pytest.approx(1.0 / np.sqrt(1.0 - memory**2), rel=0.05)


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


def test_power_of_known_parts_is_recovered():
    """Without scatter the likelihood is highest at the spectrum itself."""
    frequency = np.arange(1, 4001) * 0.5 * RATE / 4000
    truth = NoiseModel(rate=RATE, weights=np.array([1.0, 0.0, 50.0, 0.0, 0.0, 10.0, 0.0, 0.0]))
    power = truth.density(frequency)
    result = fit_noise([Periodogram(frequency=frequency, power=power)], RATE)
    centre = frequency[20:-20]
    assert result.density(centre) == pytest.approx(truth.density(centre), rel=0.03)
    assert result.rms == pytest.approx(truth.rms, rel=3e-3)


def test_noise_floor_is_never_undercut():
    frequency = np.arange(1, 2001) * 0.5 * RATE / 2000
    result = fit_noise([Periodogram(frequency=frequency, power=np.full(2000, 1e-3))], RATE, least=2.0)
    assert (result.density(frequency) >= 2.0).all()
    assert result.density(frequency).max() < 2.01


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
    result = fit_noise([periodogram(noise + hum)], RATE)
    assert result.rms == pytest.approx(1.0, rel=0.1)


def cut(complete, low, high):
    is_inside = (complete.frequency > low) & (complete.frequency <= high)
    return Periodogram(frequency=complete.frequency[is_inside], power=complete.power[is_inside])


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
    mains_power = [loud.frequency[begin] < 50.01 < loud.frequency[end - 1] for begin, end in places]
    assert any(mains_power) == (band[0] < 50.0 < band[1])
    result = fit_noise([loud], rate).density(loud.frequency)
    assert 0.7 < np.median(result) < 1.5


def test_the_fitted_weights_are_where_the_likelihood_does_not_rise():
    """Of Σ n (ln S + P/S) the slope by a weight vanishes, or falls for a weight that is nothing."""
    frequency = np.linspace(0.5, 127.0, 2000)
    power = np.random.default_rng(3).exponential(size=2000) * (1.0 + 40.0 / (1.0 + (frequency / 4.0) ** 2))
    result = fit_noise([Periodogram(frequency=frequency, power=power)], 256.0)
    shapes = noise_shapes(frequency, 256.0)
    density = result.density(frequency)
    slopes = shapes @ (1.0 / density - power / density**2) / np.sum(shapes / density, axis=1)
    large = result.weights > 0.02 * result.weights.max()
    assert np.abs(slopes[large]).max() < 0.03
    assert slopes.min() > -0.03
    assert result.weights.size == 1 + len(CORNERS)


def test_pickup_lies_within_seven_tenths_of_a_hertz():
    lines = np.array(mains_frequencies(500.0))
    assert near_mains(lines + 0.69, 500.0).all()
    assert near_mains(lines - 0.69, 500.0).all()
    assert not near_mains(lines + 0.71, 500.0).any()
    assert 350.0 in lines
    assert 400.0 not in lines
    assert not near_mains(np.array([4.0]), 10.0).any()


def test_a_line_is_twelve_times_its_surroundings_and_six_tenths_of_a_hertz_wide():
    frequency = 0.1 * np.arange(1, 2001)
    place = 499  # 50 Hz
    for height, count in ((11.0, 0), (13.0, 1)):
        power = np.ones(2000)
        power[place + 5] = height
        result = line_places(Periodogram(frequency=frequency, power=power), 256.0)
        assert len(result) == count
        if count:
            assert frequency[result[0][0]] == pytest.approx(49.5, abs=0.11)
            assert frequency[result[0][1] - 1] == pytest.approx(50.5, abs=0.11)
    neighbour = np.ones(2000)
    neighbour[place + 8] = 100.0
    assert line_places(Periodogram(frequency=frequency, power=neighbour), 256.0) == []
    small_sample = Periodogram(frequency=frequency[:2], power=np.array([1.0, 99.0]))
    assert line_places(small_sample, 256.0) == []
