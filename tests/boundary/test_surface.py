"""Errors between the cells of a stored grid."""

import numpy as np
import pytest
import scipy

from reliab.tracking.boundary.contour import ErrorSurfaces, stretched

GAIN = np.exp(np.array([-0.2, -0.1, -0.03, 0.0, 0.02, 0.06, 0.12]))
DELAY = np.array([-0.01, -0.004, 0.0, 0.002, 0.006, 0.015, 0.03])
FLOOR = 3e-4


def coordinates(gain, delay):
    """Linear at the perfect actuator, logarithmic around it, linear further out; written out anew."""
    x, y = np.log(gain), delay
    return np.arcsinh(x / 0.03) + x / (0.2 * 0.2), np.arcsinh(y / 0.002) + y / (0.1 * 0.03)


def cubic(gain, delay):
    """An error whose logarithm is a polynomial of third degree, which a bicubic spline gives back exactly."""
    x, y = coordinates(gain, delay)
    logarithm = (
        -6.0 + 0.3 * x - 0.2 * y + 0.05 * x * y + 0.02 * x**2 - 0.01 * y**2 - 1e-3 * x**3 + 2e-4 * y**3
    )
    return np.sqrt(np.exp(logarithm) - FLOOR**2)


def surfaces():
    gain, delay = np.meshgrid(GAIN, DELAY, indexing="ij")
    return ErrorSurfaces(GAIN, DELAY, np.stack([cubic(gain, delay), 2.0 * cubic(gain, delay)]))


def test_a_cubic_surface_comes_back_between_the_cells():
    rng = np.random.default_rng(1)
    gain, delay = np.exp(rng.uniform(-0.2, 0.12, 500)), rng.uniform(-0.01, 0.03, 500)
    error = surfaces().error(gain, delay, np.zeros(500, dtype=np.int64))
    assert error == pytest.approx(cubic(gain, delay), rel=1e-9)


def test_a_rough_surface_is_the_cubic_spline_along_both_axes_in_every_cell():
    rng = np.random.default_rng(3)
    rough = 10.0 ** rng.uniform(-2.0, 0.0, (GAIN.size, DELAY.size))
    gain, delay = np.exp(rng.uniform(-0.2, 0.12, 300)), rng.uniform(-0.01, 0.03, 300)
    x, y = coordinates(GAIN, DELAY)
    surface = ErrorSurfaces(GAIN, DELAY, rough[np.newaxis])
    along_gain = scipy.interpolate.CubicSpline(x, np.log(rough**2 + FLOOR**2), axis=0)
    for g, d in zip(gain, delay, strict=True):
        at = coordinates(g, d)
        logarithm = scipy.interpolate.CubicSpline(y, along_gain(at[0]))(at[1])
        expected = np.sqrt(max(np.exp(logarithm) - FLOOR**2, 0.0))
        error = surface.error(np.array([g]), np.array([d]), np.zeros(1, dtype=np.int64))
        assert error[0] == pytest.approx(expected, rel=1e-8, abs=1e-9)


def test_the_larger_side_of_the_gains_sets_the_scale():
    """Gains mirrored: the logarithm is then cubic in mirrored coordinates."""
    gain, delay = np.meshgrid(1.0 / GAIN[::-1], DELAY, indexing="ij")
    mirrored = ErrorSurfaces(1.0 / GAIN[::-1], DELAY, cubic(1.0 / gain, delay)[np.newaxis])
    rng = np.random.default_rng(2)
    gain, delay = np.exp(rng.uniform(-0.2, 0.12, 200)), rng.uniform(-0.01, 0.03, 200)
    error = mirrored.error(1.0 / gain, delay, np.zeros(200, dtype=np.int64))
    assert error == pytest.approx(cubic(gain, delay), rel=1e-9)


def test_every_surface_passes_through_its_cells():
    gain, delay = (grid.ravel() for grid in np.meshgrid(GAIN, DELAY, indexing="ij"))
    for surface in (0, 1):
        error = surfaces().error(gain, delay, np.full(gain.size, surface))
        assert error == pytest.approx((1 + surface) * cubic(gain, delay), rel=1e-9)


@pytest.mark.parametrize(
    ("gain", "delay", "inside"),
    [
        (GAIN[0], 0.0, True),
        (GAIN[-1], 0.0, True),
        (1.0, DELAY[0], True),
        (1.0, DELAY[-1], True),
        (0.999 * GAIN[0], 0.0, False),
        (1.001 * GAIN[-1], 0.0, False),
        (1.0, 1.001 * DELAY[0], False),
        (1.0, 1.001 * DELAY[-1], False),
    ],
)
def test_beyond_the_grid_nothing_is_said(gain, delay, inside):
    error = surfaces().error(np.array([gain]), np.array([delay]), np.array([0]))
    assert bool(np.isfinite(error[0])) == inside


def test_errors_without_bound_and_without_value_count_as_a_thousand():
    error = np.full((1, GAIN.size, DELAY.size), np.inf)
    error[0, ::2] = np.nan
    error[0, 1::3] = 1e9
    found = ErrorSurfaces(GAIN, DELAY, error).error(GAIN, np.zeros(GAIN.size), np.zeros(GAIN.size, dtype=int))
    assert found == pytest.approx(1e3)


def test_the_perfect_actuator_has_no_error():
    gain, delay = np.meshgrid(GAIN, DELAY, indexing="ij")
    error = np.hypot(np.log(gain), delay / 0.1)[np.newaxis]
    found = ErrorSurfaces(GAIN, DELAY, error).error(np.ones(1), np.zeros(1), np.zeros(1, dtype=np.int64))
    assert found == pytest.approx(0.0, abs=1e-6)


def test_the_coordinate_is_odd_and_linear_near_and_far():
    assert stretched(np.array([-0.3]), 0.1, 2.0) == pytest.approx(-np.arcsinh(3.0) - 0.15)
    assert stretched(np.array([1e-6]), 0.1, 2.0) == pytest.approx(1e-6 * (1 / 0.1 + 1 / 2.0))
