"""The frequency-domain evaluation index against what the actuator was made to do."""

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.motions.loading import load_motions
from reliab.simulation.excitation import Excitation
from reliab.simulation.linear_loop import delay_stepper
from reliab.simulation.linear_loop.blocks import cut
from reliab.simulation.linear_loop.tracking_sums import TrackingSums
from reliab.structures.structure import Structure
from reliab.tracking.indices.tracking import evaluate_sums, frequency_evaluation


def evaluate(acceleration, time_step, structure, gain, delay, window="hann"):
    excitation = Excitation(acceleration=acceleration, time_step=time_step)
    blocks = cut(excitation, structure, step=1.0 / 1024.0)
    command, reading = delay_stepper.response(blocks, structure, gain, delay)
    return frequency_evaluation(command, reading, blocks.step, window=window)


@pytest.mark.default_cases(4)
@pytest.mark.parametrize("frequency", [0.25, 1.0, 2.0])
@pytest.mark.parametrize(("gain", "delay"), [(0.99, 0.0), (1.0, 0.001), (1.01, 0.002), (0.97, 0.003)])
def test_index_of_a_loop_returns_gain_and_delay(real_motions_folder, frequency, gain, delay):
    structure = Structure(frequency=frequency, damping_ratio=0.05)
    for motion in load_motions(real_motions_folder)[::12]:
        result = evaluate(motion.acceleration, motion.time_step, structure, gain, delay)
        assert result.amplitude == pytest.approx(gain, abs=1e-3)
        assert result.equivalent_delay == pytest.approx(delay, abs=1e-5)


def test_harmonic_of_known_frequency():
    t = np.arange(0.0, 32.0, 1.0 / 256.0)
    command = np.sin(2 * np.pi * 1.5 * t)
    result = frequency_evaluation(command, 0.9 * np.sin(2 * np.pi * 1.5 * (t - 0.01)), 1.0 / 256.0)
    assert result.equivalent_frequency == pytest.approx(1.5, rel=1e-3)
    assert result.phase == pytest.approx(-2 * np.pi * 1.5 * 0.01, rel=1e-3)


def test_leading_actuator_has_a_negative_delay():
    t = np.arange(0.0, 20.0, 0.001)
    result = frequency_evaluation(np.sin(2 * np.pi * t), np.sin(2 * np.pi * (t + 0.003)), 0.001)
    assert result.equivalent_delay == pytest.approx(-0.003, abs=1e-5)


def test_offset_of_the_sensor_hardly_touches_the_index():
    t = np.arange(0.0, 40.0, 0.005)
    command = np.sin(2 * np.pi * t) * np.exp(-(((t - 15.0) / 8.0) ** 2))
    biased_estimate = frequency_evaluation(command, 0.99 * command + 0.1, 0.005)
    assert biased_estimate.amplitude == pytest.approx(0.99, abs=1e-4)


def test_window_makes_the_end_of_a_stopped_record_harmless():
    t = np.arange(0.0, 10.13, 1.0 / 1024.0)
    command, reading = np.sin(2 * np.pi * t), np.sin(2 * np.pi * (t - 0.005))
    taper_values = frequency_evaluation(command, reading, 1.0 / 1024.0)
    plain = frequency_evaluation(command, reading, 1.0 / 1024.0, window="boxcar")
    assert abs(taper_values.equivalent_delay - 0.005) < 1e-6 < abs(plain.equivalent_delay - 0.005)


@pytest.mark.parametrize(
    ("command", "reading"),
    [(np.ones(100), np.ones(100)), (np.arange(100.0), np.arange(99.0)), (np.arange(4.0), np.arange(4.0))],
)
def test_incomparable_histories_are_refused(command, reading):
    with pytest.raises(InputError, match=r"must|does not move"):
        frequency_evaluation(command, reading, 0.001)


@pytest.mark.parametrize(("samples", "points"), [(16, 16), (17, 32), (32, 32), (33, 64)])
def test_index_is_the_weighted_mean_of_the_ratios_of_transforms(samples, points):
    """Equations (1) to (5) written out, with the transform as a sum."""
    rng = np.random.default_rng(samples)
    command, reading = rng.normal(size=(2, samples))
    step, i = 0.01, np.arange(1, points // 2 + 1)
    turn = np.exp(-2j * np.pi * np.outer(i, np.arange(samples)) / points)
    input_power, out = turn @ command, turn @ reading
    weight = np.abs(input_power) ** 2 / np.sum(np.abs(input_power) ** 2)
    index, frequency = np.sum(weight * out / input_power), np.sum(weight * i / (points * step))
    result = frequency_evaluation(command, reading, step, window="boxcar")
    assert result.amplitude == pytest.approx(abs(index))
    assert result.phase == pytest.approx(np.angle(index))
    assert result.equivalent_frequency == pytest.approx(frequency)
    assert result.equivalent_delay == pytest.approx(-np.angle(index) / (2 * np.pi * frequency))


def test_sums_of_a_gain_and_a_delay_give_them_back():
    power, frequency = np.array([4.0, 0.5]), np.array([1.5, 3.0])
    gain, delay = np.array([0.98, 1.03]), np.array([0.004, -0.002])
    cross = power * gain * np.exp(-2j * np.pi * frequency * delay)
    result = evaluate_sums(TrackingSums(cross=cross, power=power, equivalent_frequency=frequency))
    assert result[0] == pytest.approx(gain)
    assert result[1] == pytest.approx(delay)


def test_fewest_samples():
    history = np.sin(np.arange(16.0))
    assert frequency_evaluation(history, history, 0.1).amplitude == pytest.approx(1.0)
    with pytest.raises(InputError, match="at least 16"):
        frequency_evaluation(history[1:], history[1:], 0.1)
