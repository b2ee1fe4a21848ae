"""Closed forms on the path of a verdict give what SciPy gives, whose import they spare."""

import numpy as np
import pytest
import scipy

from reliab.signals.cubic_path import CubicPath
from reliab.signals.filters import butterworth_poles, low_pass, recursively_filtered
from reliab.signals.spectra import convolved, correlated, hann, taper


@pytest.fixture
def rng():
    return np.random.default_rng(4)


@pytest.mark.parametrize("size", [9, 256, 1001])
def test_convolution_and_correlation(rng, size):
    history, kernel = rng.normal(size=size), rng.normal(size=8)
    np.testing.assert_array_equal(
        convolved(history, kernel), scipy.signal.fftconvolve(history, kernel, mode="valid")
    )
    other = rng.normal(size=size)
    np.testing.assert_array_equal(
        correlated(history, other), scipy.signal.correlate(history, other, method="fft")
    )


@pytest.mark.parametrize("samples", [2, 3, 4, 5, 300])
@pytest.mark.parametrize("even", [True, False])
def test_a_cubic_path_within_and_beyond_its_samples(rng, samples, even):
    times = np.arange(samples) * 0.01 + (0.0 if even else 1.0) * np.sort(rng.uniform(0.0, 0.004, samples))
    values = rng.normal(size=samples)
    path, spline = CubicPath.through(times, values), scipy.interpolate.CubicSpline(times, values)
    at = np.append(times, rng.uniform(times[0] - 0.01, times[-1] + 0.01, 500))
    for derivative in (0, 1, 2):
        np.testing.assert_allclose(path(at, derivative), spline(at, derivative), rtol=1e-12, atol=1e-9)


@pytest.mark.parametrize("size", [7, 8, 4096])
def test_windows(size):
    np.testing.assert_array_equal(hann(size), scipy.signal.get_window("hann", size))
    np.testing.assert_array_equal(taper("hann", size), hann(size))
    np.testing.assert_array_equal(taper("boxcar", size), np.ones(size))


@pytest.mark.parametrize("order", range(1, 9))
def test_poles(order):
    np.testing.assert_array_equal(butterworth_poles(order), scipy.signal.buttap(order)[1])


@pytest.mark.parametrize(
    ("edge", "rate", "ripple"), [(10.0, 1024.0, 60.0), (33.0, 200.0, 80.0), (400.0, 1024.0, 60.0)]
)
def test_a_low_pass_filter_is_kaisers(edge, rate, ripple):
    taps, beta = scipy.signal.kaiserord(ripple, 0.6 * edge / (0.5 * rate))
    expected = scipy.signal.firwin(taps | 1, edge / (0.5 * rate), window=("kaiser", beta))
    np.testing.assert_allclose(low_pass(edge, rate, ripple), expected, rtol=0.0, atol=1e-15)


def test_a_recursive_filter(rng):
    values, (numerator, denominator) = rng.normal(size=3000), scipy.signal.butter(2, 0.05)
    expected = scipy.signal.lfilter(numerator, denominator, values)
    np.testing.assert_allclose(recursively_filtered(numerator, denominator, values), expected, atol=1e-11)
