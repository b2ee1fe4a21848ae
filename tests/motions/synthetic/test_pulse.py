"""The velocity pulse against its closed form."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy import integrate

from reliab.motions.synthetic.dabaghi_der_kiureghian_2018 import PulseParameters
from reliab.motions.synthetic.recording import pulse_acceleration

_PULSE = PulseParameters(velocity=0.8, period=2.0, oscillations=2.2, phase=1.0, peak_time=5.0)
_PULSES = st.builds(
    PulseParameters,
    velocity=st.floats(0.1, 2.0),
    period=st.floats(0.4, 10.0),
    oscillations=st.floats(2.0, 3.2),
    phase=st.floats(0.0, 2.0 * np.pi),
    peak_time=st.just(20.0),
)


@given(_PULSES)
def test_pulse_leaves_no_velocity_and_no_displacement(pulse: PulseParameters) -> None:
    step = 0.002
    times = step * np.arange(20_001)
    velocity = integrate.cumulative_trapezoid(pulse_acceleration(pulse, times), times, initial=0.0)
    displacement = integrate.cumulative_trapezoid(velocity, times, initial=0.0)
    # The rule errs by (1/8 + 1/12) h² times the bends of the acceleration where the pulse begins and ends.
    bend = pulse.velocity * (2.0 * np.pi / (pulse.oscillations * pulse.period)) ** 2
    assert velocity[-1] == pytest.approx(0.0, abs=step**2 * bend)
    assert displacement[-1] == pytest.approx(0.0, abs=1e-3 * pulse.velocity * pulse.period)


@given(_PULSES)
def test_ground_rests_outside_the_pulse(pulse: PulseParameters) -> None:
    times = np.array([pulse.start - 0.1, pulse.start, 40.0 - pulse.start, 40.1 - pulse.start])
    assert pulse_acceleration(pulse, times) == pytest.approx(np.zeros(4), abs=1e-9 * pulse.velocity)


def test_velocity_is_the_published_one() -> None:
    times = np.linspace(0.0, 10.0, 100_001)
    velocity = integrate.cumulative_trapezoid(pulse_acceleration(_PULSE, times), times, initial=0.0)
    gamma, period = _PULSE.oscillations, _PULSE.period
    swing = np.sin(_PULSE.phase + gamma * np.pi) - np.sin(_PULSE.phase - gamma * np.pi)
    residual = _PULSE.velocity * period * swing / (4.0 * np.pi * (1.0 - gamma**2))
    time = times - _PULSE.peak_time
    expected = 0.5 * _PULSE.velocity * np.cos(2.0 * np.pi * time / period + _PULSE.phase) - residual / (
        gamma * period
    )
    expected *= 1.0 + np.cos(2.0 * np.pi * time / (gamma * period))
    expected[np.abs(time) > 0.5 * gamma * period] = 0.0
    assert velocity == pytest.approx(expected, abs=1e-6)


def test_pulse_without_phase_peaks_near_its_amplitude() -> None:
    times = np.linspace(0.0, 10.0, 10_001)
    acceleration = pulse_acceleration(replace(_PULSE, phase=0.0), times)
    velocity = integrate.cumulative_trapezoid(acceleration, times, initial=0.0)
    assert velocity.max() == pytest.approx(_PULSE.velocity, rel=0.1)
    assert times[velocity.argmax()] == pytest.approx(_PULSE.peak_time, abs=0.01)
