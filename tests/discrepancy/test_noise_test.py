"""Noise passes the test of residuals whatever its colour; errors that follow a motion do not."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy import signal

from reliab.discrepancy.fitting.noise_test import share_structured
from reliab.discrepancy.fitting.problem import real_parts
from reliab.discrepancy.segment import Segment
from reliab.signals.noise import Periodogram, fit_noise

RATE, SIZE = 256.0, 8192
TIME = np.arange(SIZE) / RATE


def share_of(values, highest=45.0):
    """Structured share of a residual, whitened by the noise that is fitted to it."""
    segments = [Segment(test=k, begin=0, end=SIZE, rate=RATE, highest=highest) for k in range(len(values))]
    frequency = np.fft.rfftfreq(SIZE, 1.0 / RATE)[1:]
    powers = [np.abs(np.fft.rfft(v))[1:] ** 2 / SIZE for v in values]
    noise = fit_noise([Periodogram(frequency=frequency, power=power) for power in powers], RATE)
    rows = [
        real_parts(s.spectrum(v), np.sqrt(s.density(noise))) for s, v in zip(segments, values, strict=True)
    ]
    problem = SimpleNamespace(segments=segments, block=SimpleNamespace(rate=RATE))
    return share_structured(problem, SimpleNamespace(residual=np.concatenate(rows)))


def noises(memory):
    random = np.random.default_rng(3)
    return [signal.lfilter([1.0], [1.0, -memory], random.normal(size=SIZE)) for _ in range(4)]


@pytest.mark.parametrize("memory", [0.0, 0.9, 0.98])
def test_noise_of_any_colour_passes(memory):
    assert share_of(noises(memory)) < 0.02


def test_noise_passes_though_one_test_is_far_noisier_than_the_others():
    """A load cell in another range: the level is that of each test."""
    assert (
        share_of([size * noise for size, noise in zip((1.0, 1.0, 1.0, 6.0), noises(0.0), strict=True)]) < 0.02
    )


ERRORS = {
    "line": np.sin(2.0 * np.pi * 3.0 * TIME),
    "sweep": signal.chirp(TIME, 0.5, TIME[-1], 20.0),
    "burst": np.sin(2.0 * np.pi * 2.0 * TIME) * np.exp(-(((TIME - 12.0) / 1.5) ** 2)),
    "harmonics": np.sign(np.sin(2.0 * np.pi * 1.3 * TIME)),
}


@pytest.mark.parametrize("error", list(ERRORS))
def test_error_along_the_motion_fails(error):
    assert share_of([3.0 * ERRORS[error] + 0.3 * noise for noise in noises(0.0)]) > 0.05


def test_a_trace_of_an_error_below_the_noise_passes():
    assert share_of([0.02 * ERRORS["sweep"] + noise for noise in noises(0.0)]) < 0.02


@pytest.mark.parametrize(("frequency", "passes"), [(50.0, True), (43.0, False)])
def test_pickup_of_the_mains_is_no_error(frequency, passes):
    line = np.sin(2.0 * np.pi * frequency * TIME)
    assert (share_of([line + noise for noise in noises(0.0)], highest=60.0) < 0.02) == passes
