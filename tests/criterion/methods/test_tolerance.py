"""Tolerance bounds against published tables and against each other."""

import numpy as np
import pytest

from reliab.criterion.methods import OrderStatistic, Posterior, Tolerance, tolerance_factor

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


@pytest.mark.parametrize("assurance", [0.5, 0.9, 0.95])
@pytest.mark.parametrize("confidence", [0.8, 0.95, 0.99])
def test_the_credible_bound_under_the_reference_prior_is_the_tolerance_bound(confidence, assurance):
    logarithms, events = np.random.default_rng(2).normal(size=17), np.arange(17).astype(str)
    assert Posterior(assurance=assurance).lower_bound(logarithms, events, confidence) == pytest.approx(
        Tolerance(assurance=assurance).lower_bound(logarithms, events, confidence)
    )


@pytest.mark.parametrize(("n", "rank"), [(58, 0), (59, 1), (93, 2), (124, 3), (181, 5)])
def test_the_rank_is_the_tabulated_one(n, rank):
    """Sample sizes for 95/95 without a distribution: 59, 93, 124, 153, 181 for the first five ranks."""
    bound = OrderStatistic().lower_bound(np.arange(1.0, n + 1.0), np.arange(n).astype(str), 0.95)
    assert bound == (rank or -np.inf)
