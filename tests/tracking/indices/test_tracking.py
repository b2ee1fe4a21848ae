"""Time-domain tracking measures against harmonic closed forms."""

import numpy as np
import pytest

from reliab.tracking.indices.tracking import (
    delay_by_cross_correlation,
    energy_error,
    maximum_tracking_error,
    phase_amplitude_errors,
    rms_tracking_error,
    tracking_indicator,
)

PHASE = np.linspace(0.0, 20.0 * np.pi, 40_001)
COMMAND = np.sin(PHASE)


@pytest.mark.parametrize(("gain", "lag"), [(1.0, 0.05), (0.97, 0.02), (1.03, -0.04)])
def test_harmonic(gain, lag):
    reading = gain * np.sin(PHASE - lag)
    deviation = np.abs(gain * np.exp(-1j * lag) - 1.0)
    assert maximum_tracking_error(COMMAND, reading) == pytest.approx(deviation, rel=1e-4)
    assert rms_tracking_error(COMMAND, reading) == pytest.approx(deviation, rel=1e-4)
    assert tracking_indicator(COMMAND, reading)[-1] == pytest.approx(
        10 * np.pi * gain * np.sin(lag), rel=1e-4
    )
    indices = phase_amplitude_errors(COMMAND, reading)
    assert indices.phase == pytest.approx(lag, abs=1e-4)
    assert indices.amplitude == pytest.approx(gain - 1.0, abs=1e-6)


def test_lagging_spring_adds_energy():
    """A lag δ adds πkX² sin δ per cycle."""
    reading = np.sin(PHASE - 0.05)
    increment = energy_error(COMMAND, reading, 200.0 * reading)
    assert increment[-1] == pytest.approx(10 * 200.0 * np.pi * np.sin(0.05), rel=1e-3)


@pytest.mark.parametrize("delay", [-0.0042, 0.0, 0.0007, 0.0133])
def test_cross_correlation_finds_a_fraction_of_a_sample(delay):
    t = np.arange(0.0, 40.0, 0.001)

    def history(t):
        return np.exp(-(((t - 20.0) / 6.0) ** 2)) * np.sin(2 * np.pi * 1.1 * t + 0.02 * t**2)

    result = delay_by_cross_correlation(history(t), history(t - delay), 0.001)
    assert result == pytest.approx(delay, abs=2e-5)


def test_measures_without_unit_do_not_depend_on_the_unit():
    reading = 0.97 * np.sin(PHASE - 0.03)
    for measure in (maximum_tracking_error, rms_tracking_error, phase_amplitude_errors):
        millimetres, metres = measure(1e3 * COMMAND, 1e3 * reading), measure(COMMAND, reading)
        assert np.asarray(vars_of(millimetres)) == pytest.approx(vars_of(metres), rel=1e-9, abs=1e-12)


def vars_of(index):
    return [index] if isinstance(index, float) else [index.phase, index.amplitude]


def test_areas_and_energies_begin_at_zero_and_add_up_segment_by_segment():
    """A triangle, and a force of 5 N over an error that grows by 2 m."""
    command, reading = np.array([0.0, 1.0, 1.0]), np.array([0.0, 0.0, 3.0])
    assert tracking_indicator(command, reading) == pytest.approx([0.0, 0.0, 1.5])
    assert energy_error(command, reading, np.array([5.0, 5.0, 7.0])) == pytest.approx([0.0, -5.0, 13.0])


def test_exact_actuator_has_no_lag():
    for seed in range(20):
        history = np.random.default_rng(seed).normal(size=50)
        assert phase_amplitude_errors(history, 1.1 * history).phase == pytest.approx(0.0, abs=1e-7)


def test_cross_correlation_of_two_pulses_is_their_distance():
    command, reading = np.zeros(50), np.zeros(50)
    command[10], reading[[16, 17]] = 1.0, [1.0, 0.5]
    # the parabola through 0, 1 and ½ has its top a sixth of a sample after the middle
    assert delay_by_cross_correlation(command, reading, 0.01) == pytest.approx(0.01 * (6 + 1 / 6))
    command, reading = np.zeros(50), np.zeros(50)
    command[0], reading[-1] = 1.0, 1.0
    assert delay_by_cross_correlation(command, reading, 0.01) == pytest.approx(0.49)
