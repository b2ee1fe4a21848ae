"""What is learned of a quantity covers what follows, also with few tests, odd ones and groups."""

import numpy as np
import pytest

from reliab.rig.learning import Circumstances, learn

NEXT = Circumstances(groups={"event": np.array([""])})


def learned(values, events, **changes):
    names = np.array([f"EQ{event}" for event in events])
    return learn(np.asarray(values), Circumstances(groups={"event": names}, **changes), names)


def share_covered(count, seeds, per_event=1, odd=0.0):
    """Mean probability content of 90 % intervals for a test under another earthquake."""
    inside = []
    for seed in range(seeds):
        rng = np.random.default_rng([count, per_event, seed])
        events = np.arange(count) // per_event
        level = rng.normal(size=count)
        spread = np.where(rng.random(count) < odd, 6.0, 1.0)
        values = (level[events] if per_event > 1 else 0.0) + spread * rng.normal(size=count)
        low, high = learned(values, events).quantiles(NEXT, (0.05, 0.95))[:, 0]
        further = rng.normal(size=4000) * np.where(rng.random(4000) < odd, 6.0, 1.0)
        further = further + (rng.normal(size=4000) if per_event > 1 else 0.0)
        inside.append(np.mean((further > low) & (further < high)))
    return float(np.mean(inside))


def test_an_odd_test_hardly_moves_what_is_predicted():
    values = np.random.default_rng(1).normal(size=30)
    spoiled = np.append(values, 60.0)
    before, after = (
        learned(known, np.arange(known.size)).quantiles(NEXT, (0.5,))[0, 0] for known in (values, spoiled)
    )
    assert abs(after - before) < 0.2


def test_a_covariate_that_matters_narrows_the_prediction():
    rng = np.random.default_rng(2)
    peaks = rng.normal(size=40)
    values = 2.0 * peaks + 0.1 * rng.normal(size=40)
    with_peak = learned(values, np.arange(40), numbers={"log peak": peaks})
    asked = Circumstances(groups={"event": np.array([""])}, numbers={"log peak": np.array([1.0])})
    mean, spread = with_peak.predict(asked)
    assert mean[0] == pytest.approx(2.0, abs=0.2)
    assert spread[0] < 0.3
    assert with_peak.log_score > max(with_peak.scores_of_baselines.values())


def test_the_posterior_of_the_variances_states_its_draws():
    variances = learned(np.random.default_rng(3).normal(size=24), np.arange(24) // 3).variances
    assert variances.respects == ("event",)
    assert variances.r_hat < 1.1
    assert variances.effective_size > 30.0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("count", "per_event", "odd", "seeds"),
    [(3, 1, 0.0, 100), (5, 1, 0.0, 100), (10, 1, 0.0, 60), (30, 3, 0.0, 40), (120, 3, 0.05, 12)],
)
def test_intervals_cover_what_they_state(count, per_event, odd, seeds):
    assert 0.86 < share_covered(count, seeds, per_event, odd) < 0.94
