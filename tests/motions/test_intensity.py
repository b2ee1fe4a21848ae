from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy import integrate, optimize

from reliab.core.errors import InputError
from reliab.core.vocabulary import STANDARD_GRAVITY
from reliab.motions.motion import (
    Motion,
    arias_intensity,
    arias_times,
    mean_period,
    measure,
    significant_duration,
)

RECORDS = st.lists(st.floats(-10.0, 10.0), min_size=3, max_size=12).filter(
    lambda values: max(map(abs, values)) > 1e-3
)


def energy_until(samples: list[float], step: float, time: float) -> float:
    """Integral of the squared record, by adaptive quadrature of each piece."""
    knots = np.arange(len(samples)) * step
    inner = [0.0, *[knot for knot in knots[1:] if knot < time], time]
    return sum(
        integrate.quad(lambda t: np.interp(t, knots, samples) ** 2, a, b)[0] for a, b in pairwise(inner)
    )


def test_arias_intensity_of_a_constant_is_closed_form() -> None:
    assert arias_intensity([2.0] * 11, 0.1) == pytest.approx(np.pi / (2 * STANDARD_GRAVITY) * 4.0)


def test_arias_intensity_of_a_ramp_is_a_third_of_the_constant() -> None:
    ramp = np.linspace(0.0, 3.0, 7)
    assert arias_intensity(ramp, 0.5) == pytest.approx(np.pi / (2 * STANDARD_GRAVITY) * 9.0 * 3.0 / 3.0)


def test_arias_intensity_of_a_sine_is_half_the_constant() -> None:
    times = np.linspace(0.0, 10.0, 100_001)
    sine = 1.5 * np.sin(2 * np.pi * times)
    expected = np.pi / (2 * STANDARD_GRAVITY) * 1.5**2 * 10.0 / 2
    assert arias_intensity(sine, 1e-4) == pytest.approx(expected, rel=1e-6)


@given(samples=RECORDS, fraction=st.floats(0.01, 0.99))
def test_arias_times_agree_with_quadrature(samples: list[float], fraction: float) -> None:
    step = 0.25
    total = energy_until(samples, step, (len(samples) - 1) * step)
    (time,) = arias_times(samples, step, [fraction])
    assert energy_until(samples, step, float(time)) == pytest.approx(
        fraction * total, rel=1e-5, abs=1e-9 * total
    )


def test_arias_times_of_a_ramp_follow_the_cube_root() -> None:
    fractions = [0.0, 0.05, 0.5, 0.95, 1.0]
    times = arias_times([0.0, 4.0], 2.0, fractions)
    np.testing.assert_allclose(times, 2.0 * np.cbrt(fractions), rtol=1e-12)


def test_arias_times_are_found_where_the_record_changes_sign() -> None:
    (time,) = arias_times([-1.0, 3.0], 1.0, [0.3])
    root = optimize.brentq(lambda x: ((4 * x - 1) ** 3 + 1) / 12 - 0.3 * 28 / 12, 0.0, 1.0)
    assert float(time) == pytest.approx(root, rel=1e-12)


def test_leading_and_trailing_zeros_take_no_part() -> None:
    record = [0.0] * 50 + [1.0] * 21 + [0.0] * 50
    assert arias_times(record, 0.1, [0.0, 1.0]).tolist() == pytest.approx([0.0, 7.1])
    assert significant_duration(record, 0.1) == pytest.approx(0.9 * (2.0 + 2 * 0.1 / 3), rel=1e-9)


def test_significant_duration_takes_other_fractions() -> None:
    assert significant_duration([1.0, 1.0], 10.0, start=0.05, end=0.75) == pytest.approx(7.0)


@pytest.mark.parametrize("frequency", [0.5, 1.0, 3.0, 10.0])
def test_mean_period_of_a_sine_is_its_period(frequency: float) -> None:
    times = np.arange(8000) * 0.005
    assert mean_period(np.sin(2 * np.pi * frequency * times), 0.005) == pytest.approx(1 / frequency, rel=1e-9)


def test_mean_period_weighs_periods_by_squared_amplitude() -> None:
    times = np.arange(8000) * 0.005
    two = 3.0 * np.sin(2 * np.pi * times) + 1.0 * np.cos(2 * np.pi * 4.0 * times)
    assert mean_period(two, 0.005) == pytest.approx((9.0 * 1.0 + 1.0 * 0.25) / 10.0, rel=1e-9)


def test_mean_period_ignores_frequencies_outside_band() -> None:
    times = np.arange(8000) * 0.005
    sine = np.sin(2 * np.pi * 2.0 * times)
    excess = 5.0 * np.sin(2 * np.pi * 0.1 * times) + 5.0 * np.sin(2 * np.pi * 50.0 * times)
    assert mean_period(sine + excess, 0.005) == pytest.approx(0.5, rel=1e-9)


def test_a_short_record_is_padded_to_the_frequency_interval_of_rathje() -> None:
    impulse = np.zeros(100)
    impulse[10] = 1.0  # flat spectrum: the mean of 1/f over the lines from 0.25 to 20 Hz
    lines = np.arange(0.25, 20.0 + 1e-9, 0.05)
    assert mean_period(impulse, 0.01) == pytest.approx(np.mean(1 / lines), rel=1e-9)


def test_a_record_without_content_is_refused() -> None:
    with pytest.raises(InputError, match="is zero throughout"):
        arias_times([0.0, 0.0], 0.01, [0.5])
    with pytest.raises(InputError, match="content"):
        mean_period(np.zeros(100), 0.01)
    with pytest.raises(InputError, match="content"):
        mean_period([1.0, 2.0, 1.0], 5.0)


@pytest.mark.parametrize("fraction", [-0.1, 1.1, np.nan])
def test_a_fraction_beyond_its_range_is_refused(fraction: float) -> None:
    with pytest.raises(InputError, match=r"\[0, 1\]"):
        arias_times([1.0, 1.0], 0.01, [fraction])


@given(samples=RECORDS, scale=st.floats(1e-3, 4.0))
def test_scaling_a_record_scales_only_its_strength(samples: list[float], scale: float) -> None:
    record = Motion(name="a", acceleration=np.array(samples), time_step=0.05)
    scaled_copy = Motion(name="a", acceleration=scale * np.array(samples), time_step=0.05)
    single, second = measure(record), measure(scaled_copy)
    assert second.peak_acceleration == pytest.approx(scale * single.peak_acceleration)
    assert second.arias_intensity == pytest.approx(scale**2 * single.arias_intensity)
    assert second.significant_duration == pytest.approx(single.significant_duration, rel=1e-6, abs=1e-7)
    assert second.mean_period == pytest.approx(single.mean_period)


@pytest.mark.parametrize("size", [1e-180, 1e180])
def test_the_mean_period_has_no_size(size):
    shaken = np.random.default_rng(5).standard_normal(2000)
    assert mean_period(size * shaken, 0.01) == pytest.approx(mean_period(shaken, 0.01), rel=1e-12)
