"""Filters and spectra against SciPy."""

import numpy as np
import pytest
import scipy

from reliab.signals.cubic_path import CubicPath
from reliab.signals.filters import _end_of_line, butterworth_poles, filter_recursively, low_pass
from reliab.signals.spectra import convolve_valid, cross_correlate, hann, periodogram, taper, upper_level


@pytest.fixture
def rng():
    return np.random.default_rng(4)


@pytest.mark.parametrize("size", [9, 256, 1001])
def test_convolution_and_correlation(rng, size):
    history, kernel = rng.normal(size=size), rng.normal(size=8)
    np.testing.assert_array_equal(
        convolve_valid(history, kernel), scipy.signal.fftconvolve(history, kernel, mode="valid")
    )
    second = rng.normal(size=size)
    np.testing.assert_array_equal(
        cross_correlate(history, second), scipy.signal.correlate(history, second, method="fft")
    )


@pytest.mark.parametrize("samples", [2, 3, 4, 5, 300])
@pytest.mark.parametrize("even", [True, False])
def test_a_cubic_path_within_and_beyond_its_samples(rng, samples, even):
    times = np.arange(samples) * 0.01 + (0.0 if even else 1.0) * np.sort(rng.uniform(0.0, 0.004, samples))
    values = rng.normal(size=samples)
    path, spline = CubicPath.interpolate(times, values), scipy.interpolate.CubicSpline(times, values)
    position = np.append(times, rng.uniform(times[0] - 0.01, times[-1] + 0.01, 500))
    for derivative in (0, 1, 2):
        np.testing.assert_allclose(
            path(position, derivative), spline(position, derivative), rtol=1e-12, atol=1e-9
        )


@pytest.mark.parametrize("size", [7, 8, 4096])
def test_windows(size):
    np.testing.assert_array_equal(hann(size), scipy.signal.get_window("hann", size))
    np.testing.assert_array_equal(taper("hann", size), hann(size))
    np.testing.assert_array_equal(taper("boxcar", size), np.ones(size))


@pytest.mark.parametrize("order", range(1, 9))
def test_poles(order):
    np.testing.assert_array_equal(butterworth_poles(order), scipy.signal.buttap(order)[1])


@pytest.mark.parametrize(("edge", "rate"), [(10.0, 1024.0), (33.0, 200.0), (400.0, 1024.0)])
def test_a_low_pass_filter_is_kaisers(edge, rate):
    taps, beta = scipy.signal.kaiserord(60.0, 0.6 * edge / (0.5 * rate))
    expected = scipy.signal.firwin(taps | 1, edge / (0.5 * rate), window=("kaiser", beta))
    np.testing.assert_allclose(low_pass(edge, rate), expected, rtol=0.0, atol=1e-15)


def test_a_recursive_filter(rng):
    values, (numerator, denominator) = rng.normal(size=3000), scipy.signal.butter(2, 0.05)
    expected = scipy.signal.lfilter(numerator, denominator, values)
    np.testing.assert_allclose(filter_recursively(numerator, denominator, values), expected, atol=1e-11)


def test_end_of_a_line_is_from_least_squares():
    values = np.random.default_rng(3).standard_normal(17)
    line = np.polyfit(np.arange(17), values, 1)
    assert _end_of_line(values) == pytest.approx(np.polyval(line, 16))


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
    displacement = long + 50.0 * np.sin(0.1 * np.arange(8192))
    assert upper_level(periodogram(displacement, np.hanning(8192))) == pytest.approx(4.0, rel=0.1)
