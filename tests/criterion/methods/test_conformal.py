"""The grouped conformal bound."""

import numpy as np
import pytest

from reliab.criterion.methods.conformal import Conformal


@pytest.mark.parametrize(("events", "highest"), [(4, 0.8), (19, 0.95), (99, 0.99)])
def test_the_number_of_earthquakes_limits_the_confidence(events, highest):
    logarithms, names = np.random.default_rng(1).normal(size=3 * events), np.repeat(np.arange(events), 3)
    bound = Conformal().lower_bound(logarithms, names.astype(str), highest)
    assert bound == logarithms.min()
    assert Conformal().lower_bound(logarithms, names.astype(str), highest + 0.001) == -np.inf


def test_motions_of_their_own_earthquake_give_the_ordinary_conformal_bound():
    logarithms = np.random.default_rng(1).permutation(np.arange(1.0, 100.0))
    assert Conformal().lower_bound(logarithms, np.arange(99).astype(str), 0.9) == 10.0


def test_a_large_earthquake_counts_no_more_than_a_small_one():
    logarithms = np.concatenate([np.zeros(90), np.arange(1.0, 10.0)])
    events = np.concatenate([np.zeros(90), np.arange(1, 10)]).astype(int).astype(str)
    assert Conformal().lower_bound(logarithms, events, 0.75) == 1.0


def test_the_promise_is_kept_on_average_for_skewed_grouped_motions():
    rng = np.random.default_rng(8)
    kept = []
    for _ in range(2000):
        effect, events = rng.exponential(size=31), np.repeat(np.arange(30), 2)
        logarithms = effect[events] + rng.exponential(size=60)
        further = effect[30] + rng.exponential()
        kept.append(further >= Conformal().lower_bound(logarithms, events.astype(str), 0.9))
    assert 0.9 - 3.0 * np.sqrt(0.09 / 2000) <= np.mean(kept) <= 0.9 + 1 / 31 + 3.0 * np.sqrt(0.09 / 2000)
