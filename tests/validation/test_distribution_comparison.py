"""Held-out scores of distributions."""

import numpy as np
import pytest
from scipy import stats

from reliab.criterion.distributions import DISTRIBUTIONS, Lognormal
from reliab.validation.comparison import (
    compare_distributions,
    held_out_scores,
    leave_one_event_out,
)

KINDS = {
    "lognormal": lambda rng: np.exp(rng.normal(size=600)),
    "student_t": lambda rng: np.exp(stats.t(2.5).rvs(600, random_state=rng)),
    "skew_normal": lambda rng: np.exp(stats.skewnorm(8.0).rvs(600, random_state=rng)),
    "gamma": lambda rng: rng.gamma(1.5, size=600),
    "weibull": lambda rng: rng.weibull(3.0, size=600),
    "gaussian_mixture": lambda rng: np.exp(rng.choice([-3.0, 3.0], 600) + rng.normal(size=600)),
}


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=() if name == "lognormal" else pytest.mark.slow) for name in KINDS],
)
def test_the_true_distribution_is_among_the_best(name):
    values = KINDS[name](np.random.default_rng(21))
    table = compare_distributions(values, np.repeat(np.arange(4), 150).astype(str))
    assert table.loc[name, "log_score"] > table["log_score"].max() - 0.01


def test_the_score_is_that_of_the_density_without_the_earthquake():
    values, events = np.array([1.0, 2.0, 4.0, 8.0, 3.0]), np.array(["a", "b", "b", "c", "c"])
    scores = held_out_scores(values, events, Lognormal)
    without = Lognormal.fit(values[1:])
    assert scores.log_score[0] == pytest.approx(stats.norm.logpdf(0.0, without.mu, without.sigma))


def test_every_motion_is_held_out_once():
    events = np.array(["a", "b", "a", "c"])
    assert np.sum(list(leave_one_event_out(events)), axis=0).tolist() == [1, 1, 1, 1]


@pytest.mark.slow
def test_every_distribution_is_compared(printed_table2):
    table = compare_distributions(printed_table2["a"].values.ravel(), printed_table2["event"].values)
    assert set(table.index) == set(DISTRIBUTIONS)
    assert table.loc["lognormal", "gain"] == 0.0
    assert table.loc["lognormal", "quantile_05"] == pytest.approx(5.29e-5, rel=1e-3)
