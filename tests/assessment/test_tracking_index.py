"""A and d of simulated tests: the truth comes back, and the intervals cover it."""

import numpy as np
import pytest
from scipy.signal import lfilter

from reliab.assessment.tracking_index import track
from reliab.recordings.recording import Recording
from reliab.tracking.indices.tracking import frequency_evaluation


@pytest.mark.slow
@pytest.mark.default_cases(3)
@pytest.mark.parametrize("f", [0.5, 1.0, 2.0])
@pytest.mark.parametrize(("gain", "delay"), [(0.994, 0.0015), (1.01, 0.0), (1.0, 0.003)])
def test_truth_comes_back_within_the_target_at_40_decibels(simulate, f, gain, delay):
    for motion in (0, 3, 5):
        result = track(simulate(motion, f=f, gain=gain, delay=delay / f, rate=1024.0, seed=motion), draws=50)
        assert result.amplitude == pytest.approx(gain, abs=1e-3)
        assert result.delay == pytest.approx(delay / f, abs=5e-5 / f)


def test_without_noise_gain_and_delay_are_exact_where_the_plain_index_is_not(simulate):
    test = simulate(f=0.25, gain=0.99, delay=0.01, noise=0.0)
    result, plain = track(test, draws=50), frequency_evaluation(test.command, test.measured, test.time_step)
    assert result.amplitude == pytest.approx(0.99, abs=1e-7)
    assert result.delay == pytest.approx(0.01, abs=1e-7)
    assert abs(plain.amplitude - 0.99) > 1e-5


@pytest.mark.slow
def test_noise_of_the_command_biases_neither(simulate):
    errors, plain = [], []
    for seed in range(24):
        test = simulate(
            seed % 6, f=0.5, gain=0.99, delay=0.01, noise=0.01, command_noise=0.01, seed=seed, rate=256.0
        )
        result = track(test, draws=20)
        errors.append((result.amplitude - 0.99, 1e3 * (result.delay - 0.01)))
        raw = frequency_evaluation(test.command, test.measured, test.time_step)
        plain.append(1e3 * (raw.equivalent_delay - 0.01))
    deviation = np.std(errors, axis=0) / np.sqrt(len(errors))
    assert (np.abs(np.mean(errors, axis=0)) < 3.5 * deviation).all()
    assert np.mean(plain) < -3.5 * np.std(plain) / np.sqrt(len(plain))


def test_offsets_of_position_and_sensor_change_nothing(simulate):
    test = simulate()
    size = np.abs(test.command).max()
    displacement = Recording(
        command=test.command + 3.0 * size, measured=test.measured + 2.5 * size, time_step=test.time_step
    )
    plain, shift = (track(item, draws=50) for item in (test, displacement))
    assert shift.amplitude == pytest.approx(plain.amplitude, abs=1e-8)
    assert shift.delay == pytest.approx(plain.delay, abs=1e-9)
    assert shift.noise_share == pytest.approx(plain.noise_share)


def noisy(test, kind, rng):
    """Add noise of 1 % of the RMS: white, of 0.5 s memory, or in proportion to the motion."""
    noise = rng.normal(size=test.command.size)
    if kind == "coloured":
        memory = np.exp(-test.time_step / 0.5)
        noise = np.sqrt(1.0 - memory**2) * lfilter([1.0], [1.0, -memory], noise)
    size = np.sqrt(np.mean(test.measured**2))
    envelope = np.abs(test.measured) / size if kind == "proportional" else 1.0
    return Recording(
        command=test.command,
        measured=test.measured + 0.01 * size * envelope * noise,
        time_step=test.time_step,
    )


def coverage(simulate, kind, repetitions, level):
    rng = np.random.default_rng(40)
    coverage = []
    for number in range(repetitions):
        test = noisy(simulate(number % 6, f=1.0, noise=0.0, rate=256.0), kind, rng)
        (low_a, high_a), (low_d, high_d) = track(test, draws=400, seed=number).interval(level)
        coverage += [low_a <= 0.996 <= high_a, low_d <= 0.0006 <= high_d]
    return np.mean(coverage)


@pytest.mark.slow
@pytest.mark.default_cases(1)
@pytest.mark.parametrize(("kind", "level"), [("white", 0.9), ("coloured", 0.8)])
def test_intervals_cover_the_truth_quick(simulate, kind, level):
    is_covered = coverage(simulate, kind, 40, level)
    assert abs(is_covered - level) < 3.5 * np.sqrt(level * (1.0 - level) / 80)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["white", "coloured", "proportional"])
@pytest.mark.parametrize("level", [0.5, 0.8, 0.95])
def test_intervals_cover_the_truth(simulate, kind, level):
    is_covered = coverage(simulate, kind, 600, level)
    by_chance = 3.5 * np.sqrt(level * (1.0 - level) / 1200)
    wide = 0.0 if kind == "white" else 0.1  # few blocks of coloured noise: intervals err on the wide side
    assert level - by_chance < is_covered < level + by_chance + wide


def test_interval_is_wider_with_more_noise(simulate):
    widths = [np.ptp(track(simulate(noise=noise)).interval(0.95)[1]) for noise in (0.003, 0.01, 0.03)]
    assert widths[0] < widths[1] < widths[2]


def test_friction_is_unexplained_and_noise_is_not(simulate):
    test = simulate(noise=0.003)
    stuck = test.measured + 0.02 * np.abs(test.measured).max() * np.sign(np.gradient(test.measured))
    rough = track(Recording(command=test.command, measured=stuck, time_step=test.time_step), draws=20)
    assert track(test, draws=20).unexplained_share < 0.002
    assert rough.unexplained_share > 0.02
