"""Roots of increasing functions, many at a time."""

import numpy as np
import pytest
import scipy

from reliab.criterion.carrying import _line_above_zero
from reliab.criterion.motion_predictive import roots_of_increasing


@pytest.mark.parametrize(
    ("function", "roots"),
    [
        (
            lambda x: scipy.special.ndtr(x) - np.array([1e-6, 0.5, 0.95]),
            [-4.753424308823, 0.0, 1.644853626951],
        ),
        (lambda x: np.sign(x - 0.3) * np.abs(x - 0.3) ** 0.2 * np.ones(3), [0.3, 0.3, 0.3]),
        (lambda x: np.where(x < 2.0, -1.0, 1.0) * np.ones(3), [2.0, 2.0, 2.0]),  # a jump
        (lambda x: x - np.array([-1e5, 1e5, 7.0]), [-1e5, 1e5, 7.0]),  # far outside of the first interval
        (lambda x: np.expm1(20.0 * x) - np.array([0.0, 1.0, 1e7]), np.log1p([0.0, 1.0, 1e7]) / 20.0),
    ],
)
def test_the_root_lies_where_the_sign_changes(function, roots):
    found = roots_of_increasing(function, np.full(3, -0.5), np.full(3, 0.75))
    np.testing.assert_allclose(found, roots, rtol=1e-11, atol=1e-12)


def test_a_function_without_a_root_has_none_and_leaves_the_others_theirs():
    found = roots_of_increasing(
        lambda x: np.stack([1.0 + np.exp(-abs(x[0])), x[1] - 3.0]), np.zeros(2), np.ones(2)
    )
    assert np.isnan(found[0])
    assert found[1] == pytest.approx(3.0)


def test_few_evaluations_are_enough():
    calls = []

    def function(x):
        calls.append(x)
        return scipy.special.ndtr(x) - 0.95

    roots_of_increasing(function, np.array([0.0]), np.array([3.0]))
    assert len(calls) < 20


@pytest.mark.parametrize("seed", range(5))
def test_a_line_above_zero_is_the_one_of_least_squares_with_bounds(seed):
    rng = np.random.default_rng(seed)
    places, values = rng.uniform(0.0, 3.0, 40), rng.uniform(0.0, 1.0, 40)
    values = values + places * (seed - 1) if seed else np.maximum(values - places, 0.0)
    values = np.abs(values)
    expected = scipy.optimize.nnls(np.stack([np.ones(40), places], axis=-1), values)[0]
    np.testing.assert_allclose(_line_above_zero(places, values), expected, rtol=1e-9, atol=1e-12)
    level = _line_above_zero(np.zeros(40), values)
    np.testing.assert_allclose(level, [values.mean(), 0.0])
