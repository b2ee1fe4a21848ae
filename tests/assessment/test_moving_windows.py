"""What changes over a test shows in moving windows, and what does not change does not."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from reliab.assessment.tracking_index import track, track_windows
from reliab.recordings.recording import Recording


def changing(test, gain, delay):
    """Replace the measured displacement by the command under a gain and delay that change in time."""
    times = np.arange(test.command.size) * test.time_step
    displacement = gain(times) * CubicSpline(times, test.command)(
        np.clip(times - delay(times), 0.0, times[-1])
    )
    noise = 0.003 * np.sqrt(np.mean(displacement**2)) * np.random.default_rng(3).normal(size=times.size)
    return Recording(command=test.command, measured=displacement + noise, time_step=test.time_step)


@pytest.fixture
def base(simulate):
    return simulate(noise=0.0)


def windows_of(test):
    return track_windows(test, track(test, draws=50))


def test_constant_rig_has_no_range(simulate):
    for motion in range(6):
        result = windows_of(simulate(motion, noise=0.003, seed=motion))
        assert result.delay_range < 1e-4
        assert result.amplitude_range < 5e-4


def test_drifting_delay_is_followed(base):
    duration = base.duration
    test = changing(base, lambda _: 1.0, lambda t: 0.001 + 0.002 * t / duration)
    result = windows_of(test)
    np.testing.assert_allclose(result.delay, 0.001 + 0.002 * result.centre / duration, atol=2e-4)
    assert result.delay_range > 2e-4


def test_change_of_amplitude_shows_in_the_amplitude_only(base):
    half = 0.5 * base.duration
    result = windows_of(changing(base, lambda t: np.where(t < half, 0.99, 1.0), lambda _: 0.001))
    assert result.amplitude_range > 3e-3
    assert result.delay_range < 1e-4


def test_short_test_has_no_windows(base):
    count = int(6.0 / base.time_step)
    short = Recording(
        command=base.command[2000 : 2000 + count],
        measured=base.measured[2000 : 2000 + count],
        time_step=base.time_step,
    )
    result = windows_of(short)
    assert result.centre.size == 0
    assert result.delay_range == 0.0
