"""The motion behind a noisy displacement."""

import numpy as np
import pytest
from scipy import signal

from reliab.discrepancy.segment import smooth_motion
from reliab.signals.noise import _spectra, reliable_frequency

RATE = 1024.0
TIME = np.arange(46080) / RATE


def reading(colour):
    """A displacement with noise 30 dB below it, and its velocity."""
    random = np.random.default_rng(11)
    swing = signal.lfilter([1.0], [1.0, -1.9, 0.95], random.normal(size=800))
    slow = np.interp(TIME, np.linspace(0.0, TIME[-1], 800), swing)
    truth = signal.sosfiltfilt(signal.butter(4, 6.0, fs=RATE, output="sos"), slow)
    noise = signal.lfilter([1.0], [1.0, -colour], random.normal(size=TIME.size))
    return truth + 10.0**-1.5 * truth.std() * noise / noise.std(), np.gradient(truth, 1.0 / RATE)


@pytest.mark.parametrize(("colour", "largest_error"), [(0.0, 0.035), (0.95, 0.11)])
def test_velocity_is_not_made_of_noise(colour, largest_error):
    displacement, velocity = reading(colour)
    remainder = smooth_motion(displacement, 1.0 / RATE, 45.0).values[1] - velocity
    assert remainder.std() < largest_error * velocity.std()


def test_steps_of_a_converter_are_not_taken_for_fast_motion():
    envelope = np.sin(np.pi * TIME / TIME[-1]) ** 2
    slow = envelope * (np.sin(2.0 * np.pi * 0.33 * TIME) + 0.3 * np.sin(2.0 * np.pi * 0.61 * TIME + 1.0))
    step = 0.35 * slow.std()
    result = smooth_motion(step * np.round(slow / step), 1.0 / RATE, 45.0).values
    acceleration = np.gradient(np.gradient(slow, 1.0 / RATE), 1.0 / RATE)
    assert result[2].std() < 1.5 * acceleration.std()


@pytest.mark.parametrize("signal_up_to", [3.0, 8.0])
def test_coloured_noise_is_followed_below_the_signal_free_band(signal_up_to):
    random = np.random.default_rng(12)
    time = np.arange(int(40 * RATE)) / RATE
    band = signal.butter(4, [0.3, signal_up_to], "bandpass", fs=RATE)
    truth = signal.lfilter(*band, random.normal(size=time.size))
    coloured_noise = signal.lfilter([1.0], [1.0, -0.95], random.normal(size=time.size))
    noise = 0.03 * truth.std() * coloured_noise / coloured_noise.std()
    noisy = truth + noise
    _, frequency, _, floor = _spectra(noisy, 1.0 / RATE, 45.0)
    turn = 2.0 * np.pi * frequency / RATE
    variance = (0.03 * truth.std() / coloured_noise.std()) ** 2
    reference = variance / (1.0 - 2.0 * 0.95 * np.cos(turn) + 0.95**2)
    interior = (frequency > 1.0) & (frequency < 45.0)
    ratio = (floor / reference)[interior]
    assert 0.5 < ratio.min() < ratio.max() < 2.0


def test_smoothing_leaves_forces_unattenuated():
    random = np.random.default_rng(8)
    time = np.arange(int(40 * RATE)) / RATE
    truth = signal.lfilter(*signal.butter(2, [0.3, 2.0], "bandpass", fs=RATE), random.normal(size=time.size))
    noise = 0.05 * truth.std() * random.normal(size=time.size)
    result = smooth_motion(truth + noise, 1.0 / RATE, 45.0).values[0]
    slope = (result @ truth) / (result @ result)
    assert slope == pytest.approx(1.0, abs=2e-3)
    inner = slice(1024, -1024)
    assert np.std((result - truth)[inner]) < 0.3 * np.std(noise)
    assert 1.5 < reliable_frequency([truth + noise], 1.0 / RATE, 45.0) < 20.0
