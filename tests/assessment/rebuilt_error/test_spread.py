"""Intervals and probabilities of weighted draws."""

import numpy as np
import pytest
from scipy.stats import norm

from reliab.assessment.rebuilt_error.spread import ErrorDraws, Estimate
from reliab.core.vocabulary import Metric


def spread_of(errors, weights=1.0):
    weights = np.broadcast_to(weights, errors.shape) / np.mean(weights)
    return ErrorDraws(rms=errors, mte=2.0 * errors, weights=weights)


def test_weighted_draws_are_those_of_the_weighted_density():
    """Uniform draws with the weights of a normal density."""
    errors = np.random.default_rng(3).uniform(0.0, 0.1, 200_000)
    spread = spread_of(errors, norm.pdf(errors, 0.05, 0.01))
    for lower in (0.04, 0.05, 0.065):
        expected = norm.cdf(lower, 0.05, 0.01)
        assert spread.probability_below(lower, Metric.RMS) == pytest.approx(expected, abs=0.01)
        assert spread.probability_below(2.0 * lower, Metric.MTE) == pytest.approx(expected, abs=0.01)


def test_the_ends_of_the_interval_have_the_stated_probability():
    spread = spread_of(np.random.default_rng(3).normal(0.05, 0.01, 20_000))
    for metric in Metric:
        error = spread.estimate(metric)
        assert spread.probability_below(error.low, metric) == pytest.approx(0.05, abs=1e-3)
        assert spread.probability_below(error.high, metric) == pytest.approx(0.95, abs=1e-3)


def test_draws_without_any_error_are_certain_but_for_half_a_draw():
    nothing = spread_of(np.zeros(8))
    assert nothing.estimate(Metric.RMS) == Estimate(value=0.0, low=0.0, high=0.0)
    assert nothing.probability_below(0.05, Metric.RMS) == pytest.approx(8.5 / 9.0)
