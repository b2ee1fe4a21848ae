"""Calibrations simulated by a play, a shift on a finer grid and noise of the tests' own."""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest
import scipy

from reliab.core.errors import InputError
from reliab.core.stated_value import StatedValue
from reliab.recordings.calibration import _Channels, calibrate_channels
from reliab.recordings.recording import Recording

FINER = 8
RATE = 256.0
SAMPLE_MS = 1e3 / RATE


@dataclass(frozen=True, kw_only=True)
class Truth:
    skew_ms: float
    scale: float
    hysteresis: float


def apply_play(motion, half_width):
    reading, value = np.empty_like(motion), motion[0]
    for i, place in enumerate(motion):
        value = min(max(value, place - half_width), place + half_width)
        reading[i] = value
    return reading


def sine(time, rng):
    return np.sin(2.0 * np.pi * rng.uniform(0.5, 3.0) * time) * np.minimum(time, 1.0)


def sweep(time, _rng):
    return np.sin(2.0 * np.pi * (0.1 * time + 2.45 / time[-1] * time**2))


def steps(time, _rng):
    levels = np.array([0, 1, 0, -1, 0, 0.5, 1, 0.5, 0, -0.5, -1, -0.5, 0] * 2)
    time_history = levels[np.minimum((time / time[-1] * levels.size).astype(int), levels.size - 1)]
    window = np.hanning(round(0.15 / time[1]))
    return np.convolve(time_history, window / window.sum(), "same")


def calibration(shape, seed, *, rate=RATE, actuator=None):
    rng = np.random.default_rng(seed)
    time = np.arange(round(rng.uniform(15.0, 30.0) * rate) * FINER) / (rate * FINER)
    amplitude = rng.uniform(0.005, 0.05)
    command = amplitude * shape(time, rng)
    motion = command if actuator is None else actuator(time, command)
    shift = int(rng.integers(-2 * FINER, 2 * FINER + 1))
    truth = Truth(
        skew_ms=1e3 * shift / (rate * FINER),
        scale=1.0 + 0.01 * rng.normal(),
        hysteresis=rng.uniform(0.001, 0.01),
    )
    reading = truth.scale * apply_play(motion, truth.hysteresis * amplitude)
    reading = np.interp(np.arange(time.size) - shift, np.arange(time.size), reading)
    noise = 10.0 ** (-rng.uniform(42.0, 60.0) / 20.0) * command.std()
    size = command[::FINER].size
    return truth, Recording(
        command=command[::FINER] + noise * rng.integers(0, 2) * rng.normal(size=size),
        measured=reading[::FINER] + noise * rng.normal(size=size) + 0.02 * amplitude * rng.normal(),
        time_step=1.0 / rate,
    )


@pytest.mark.default_cases(1)
@pytest.mark.parametrize("shape", [sine, sweep, steps])
def test_skew_scale_and_hysteresis_come_back(shape):
    truth, recording = calibration(shape, seed=3)
    reading = calibrate_channels(recording)
    assert reading.skew_ms.value == pytest.approx(truth.skew_ms, abs=0.1 * SAMPLE_MS)
    assert reading.scale.value == pytest.approx(truth.scale, abs=5e-4)
    assert reading.hysteresis.value == pytest.approx(truth.hysteresis, rel=0.2)


def test_leading_reading_after_fast_motion_is_calibrated():
    """Its last samples belong to a motion after the end, of which nothing is known."""
    truth, recording = calibration(sweep, seed=1010)
    assert truth.skew_ms < -1.5 * SAMPLE_MS
    reading = calibrate_channels(recording)
    assert reading.skew_ms.value == pytest.approx(truth.skew_ms, abs=0.05 * SAMPLE_MS)
    assert reading.hysteresis.value == pytest.approx(truth.hysteresis, rel=0.2)


@pytest.mark.slow
@pytest.mark.parametrize("shape", [sine, sweep])
def test_a_hundred_calibrations(shape):
    errors = []
    for seed in range(100):
        rate = (256.0, 512.0, 1024.0, 2048.0)[seed % 4]
        truth, recording = calibration(shape, seed=1000 + seed, rate=rate)
        reading = calibrate_channels(recording)
        errors.append(
            (
                (reading.skew_ms.value - truth.skew_ms) * 1e-3 * rate / 0.05,
                (reading.scale.value - truth.scale) / 5e-4,
                (reading.hysteresis.value / truth.hysteresis - 1.0) / 0.2,
            )
        )
    assert (np.abs(errors) < 1.0).mean(axis=0) == pytest.approx([1.0, 1.0, 1.0], abs=0.05)


@pytest.mark.slow
def test_steps_of_an_actuator_give_scale_and_hysteresis_but_no_skew():
    omega = 2.0 * np.pi * 8.0

    def actuator(time, command):
        return scipy.signal.lsim(([omega**2], [1.0, 2.0 * omega, omega**2]), command, time)[1]

    truth, recording = calibration(steps, seed=8, actuator=actuator)
    reading = calibrate_channels(recording)
    assert reading.skew_ms is None
    assert "dynamics of the actuator" in reading.notes[0]
    assert reading.scale.value == pytest.approx(truth.scale, abs=5e-4)
    assert abs(reading.hysteresis.value - truth.hysteresis) < 3.0 * reading.hysteresis.deviation


@pytest.mark.slow
def test_restless_lagging_actuator_is_refused():
    def actuator(time, command):
        omega = 2.0 * np.pi * 12.0
        return scipy.signal.lsim(([omega**2], [1.0, 1.2 * omega, omega**2]), command, time)[1]

    _, recording = calibration(sweep, seed=4, actuator=actuator)
    with pytest.raises(InputError, match=r"Feed one signal to both channels, or move in steps"):
        calibrate_channels(recording)


def test_a_locked_actuator_gives_noise_and_resolution():
    rng = np.random.default_rng(7)
    time = np.arange(0.0, 10.0, 1e-3)
    noise = 3e-6 * rng.normal(size=time.size)
    step = 1e-6
    reading = calibrate_channels(
        Recording(command=0.01 * np.sin(time), measured=step * np.round(noise / step), time_step=1e-3)
    )
    assert reading.skew_ms is None
    assert reading.scale is None
    assert reading.resolution_m == pytest.approx(step)
    assert reading.noise_m == pytest.approx(3e-6, rel=0.1)


def test_unrelated_channel_is_refused():
    time = np.arange(0.0, 10.0, 1e-3)
    with pytest.raises(InputError, match="do not record one motion"):
        calibrate_channels(Recording(command=np.sin(time), measured=np.cos(3.0 * time), time_step=1e-3))


@pytest.mark.slow
def test_a_stated_delay_of_the_actuator_is_taken_off_the_lag():
    _, recording = calibration(sweep, seed=5)
    complete = calibrate_channels(recording)
    bare = calibrate_channels(recording, actuator_delay_ms=StatedValue(0.4, 0.3))
    assert bare.skew_ms.value == pytest.approx(complete.skew_ms.value - 0.4)
    assert bare.skew_ms.deviation > 0.3
    assert (len(complete.notes), len(bare.notes)) == (1, 0)


def test_deviations_hold_scatter_bias_and_a_floor_of_estimates_from_stretches():
    random = np.random.default_rng(4)
    estimates = np.array([2e-3, 1.001, 0.01]) + random.normal(size=(8, 3)) * [1e-4, 1e-3, 2e-3]
    samples = iter(estimates)
    channels = SimpleNamespace(
        times=np.arange(800.0), time_step=0.004, _refine=lambda _part, _near: (*next(samples), 0.0)
    )
    complete = np.array([2.1e-3, 1.0, 0.012])
    result = _Channels.deviations(channels, *complete)
    scatter = estimates.std(axis=0, ddof=1) / np.sqrt(8.0)
    bias = (estimates.mean(axis=0) - complete) / (np.sqrt(8.0) - 1.0)
    floor = [0.03 * 0.004, 3e-5, 0.03 * 0.012]
    np.testing.assert_allclose(result, np.sqrt(scatter**2 + bias**2 + np.square(floor)))


@pytest.mark.default_cases(1)
@pytest.mark.parametrize(("length", "slower"), [(1e3, 1.0), (1.0, 4.0)])
def test_units_of_length_and_time_change_nothing_but_the_units(length, slower):
    _, recording = calibration(sweep, seed=3)
    alternative = Recording(
        command=length * recording.command,
        measured=length * recording.measured,
        time_step=slower * recording.time_step,
    )
    once, second = calibrate_channels(recording), calibrate_channels(alternative)
    for result, expected, factor in (
        (second.skew_ms, once.skew_ms, slower),
        (second.scale, once.scale, 1.0),
        (second.hysteresis, once.hysteresis, 1.0),
    ):
        assert result.value == pytest.approx(factor * expected.value, rel=1e-4, abs=1e-6)
        assert result.deviation == pytest.approx(factor * expected.deviation, rel=1e-3)
    assert second.noise_m == pytest.approx(length * once.noise_m, rel=1e-9)
    assert second.command_noise_m == pytest.approx(length * once.command_noise_m, rel=1e-9)
    assert second.notes == once.notes
