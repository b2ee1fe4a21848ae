"""Tolerance bounds against published tables and against each other."""

import numpy as np
import pytest

from reliab.criterion.methods.order_statistic import OrderStatistic
from reliab.criterion.methods.tolerance import Tolerance, tolerance_factor

# Odeh and Owen (1980), as reprinted in US EPA (2009), Unified guidance, table 17-3 (assurance 95 %)
PROPORTION_95 = {10: 2.911, 20: 2.396, 30: 2.220, 50: 2.065, 100: 1.927}
# MIL-HDBK-17-1F (2002), tables 8.5.10 (B-basis, 90 %) and 8.5.11 (A-basis, 99 %), assurance 95 %
PROPORTION_90 = {10: 2.355, 20: 1.926, 50: 1.646, 100: 1.527}
PROPORTION_99 = {10: 3.981, 20: 3.295, 50: 2.862, 100: 2.684}


@pytest.mark.parametrize(
    ("proportion", "table"), [(0.95, PROPORTION_95), (0.90, PROPORTION_90), (0.99, PROPORTION_99)]
)
def test_the_factor_is_the_tabulated_one(proportion, table):
    for n, factor in table.items():
        assert tolerance_factor(n, proportion, 0.95) == pytest.approx(factor, abs=0.0006)


def test_the_factor_is_the_nist_example():
    """NIST/SEMATECH e-Handbook, section 7.2.6.3: n = 43, 90 % and 99 %."""
    assert tolerance_factor(43, 0.90, 0.99) == pytest.approx(1.8740, abs=0.00005)


def test_the_factor_tends_to_the_normal_quantile():
    assert tolerance_factor(10**6, 0.95, 0.95) == pytest.approx(1.6449, abs=0.003)


@pytest.mark.parametrize("confidence", [0.8, 0.95])
def test_unlike_clusters_leave_bound_of_independent_motions(confidence):
    """By another route: the exact factor, where earthquakes have two motions without a common part."""
    values = np.random.default_rng(6).normal(size=4000)
    pairs, separate = np.repeat(np.arange(2000), 2).astype(str), np.arange(4000).astype(str)
    bounds = [Tolerance().lower_bound(values, events, confidence) for events in (pairs, separate)]
    assert bounds[0] == pytest.approx(bounds[1], abs=0.03)


def test_copies_of_each_motion_are_worth_no_more_than_the_motions():
    values = np.random.default_rng(7).normal(size=30)
    small_sample, many = (
        Tolerance().lower_bound(np.repeat(values, count), np.repeat(np.arange(30), count).astype(str), 0.9)
        for count in (1, 8)
    )
    assert many == pytest.approx(small_sample, abs=0.1)
    original = OrderStatistic().lower_bound(values, np.arange(30).astype(str), 0.8)
    duplicate = OrderStatistic().lower_bound(
        np.repeat(values, 8), np.repeat(np.arange(30), 8).astype(str), 0.8
    )
    assert duplicate <= original


@pytest.mark.parametrize(("n", "rank"), [(58, 0), (59, 1), (93, 2), (124, 3), (181, 5)])
def test_the_rank_is_the_tabulated_one(n, rank):
    """Sample sizes for 95/95 without a distribution: 59, 93, 124, 153, 181 for the first five ranks."""
    bound = OrderStatistic().lower_bound(np.arange(1.0, n + 1.0), np.arange(n).astype(str), 0.95)
    assert bound == (rank or -np.inf)
