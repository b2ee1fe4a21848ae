"""What is learned of a quantity covers what follows, also with few tests, odd ones and groups."""

import emcee
import numpy as np
import pytest
import scipy

from reliab.rig.learning.circumstances import Circumstances
from reliab.rig.learning.learned import Scatter, last_ten, learn, pool, score_left_out_events
from reliab.rig.learning.variances import LEVEL

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
    values = np.random.default_rng(1).normal(size=20)
    spoiled = np.append(values, 60.0)
    before, after = (
        learned(known, np.arange(known.size)).quantiles(NEXT, (0.5,))[0, 0] for known in (values, spoiled)
    )
    assert abs(after - before) < 0.2


def test_a_covariate_that_matters_narrows_the_prediction():
    rng = np.random.default_rng(2)
    peaks = rng.normal(size=24)
    values = 2.0 * peaks + 0.1 * rng.normal(size=24)
    with_peak = learned(values, np.arange(24), numbers={"log peak": peaks})
    asked = Circumstances(groups={"event": np.array([""])}, numbers={"log peak": np.array([1.0])})
    mean, spread = with_peak.predict(asked)
    assert mean[0] == pytest.approx(2.0, abs=0.2)
    assert spread[0] < 0.3
    assert with_peak.log_score > max(with_peak.scores_of_baselines.values())


def test_a_prediction_at_given_variances_is_that_of_the_normal_distribution():
    """Mean and variance of a further test by conditioning a normal distribution, written out."""
    rng = np.random.default_rng(21)
    events = np.arange(12) // 3
    values = 5.0 + rng.normal(size=4)[events] + 0.5 * rng.normal(size=12)
    quantity = learned(values, events)
    variances = quantity.variances
    between, noise = np.exp(2.0 * variances.mode)
    same = (events[:, None] == events).astype(float)
    matrix = LEVEL + between * same + np.diag(noise / variances.weights)
    gain = np.linalg.solve(matrix, np.full(12, LEVEL))
    mean, deviation = quantity.predict(NEXT)
    assert mean[0] == pytest.approx(quantity.centre + gain @ (values - quantity.centre))
    alone = LEVEL + between + noise - LEVEL * gain.sum()
    assert deviation[0] >= quantity.spread * np.sqrt(alone) * (1.0 - 1e-9)
    assert deviation[0] == pytest.approx(quantity.spread * np.sqrt(alone), rel=0.1)


def test_a_test_left_out_is_predicted_as_if_it_had_never_been():
    """Residual and spread of each earthquake left out, against conditioning on the other tests."""
    rng = np.random.default_rng(22)
    events = np.arange(12) // 3
    values = rng.normal(size=4)[events] + 0.5 * rng.normal(size=12)
    quantity = learned(values, events)
    between, noise = np.exp(2.0 * quantity.variances.mode)
    standard = (values - quantity.centre) / quantity.spread
    matrix = LEVEL + between * (events[:, None] == events)
    noisy = matrix + np.diag(noise / quantity.variances.weights)
    for event in range(4):
        inside = events == event
        gain = np.linalg.solve(noisy[np.ix_(~inside, ~inside)], matrix[np.ix_(~inside, inside)])
        residual = standard[inside] - gain.T @ standard[~inside]
        variance = LEVEL + between + noise - np.einsum("oi,oi->i", matrix[np.ix_(~inside, inside)], gain)
        assert quantity.left_out.spreads[inside] == pytest.approx(np.sqrt(variance))
        assert quantity.left_out.residuals[inside] == pytest.approx(residual / np.sqrt(variance))


@pytest.mark.parametrize("count", [3, 4, 9])
def test_few_tests_of_which_most_are_alike_are_not_certain(count):
    values = np.append(np.full(count - 1, 2.0), 2.5)
    low, high = learned(values, np.arange(count)).quantiles(NEXT, (0.05, 0.95))[:, 0]
    assert high - low > 0.5


def test_residuals_without_an_earthquake_are_those_of_a_rig_that_never_had_it():
    """Residuals of the other tests, against conditioning without any test of that earthquake."""
    rng = np.random.default_rng(24)
    events = np.array([0, 0, 1, 2, 2, 2, 3, 4, 4])
    quantity = learned(rng.normal(size=9), events)
    between, noise = np.exp(2.0 * quantity.variances.mode)
    standard = (quantity.values - quantity.centre) / quantity.spread
    matrix = LEVEL + between * (events[:, None] == events) + np.diag(noise / quantity.variances.weights)
    for absent in range(5):
        residuals = quantity.left_out.residuals_without(np.flatnonzero(events == absent))
        for event in {0, 1, 2, 3, 4} - {absent}:
            inside, others = events == event, (events != event) & (events != absent)
            gain = np.linalg.solve(matrix[np.ix_(others, others)], matrix[np.ix_(others, inside)])
            variance = LEVEL + between + noise - np.einsum("oi,oi->i", matrix[np.ix_(others, inside)], gain)
            expected = (standard[inside] - gain.T @ standard[others]) / np.sqrt(variance)
            assert residuals[inside] == pytest.approx(expected)


def scatter_of(residuals):
    return Scatter.fit(np.asarray(residuals), np.arange(len(residuals)).astype(str))


def test_scatter_is_normal_unless_tests_say_otherwise():
    scatter = scatter_of(scipy.stats.norm.ppf((np.arange(60) + 0.5) / 60))
    at = np.linspace(-3.0, 3.0, 7)
    assert scatter.cumulative(at) == pytest.approx(scipy.stats.norm.cdf(at), abs=0.01)


def test_scatter_learns_a_longer_side():
    scatter = scatter_of(scipy.stats.gamma.ppf((np.arange(200) + 0.5) / 200, 1.5) - 1.5)
    assert scatter.quantile(0.95) > -1.4 * scatter.quantile(0.05)


def test_one_test_far_off_does_not_widen_the_scatter():
    usual = np.random.default_rng(23).normal(size=30)
    assert scatter_of(np.where(np.arange(30) == 3, 40.0, usual)).quantile(0.95) < 3.0


def test_density_of_scatter_is_the_derivative_of_its_probability():
    scatter = scatter_of(np.random.default_rng(25).standard_t(3, size=40))
    at, step = np.linspace(-5.0, 5.0, 11), 1e-5
    difference = (scatter.cumulative(at + step) - scatter.cumulative(at - step)) / (2.0 * step)
    assert np.exp(scatter.log_density(at)) == pytest.approx(difference, rel=1e-6)
    assert scatter.cumulative([scatter.quantile(0.3)])[0] == pytest.approx(0.3)
    drawn = np.sinh(np.linspace(-7.0, 7.0, 4_001))
    mean = np.trapezoid(drawn * np.exp(scatter.log_density(drawn)), drawn)
    assert mean == pytest.approx(0.0, abs=0.02)


def test_baselines_are_student_distributions_of_what_they_know():
    values = np.arange(20.0)
    assert pool(values).scale == pytest.approx(values.std(ddof=1) * np.sqrt(1.05))
    assert (last_ten(values).centre, last_ten(values).degrees) == (14.5, 9.0)
    names = np.arange(20).astype(str)
    scores = score_left_out_events(values, names, last_ten, only_earlier=True)
    assert np.isnan(scores[:3]).all()
    assert scores[12] == pytest.approx(pool(values[2:12]).log_density(12.0))


def test_the_posterior_of_the_variances_states_its_draws():
    variances = learned(np.random.default_rng(3).normal(size=24), np.arange(24) // 3).variances
    assert variances.respects == ("event",)
    assert variances.r_hat < 1.1
    assert variances.effective_size > 30.0


@pytest.mark.slow
def test_the_posterior_is_that_of_emcee():
    """Draws by importance against chains that walk with nothing but the density."""
    rng = np.random.default_rng(31)
    events = np.arange(30) // 3
    values = rng.normal(size=10)[events] + 0.7 * rng.normal(size=30)
    variances = learned(values, events).variances
    size = variances.mode.size
    sampler = emcee.EnsembleSampler(16, size, lambda theta: -variances.problem.loss(theta))
    sampler.random_state = np.random.RandomState(1).get_state()
    sampler.run_mcmc(variances.mode + 0.3 * rng.normal(size=(16, size)), 2500)
    chain = sampler.get_chain(discard=500, flat=True)
    spread = chain.std(axis=0)
    assert (np.abs(variances.draws.mean(axis=0) - chain.mean(axis=0)) < 0.2 * spread).all()
    assert variances.draws.std(axis=0) == pytest.approx(spread, rel=0.2)
    # so many walkers' steps for one independent draw; those by importance need three or four densities
    assert sampler.get_autocorr_time(tol=0).max() > 10.0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("count", "per_event", "odd", "seeds"),
    [(3, 1, 0.0, 100), (5, 1, 0.0, 100), (10, 1, 0.0, 60), (30, 3, 0.0, 40), (120, 3, 0.05, 12)],
)
def test_intervals_cover_what_they_state(count, per_event, odd, seeds):
    assert 0.86 < share_covered(count, seeds, per_event, odd) < 0.94
