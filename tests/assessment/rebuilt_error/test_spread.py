"""Intervals and probabilities of weighted draws, against the closed form for two normal components."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import ive

from reliab.assessment.inference.error_draws import weight_of_size
from reliab.assessment.rebuilt_error.spread import Spread
from reliab.core.vocabulary import Metric


def spread_of(errors, ratio=1.0):
    probable = float(np.median(errors))
    weights = np.array([weight_of_size(error, probable) for error in errors.tolist()])
    weights = weights / weights.mean()
    return Spread(rms=errors, mte=ratio * errors, mean=np.zeros(1), deviation=np.zeros(1), weights=weights)


def draw_two_components(length, deviation, draws=200_000):
    """Draws of the length of a vector that was read with this length and normal errors."""
    components = np.random.default_rng(3).normal([[length], [0.0]], deviation, (2, draws))
    errors = np.hypot(*components)
    return spread_of(errors, ratio=2.0)


def probability_of_a_uniform_length(lower, length, deviation):
    """Probability of a length that was uniform before a reading whose length follows Rice's distribution."""

    def density(size):
        scaled_copy = size * length / deviation**2
        return np.exp(-0.5 * (size - length) ** 2 / deviation**2) * ive(0, scaled_copy)

    full_test = quad(density, 0.0, length + 12.0 * deviation, points=[length])[0]
    return quad(density, 0.0, lower)[0] / full_test


@pytest.mark.parametrize(("length", "deviation"), [(0.05, 0.005), (0.05, 0.02), (0.02, 0.02)])
def test_weighted_draws_are_those_of_a_uniform_length(length, deviation):
    spread = draw_two_components(length, deviation)
    for lower in (0.7 * length, length, 1.3 * length):
        expected = probability_of_a_uniform_length(lower, length, deviation)
        assert spread.probability_below(lower, Metric.RMS) == pytest.approx(expected, abs=0.01)
        assert spread.probability_below(2.0 * lower, Metric.MTE) == pytest.approx(expected, abs=0.01)


def test_the_ends_of_the_interval_have_the_stated_probability():
    spread = draw_two_components(0.05, 0.02)
    for metric in Metric:
        low, high = spread.interval(metric)
        assert spread.probability_below(low, metric) == pytest.approx(0.05, abs=1e-3)
        assert spread.probability_below(high, metric) == pytest.approx(0.95, abs=1e-3)


def test_draws_without_any_error_have_equal_weights():
    nothing = spread_of(np.zeros(8))
    np.testing.assert_array_equal(nothing.weights, 1.0)
    assert nothing.interval(Metric.RMS) == (0.0, 0.0)
    assert nothing.probability_below(0.05, Metric.RMS) == pytest.approx(8.5 / 9.0)


def test_one_perfect_draw_does_not_outweigh_all_others():
    rms = np.concatenate([[0.0], np.full(255, 0.05)])
    assert spread_of(rms).probability_below(0.04, Metric.RMS) < 0.5
