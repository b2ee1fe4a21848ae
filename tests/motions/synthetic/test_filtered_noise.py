"""The filtered noise against the sum that defines it, and its statistics."""

import numpy as np
import pytest
from numpy.typing import NDArray

from reliab.motions.synthetic.dabaghi_der_kiureghian_2018 import ComponentParameters
from reliab.motions.synthetic.recording import Modulation, filter_frequency, filter_noise

_STEP = 0.01


def _sum_over_impulses(
    noise: NDArray[np.float64], frequency: NDArray[np.float64], bandwidth: float
) -> NDArray[np.float64]:
    """The definition, one impulse response per column."""
    times = np.arange(noise.size) * _STEP
    lag = times[:, np.newaxis] - times
    omega = 2.0 * np.pi * frequency
    root = np.sqrt(1.0 - bandwidth**2)
    response = omega / root * np.exp(-bandwidth * omega * lag) * np.sin(omega * root * lag)
    response[lag <= 0.0] = 0.0
    power = np.sum(response**2, axis=1)
    power[0] = 1.0
    return np.sum(response * noise, axis=1) / np.sqrt(power)


@pytest.mark.parametrize("bandwidth", [0.03, 0.2, 0.8])
def test_constant_frequency_is_the_sum_over_all_impulses(bandwidth: float) -> None:
    noise = np.random.default_rng(1).standard_normal(1500)
    frequency = np.full(noise.size, 3.0)
    expected = _sum_over_impulses(noise, frequency, bandwidth)
    assert filter_noise(noise, frequency, bandwidth, _STEP) == pytest.approx(expected, abs=1e-4)


@pytest.mark.parametrize("slope", [-0.3, 0.2])
@pytest.mark.parametrize("bandwidth", [0.05, 0.2, 0.8])
def test_wandering_frequency_is_the_sum_but_for_the_staircase(bandwidth: float, slope: float) -> None:
    noise = np.random.default_rng(2).standard_normal(1500)
    frequency = 5.0 + slope * np.arange(noise.size) * _STEP
    expected = _sum_over_impulses(noise, frequency, bandwidth)
    difference = filter_noise(noise, frequency, bandwidth, _STEP) - expected
    assert np.sqrt(np.mean(difference**2)) < 0.05


@pytest.mark.slow
def test_variance_is_one_at_every_time_but_the_first() -> None:
    rng = np.random.default_rng(3)
    frequency = np.linspace(6.0, 2.0, 300)
    ensemble = np.array([filter_noise(rng.standard_normal(300), frequency, 0.2, _STEP) for _ in range(700)])
    assert np.all(ensemble[:, 0] == 0.0)
    assert np.var(ensemble[:, 1:], axis=0) == pytest.approx(np.ones(299), abs=0.25)
    assert np.var(ensemble[:, 1:]) == pytest.approx(1.0, abs=0.03)


def test_noise_crosses_zero_at_the_frequency_of_the_filter() -> None:
    noise = np.random.default_rng(4).standard_normal(100_000)
    process = filter_noise(noise, np.full(noise.size, 2.0), 0.1, _STEP)
    upcrossings = np.sum((process[1:] > 0.0) & (process[:-1] <= 0.0))
    assert upcrossings / (noise.size * _STEP) == pytest.approx(2.0, rel=0.03)


def test_frequency_is_linear_between_its_ends_and_has_a_floor() -> None:
    component = ComponentParameters(
        arias_intensity=1.0,
        strong_duration=10.0,
        onset_duration=2.0,
        rise_duration=5.0,
        frequency=2.0,
        frequency_slope=-0.4,
        bandwidth=0.2,
    )
    modulation = Modulation(peak_time=5.0, peak_share=0.4, growth=3.0, arias_intensity=1.0)
    first, middle, last = (modulation.time_of_share(share) for share in (0.01, 0.3, 0.99))
    frequency = filter_frequency(
        component, modulation, np.array([0.0, first, middle, middle + 1.0, last, 99.0])
    )
    start = 2.0 - 0.4 * (first - middle)
    assert frequency == pytest.approx([start, start, 2.0, 1.6, 0.3, 0.3])
