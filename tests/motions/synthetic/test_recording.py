"""Whole recordings: intensity, duration, rest, and agreement with independent ground-motion models."""

from itertools import islice

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import integrate

from reliab.core.vocabulary import STANDARD_GRAVITY
from reliab.motions.synthetic.dabaghi_der_kiureghian_2018 import (
    NO_PULSE,
    Mechanism,
    RecordingParameters,
    Scenario,
    physical_parameters,
)
from reliab.motions.synthetic.random_stream import RandomStream
from reliab.motions.synthetic.recording import TIME_STEP, simulate_recording, trim_quiet_ends, turned
from reliab.motions.synthetic.suite import QUANTUM, EventErrors, Recording, simulate_event


@pytest.fixture(scope="module")
def recordings() -> list[Recording]:
    return [next(simulate_event(4, number)) for number in range(1, 41)]


def _arias(acceleration: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.pi / (2.0 * STANDARD_GRAVITY) * TIME_STEP * np.cumsum(acceleration**2, axis=-1)


def test_ground_is_at_rest_after_the_motion(recordings: list[Recording]) -> None:
    for recording in recordings:
        velocity = integrate.cumulative_trapezoid(recording.components, dx=TIME_STEP, initial=0.0)
        displacement = integrate.cumulative_trapezoid(velocity, dx=TIME_STEP, initial=0.0)
        assert np.abs(velocity[:, -1]).max() < 1e-4 * np.abs(velocity).max()
        assert np.abs(displacement[:, -1]).max() < 1e-2 * np.abs(displacement).max()


def test_baseline_correction_is_below_a_thousandth_of_the_peak(recordings: list[Recording]) -> None:
    for recording in recordings:
        ends = np.abs(recording.components[:, [0, -1]]).max()
        assert ends < 0.05 * np.abs(recording.components).max()


def test_accelerations_are_whole_quanta(recordings: list[Recording]) -> None:
    counts = recordings[0].components / QUANTUM
    assert counts == pytest.approx(np.round(counts), abs=1e-6)


def test_both_components_without_a_pulse_hold_the_prescribed_intensity(recordings: list[Recording]) -> None:
    """The sum over both components does not depend on the orientation of the instrument."""
    for recording in recordings:
        parameters = recording.parameters
        if parameters.pulse is None:
            prescribed = parameters.first.arias_intensity + parameters.second.arias_intensity
            assert _arias(recording.components)[:, -1].sum() == pytest.approx(prescribed, rel=5e-3)


def test_durations_are_the_prescribed_ones_on_average() -> None:
    """One realisation scatters; the filter and the fit may not bias the median of many by more than 5 %."""
    ratios = []
    for number in range(60):
        parameters = _parameters(number)
        motion = simulate_recording(parameters, 7.0, (RandomStream(8, number), RandomStream(9, number)))
        for component, acceleration in zip((parameters.first, parameters.second), motion, strict=True):
            arrived = _arias(acceleration)
            start, end = np.searchsorted(arrived / arrived[-1], [0.05, 0.95]) * TIME_STEP
            ratios.append((end - start) / component.strong_duration)
    assert np.median(ratios) == pytest.approx(1.0, abs=0.05)


def _parameters(number: int, scenario: Scenario | None = None) -> RecordingParameters:
    means = NO_PULSE.means(scenario or _scenario(7.0, 10.0))
    return EventErrors(NO_PULSE, RandomStream(6, number)).draw(
        RandomStream(7, number), lambda error: physical_parameters(means + error, pulse_like=False)
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
        motion = turned(simulate_recording(parameters, magnitude, noises), number)
        peaks.extend(np.abs(motion).max(axis=1) / STANDARD_GRAVITY)
    assert np.median(peaks) == pytest.approx(expected, rel=0.3)


def test_turning_by_a_right_angle_swaps_the_components() -> None:
    motion = np.random.default_rng(1).standard_normal((2, 5))
    assert turned(motion, np.pi / 2.0) == pytest.approx(np.stack([motion[1], -motion[0]]))


def test_trimming_takes_the_quiet_time_only() -> None:
    parameters = _parameters(1)
    motion = simulate_recording(parameters, 7.0, (RandomStream(8, 1), RandomStream(9, 1)))
    kept = trim_quiet_ends(motion)
    assert kept.shape[1] < motion.shape[1]
    assert np.abs(kept).max(axis=1) == pytest.approx(np.abs(motion).max(axis=1), rel=1e-3)
    assert _arias(kept)[:, -1] == pytest.approx(_arias(motion)[:, -1], rel=5e-3)


def test_stations_of_an_earthquake_share_it_and_differ() -> None:
    first, second = islice(simulate_event(4, 1), 2)
    assert first.scenario.magnitude == second.scenario.magnitude
    assert first.scenario.mechanism == second.scenario.mechanism
    assert first.scenario.rupture_distance != second.scenario.rupture_distance
    assert first.components.shape != second.components.shape
