"""Time-domain tracking measures against harmonic closed forms."""

import numpy as np
import pytest

from reliab.indices.tracking import (
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
    measured = gain * np.sin(PHASE - lag)
    strayed = np.abs(gain * np.exp(-1j * lag) - 1.0)
    assert maximum_tracking_error(COMMAND, measured) == pytest.approx(strayed, rel=1e-4)
    assert rms_tracking_error(COMMAND, measured) == pytest.approx(strayed, rel=1e-4)
    assert tracking_indicator(COMMAND, measured)[-1] == pytest.approx(
        10 * np.pi * gain * np.sin(lag), rel=1e-4
    )
    indices = phase_amplitude_errors(COMMAND, measured)
    assert indices.phase == pytest.approx(lag, abs=1e-4)
    assert indices.amplitude == pytest.approx(gain - 1.0, abs=1e-6)


def test_lagging_spring_adds_energy():
    """A lag δ adds πkX² sin δ per cycle."""
    measured = np.sin(PHASE - 0.05)
    added = energy_error(COMMAND, measured, 200.0 * measured)
    assert added[-1] == pytest.approx(10 * 200.0 * np.pi * np.sin(0.05), rel=1e-3)


@pytest.mark.parametrize("delay", [-0.0042, 0.0, 0.0007, 0.0133])
def test_cross_correlation_finds_a_fraction_of_a_sample(delay):
    t = np.arange(0.0, 40.0, 0.001)

    def history(t):
        return np.exp(-(((t - 20.0) / 6.0) ** 2)) * np.sin(2 * np.pi * 1.1 * t + 0.02 * t**2)

    found = delay_by_cross_correlation(history(t), history(t - delay), 0.001)
    assert found == pytest.approx(delay, abs=2e-5)
