"""Recordings of the model: noise, filter, modulation and pulse against closed forms and integrals."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given, strategies as st
from numpy.typing import NDArray
from scipy import integrate

from reliab.core.vocabulary import STANDARD_GRAVITY
from reliab.motions.synthetic.dabaghi_der_kiureghian_2018 import (
    NO_PULSE,
    ComponentParameters,
    Mechanism,
    PulseParameters,
    RecordingParameters,
    Scenario,
    physical_parameters,
)
from reliab.motions.synthetic.recording import (
    TIME_STEP,
    Modulation,
    RandomStream,
    corner_frequency,
    filter_frequency,
    filter_noise,
    fit_modulation,
    high_pass,
    padding,
    pulse_acceleration,
    rotate,
    settle,
    simulate_recording,
    trim_quiet_ends,
)
from reliab.motions.synthetic.suite import QUANTUM, StationRecord, draw_errors, simulate_event


@pytest.fixture(scope="module")
def recordings() -> list[StationRecord]:
    return [simulate_event(4, number) for number in range(1, 41)]


def _arias(acceleration: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.pi / (2.0 * STANDARD_GRAVITY) * TIME_STEP * np.cumsum(acceleration**2, axis=-1)


def test_ground_is_at_rest_after_the_motion(recordings: list[StationRecord]) -> None:
    for recording in recordings:
        velocity = integrate.cumulative_trapezoid(recording.components, dx=TIME_STEP, initial=0.0)
        displacement = integrate.cumulative_trapezoid(velocity, dx=TIME_STEP, initial=0.0)
        assert np.abs(velocity[:, -1]).max() < 1e-4 * np.abs(velocity).max()
        assert np.abs(displacement[:, -1]).max() < 1e-2 * np.abs(displacement).max()


def test_baseline_correction_is_below_a_thousandth_of_the_peak(recordings: list[StationRecord]) -> None:
    for recording in recordings:
        ends = np.abs(recording.components[:, [0, -1]]).max()
        assert ends < 0.05 * np.abs(recording.components).max()


def test_accelerations_are_whole_quanta(recordings: list[StationRecord]) -> None:
    counts = recordings[0].components / QUANTUM
    assert counts == pytest.approx(np.round(counts), abs=1e-6)


def test_both_components_without_a_pulse_hold_the_prescribed_intensity(
    recordings: list[StationRecord],
) -> None:
    """The sum over both components does not depend on the orientation of the instrument."""
    for recording in recordings:
        parameters = recording.parameters
        if parameters.pulse is None:
            prescription = parameters.first.arias_intensity + parameters.second.arias_intensity
            assert _arias(recording.components)[:, -1].sum() == pytest.approx(prescription, rel=5e-3)


def test_durations_are_the_prescribed_ones_on_average() -> None:
    """One realisation scatters; the filter and the fit may not bias the median of many by more than 5 %."""
    ratios = []
    for number in range(60):
        parameters = _parameters(number)
        motion = simulate_recording(parameters, 7.0, (RandomStream(8, number), RandomStream(9, number)))
        for component, acceleration in zip((parameters.first, parameters.second), motion, strict=True):
            arrival = _arias(acceleration)
            start, end = np.searchsorted(arrival / arrival[-1], [0.05, 0.95]) * TIME_STEP
            ratios.append((end - start) / component.strong_duration)
    assert np.median(ratios) == pytest.approx(1.0, abs=0.05)


def _parameters(number: int, scenario: Scenario | None = None) -> RecordingParameters:
    means = NO_PULSE.means(scenario or _scenario(7.0, 10.0))
    return draw_errors(
        NO_PULSE, RandomStream(7, number), lambda error: physical_parameters(means + error, pulse_like=False)
    )


def _scenario(magnitude: float, distance: float) -> Scenario:
    return Scenario(
        magnitude=magnitude,
        mechanism=Mechanism.STRIKE_SLIP,
        depth_to_top=0.0,
        rupture_distance=distance,
        shear_wave_velocity=400.0,
        directivity_length=20.0,
        directivity_angle=20.0,
    )


@pytest.mark.default_cases(1)
@pytest.mark.parametrize(
    ("magnitude", "distance", "expected"),
    [(6.5, 10.0, 0.265), (7.0, 10.0, 0.310), (7.0, 25.0, 0.158), (7.5, 10.0, 0.351)],
)
def test_median_peak_agrees_with_the_nga_west2_models(
    magnitude: float, distance: float, expected: float
) -> None:
    """Expected: geometric mean of ASK14, BSSA14, CB14 and CY14 for V_S30 of 400 m/s, strike-slip, in g."""
    peaks = []
    for number in range(60):
        parameters = _parameters(number, _scenario(magnitude, distance))
        noises = RandomStream(8, number), RandomStream(9, number)
        motion = rotate(simulate_recording(parameters, magnitude, noises), number)
        peaks.extend(np.abs(motion).max(axis=1) / STANDARD_GRAVITY)
    assert np.median(peaks) == pytest.approx(expected, rel=0.3)


def test_turning_by_a_right_angle_swaps_the_components() -> None:
    motion = np.random.default_rng(1).standard_normal((2, 5))
    assert rotate(motion, np.pi / 2.0) == pytest.approx(np.stack([motion[1], -motion[0]]))


def test_trimming_takes_the_quiet_time_only() -> None:
    parameters = _parameters(1)
    motion = simulate_recording(parameters, 7.0, (RandomStream(8, 1), RandomStream(9, 1)))
    trimmed_motion = trim_quiet_ends(motion)
    assert trimmed_motion.shape[1] < motion.shape[1]
    assert np.abs(trimmed_motion).max(axis=1) == pytest.approx(np.abs(motion).max(axis=1), rel=1e-3)
    assert _arias(trimmed_motion)[:, -1] == pytest.approx(_arias(motion)[:, -1], rel=5e-3)


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


def _final_state(acceleration: NDArray[np.float64], step: float) -> tuple[float, float]:
    """Last velocity and displacement of a ground whose acceleration is linear between samples."""
    velocity = displacement = 0.0
    for start, end in pairwise(acceleration):
        displacement += step * velocity + step**2 * (start / 3.0 + end / 6.0)
        velocity += step * 0.5 * (start + end)
    return velocity, displacement


@pytest.mark.parametrize(("frequencies", "gain"), [(1.0, 0.5**0.5), (5.0, 1.0), (0.2, 1.6e-3)])
def test_gain_equals_butterworth_filter(frequencies: float, gain: float) -> None:
    """A sine of so many corner frequencies, with a whole number of cycles in the record."""
    magnitude, count = 7.0, 20_000
    step = 100.0 / corner_frequency(magnitude) / count
    sine = np.sin(2.0 * np.pi * frequencies * corner_frequency(magnitude) * step * np.arange(count))
    np.testing.assert_allclose(high_pass(sine, magnitude, step), gain * sine, rtol=0.0, atol=1e-5)


def test_larger_earthquakes_keep_longer_waves() -> None:
    assert corner_frequency(6.5) > corner_frequency(7.5)
    assert padding(6.5, 0.01) < padding(7.5, 0.01)


def test_filter_leaves_no_velocity() -> None:
    magnitude, step = 6.8, 0.01
    quiet = padding(magnitude, step)
    noise = np.random.default_rng(1).standard_normal(3000)
    velocity = np.cumsum(high_pass(np.pad(noise, quiet), magnitude, step)) * step
    assert abs(velocity[-1]) < 1e-4 * np.abs(velocity).max()


@pytest.mark.slow
@given(st.integers(3, 400), st.integers(0, 2**32 - 1))
def test_settled_ground_is_at_rest_where_it_was(count: int, seed: int) -> None:
    acceleration = np.random.default_rng(seed).standard_normal(count)
    velocity, displacement = _final_state(settle(acceleration), 0.01)
    assert velocity == pytest.approx(0.0, abs=1e-10)
    assert displacement == pytest.approx(0.0, abs=1e-10)


def test_settling_takes_out_a_straight_line_and_nothing_else() -> None:
    both = np.random.default_rng(2).standard_normal((2, 100))
    difference = both - settle(both)
    assert np.diff(difference, n=2, axis=1) == pytest.approx(np.zeros((2, 98)), abs=1e-12)
    assert settle(settle(both)) == pytest.approx(settle(both), abs=1e-12)


_SHAPES = st.builds(
    Modulation,
    peak_time=st.floats(0.5, 40.0),
    peak_share=st.floats(0.06, 0.94),
    growth=st.floats(1.0, 20.0),
    arias_intensity=st.floats(0.01, 20.0),
)


def _component(*, onset: float, rise: float, end: float, arias_intensity: float = 1.0) -> ComponentParameters:
    return ComponentParameters(
        arias_intensity=arias_intensity,
        strong_duration=end - onset,
        onset_duration=onset,
        rise_duration=rise,
        frequency=4.0,
        frequency_slope=0.0,
        bandwidth=0.2,
    )


def _durations(shape: Modulation) -> list[float]:
    return [shape.time_of_share(share) for share in (0.05, 0.30, 0.95)]


@given(_SHAPES)
def test_integral_of_the_square_gives_the_intensity_and_its_shares(shape: Modulation) -> None:
    times = np.linspace(0.0, shape.peak_time + 25.0 * shape.decay_time, 400_001)
    density = np.pi / (2.0 * STANDARD_GRAVITY) * shape(times) ** 2
    arrival = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]))]) * times[1]
    assert arrival[-1] == pytest.approx(shape.arias_intensity, rel=1e-3)
    for share in (0.01, 0.05, 0.30, 0.75, 0.95):
        position = np.interp(shape.time_of_share(share), times, arrival)
        assert position == pytest.approx(share * shape.arias_intensity, abs=1e-3 * shape.arias_intensity)


@given(_SHAPES)
def test_fit_finds_a_function_from_its_durations(shape: Modulation) -> None:
    onset, rise, end = _durations(shape)
    fit = fit_modulation(_component(onset=onset, rise=rise, end=end, arias_intensity=shape.arias_intensity))
    assert _durations(fit) == pytest.approx([onset, rise, end], rel=1e-6)
    times = np.linspace(0.0, 2.0 * end, 50)[1:]
    assert fit(times) == pytest.approx(shape(times), rel=1e-3, abs=1e-3 * shape(times).max())


@given(st.floats(0.3, 20.0), st.floats(0.01, 1.2), st.floats(1.5, 18.0))
def test_onset_and_strong_duration_are_kept_whatever_the_rise(
    onset: float, rise: float, ratio: float
) -> None:
    """Also where the three durations do not fit together, as in a D0-30 before D0-5."""
    end = ratio * onset
    fit = fit_modulation(_component(onset=onset, rise=rise * end, end=end))
    first, _, last = _durations(fit)
    assert (first, last) == pytest.approx((onset, end), rel=1e-9)
    assert fit.growth >= 1.0
    assert 0.05 <= fit.peak_share <= 0.95


@given(st.floats(0.3, 20.0), st.floats(1.5, 18.0), st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_later_rise_gives_a_later_rise(onset: float, ratio: float, one: float, other: float) -> None:
    assume(one < other)
    end = ratio * onset
    early, late = (
        fit_modulation(_component(onset=onset, rise=onset + share * (end - onset), end=end))
        for share in (one, other)
    )
    assert _durations(early)[1] <= _durations(late)[1] + 1e-9


def test_total_duration_is_kept_where_the_onset_is_too_early() -> None:
    fit = fit_modulation(_component(onset=0.05, rise=8.0, end=30.0))
    assert fit.growth == 1.0
    assert fit.time_of_share(0.95) == pytest.approx(30.0)


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
    np.testing.assert_allclose(velocity, expected, rtol=0.0, atol=1e-6)


def test_pulse_without_phase_peaks_near_its_amplitude() -> None:
    times = np.linspace(0.0, 10.0, 10_001)
    acceleration = pulse_acceleration(replace(_PULSE, phase=0.0), times)
    velocity = integrate.cumulative_trapezoid(acceleration, times, initial=0.0)
    assert velocity.max() == pytest.approx(_PULSE.velocity, rel=0.1)
    assert times[velocity.argmax()] == pytest.approx(_PULSE.peak_time, abs=0.01)
