"""What is learned of a quantity covers what follows, also with few tests, odd ones and groups."""

import emcee
import numpy as np
import pytest
import scipy

from reliab.rig.covariates import LEVEL, Covariates
from reliab.rig.learned import ResidualDistribution, last_ten, learn, pool, score_left_out_events

NEXT = Covariates(groups={"event": np.array([""])})


def fit(values, events, **changes):
    names = np.array([f"EQ{event}" for event in events])
    return learn(np.asarray(values), Covariates(groups={"event": names}, **changes), names)


def share_covered(count, seeds, motions_of_event=1, odd=0.0):
    """Mean probability content of 90 % intervals for a test under another earthquake."""
    is_inside = []
    for seed in range(seeds):
        rng = np.random.default_rng([count, motions_of_event, seed])
        events = np.arange(count) // motions_of_event
        level = rng.normal(size=count)
        spread = np.where(rng.random(count) < odd, 6.0, 1.0)
        values = (level[events] if motions_of_event > 1 else 0.0) + spread * rng.normal(size=count)
        low, high = fit(values, events).quantiles(NEXT, (0.05, 0.95))[:, 0]
        additional = rng.normal(size=4000) * np.where(rng.random(4000) < odd, 6.0, 1.0)
        additional = additional + (rng.normal(size=4000) if motions_of_event > 1 else 0.0)
        is_inside.append(np.mean((additional > low) & (additional < high)))
    return float(np.mean(is_inside))


def test_odd_test_hardly_moves_the_prediction():
    values = np.random.default_rng(1).normal(size=20)
    corrupt = np.append(values, 60.0)
    first, second = (
        fit(reference, np.arange(reference.size)).quantiles(NEXT, (0.5,))[0, 0]
        for reference in (values, corrupt)
    )
    assert abs(second - first) < 0.2


def test_informative_covariate_narrows_the_prediction():
    rng = np.random.default_rng(2)
    peaks = rng.normal(size=24)
    values = 2.0 * peaks + 0.1 * rng.normal(size=24)
    peak_record = fit(values, np.arange(24), numbers={"log peak": peaks})
    covariates = Covariates(groups={"event": np.array([""])}, numbers={"log peak": np.array([1.0])})
    mean, spread = peak_record.predict(covariates)
    assert mean[0] == pytest.approx(2.0, abs=0.2)
    assert spread[0] < 0.3
    assert peak_record.log_score > max(peak_record.scores_of_baselines.values())


def test_prediction_at_fixed_variances_is_normal():
    """Mean and variance of a further test by conditioning a normal distribution, written out."""
    rng = np.random.default_rng(21)
    events = np.arange(12) // 3
    values = 5.0 + rng.normal(size=4)[events] + 0.5 * rng.normal(size=12)
    quantity = fit(values, events)
    variances = quantity.variances
    event_variance, noise = np.exp(2.0 * variances.mode)
    is_same_event = (events[:, None] == events).astype(float)
    matrix = LEVEL + event_variance * is_same_event + np.diag(noise / variances.weights)
    gain = np.linalg.solve(matrix, np.full(12, LEVEL))
    mean, deviation = quantity.predict(NEXT)
    assert mean[0] == pytest.approx(quantity.centre + gain @ (values - quantity.centre))
    separate = LEVEL + event_variance + noise - LEVEL * gain.sum()
    assert deviation[0] >= quantity.spread * np.sqrt(separate) * (1.0 - 1e-9)
    assert deviation[0] == pytest.approx(quantity.spread * np.sqrt(separate), rel=0.1)


def test_a_test_left_out_is_predicted_as_if_it_had_never_been():
    """Residual and spread of each earthquake left out, against conditioning on the other tests."""
    rng = np.random.default_rng(22)
    events = np.arange(12) // 3
    values = rng.normal(size=4)[events] + 0.5 * rng.normal(size=12)
    quantity = fit(values, events)
    event_variance, noise = np.exp(2.0 * quantity.variances.mode)
    standard = (values - quantity.centre) / quantity.spread
    matrix = LEVEL + event_variance * (events[:, None] == events)
    noisy = matrix + np.diag(noise / quantity.variances.weights)
    for event in range(4):
        is_inside = events == event
        gain = np.linalg.solve(noisy[np.ix_(~is_inside, ~is_inside)], matrix[np.ix_(~is_inside, is_inside)])
        residual = standard[is_inside] - gain.T @ standard[~is_inside]
        variance = (
            LEVEL
            + event_variance
            + noise
            - np.einsum("oi,oi->i", matrix[np.ix_(~is_inside, is_inside)], gain)
        )
        assert quantity.left_out.spreads[is_inside] == pytest.approx(np.sqrt(variance))
        assert quantity.left_out.residuals[is_inside] == pytest.approx(residual / np.sqrt(variance))


@pytest.mark.parametrize("count", [3, 4, 9])
def test_few_similar_tests_stay_uncertain(count):
    values = np.append(np.full(count - 1, 2.0), 2.5)
    low, high = fit(values, np.arange(count)).quantiles(NEXT, (0.05, 0.95))[:, 0]
    assert high - low > 0.5


def test_residuals_without_an_earthquake_equal_a_refit():
    """Residuals of the other tests, against conditioning without any test of that earthquake."""
    rng = np.random.default_rng(24)
    events = np.array([0, 0, 1, 2, 2, 2, 3, 4, 4])
    quantity = fit(rng.normal(size=9), events)
    event_variance, noise = np.exp(2.0 * quantity.variances.mode)
    standard = (quantity.values - quantity.centre) / quantity.spread
    matrix = (
        LEVEL + event_variance * (events[:, None] == events) + np.diag(noise / quantity.variances.weights)
    )
    for absent in range(5):
        residuals = quantity.left_out.residuals_without(np.flatnonzero(events == absent))
        for event in {0, 1, 2, 3, 4} - {absent}:
            is_inside, rivals = events == event, (events != event) & (events != absent)
            gain = np.linalg.solve(matrix[np.ix_(rivals, rivals)], matrix[np.ix_(rivals, is_inside)])
            variance = (
                LEVEL
                + event_variance
                + noise
                - np.einsum("oi,oi->i", matrix[np.ix_(rivals, is_inside)], gain)
            )
            reference = (standard[is_inside] - gain.T @ standard[rivals]) / np.sqrt(variance)
            assert residuals[is_inside] == pytest.approx(reference)


def scatter_of(residuals):
    return ResidualDistribution.fit(np.asarray(residuals), np.arange(len(residuals)).astype(str))


def test_scatter_is_normal_unless_tests_say_otherwise():
    scatter = scatter_of(scipy.stats.norm.ppf((np.arange(60) + 0.5) / 60))
    position = np.linspace(-3.0, 3.0, 7)
    assert scatter.cumulative(position) == pytest.approx(scipy.stats.norm.cdf(position), abs=0.01)


def test_scatter_learns_a_longer_side():
    scatter = scatter_of(scipy.stats.gamma.ppf((np.arange(200) + 0.5) / 200, 1.5) - 1.5)
    assert scatter.quantile(0.95) > -1.4 * scatter.quantile(0.05)


def test_one_test_far_off_does_not_widen_the_scatter():
    usual = np.random.default_rng(23).normal(size=30)
    assert scatter_of(np.where(np.arange(30) == 3, 40.0, usual)).quantile(0.95) < 3.0


def test_density_of_scatter_is_the_derivative_of_its_probability():
    scatter = scatter_of(np.random.default_rng(25).standard_t(3, size=40))
    position, step = np.linspace(-5.0, 5.0, 11), 1e-5
    difference = (scatter.cumulative(position + step) - scatter.cumulative(position - step)) / (2.0 * step)
    assert np.exp(scatter.log_density(position)) == pytest.approx(difference, rel=1e-6)
    assert scatter.cumulative([scatter.quantile(0.3)])[0] == pytest.approx(0.3)
    samples = np.sinh(np.linspace(-7.0, 7.0, 4_001))
    mean = np.trapezoid(samples * np.exp(scatter.log_density(samples)), samples)
    assert mean == pytest.approx(0.0, abs=0.02)


def test_baselines_are_student_distributions():
    values = np.arange(20.0)
    assert pool(values).scale == pytest.approx(values.std(ddof=1) * np.sqrt(1.05))
    assert (last_ten(values).centre, last_ten(values).degrees) == (14.5, 9.0)
    names = np.arange(20).astype(str)
    scores = score_left_out_events(values, names, last_ten, only_earlier=True)
    assert np.isnan(scores[:3]).all()
    assert scores[12] == pytest.approx(pool(values[2:12]).log_density(12.0))


def test_the_posterior_of_the_variances_states_its_draws():
    variances = fit(np.random.default_rng(3).normal(size=24), np.arange(24) // 3).variances
    assert variances.respects == ("event",)
    assert variances.r_hat < 1.1
    assert variances.effective_size > 30.0


@pytest.mark.slow
def test_posterior_equals_emcee():
    """Draws by importance against chains that walk with nothing but the density."""
    rng = np.random.default_rng(31)
    events = np.arange(30) // 3
    values = rng.normal(size=10)[events] + 0.7 * rng.normal(size=30)
    variances = fit(values, events).variances
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
    ("count", "motions_of_event", "odd", "seeds"),
    [(3, 1, 0.0, 100), (5, 1, 0.0, 100), (10, 1, 0.0, 60), (30, 3, 0.0, 40), (120, 3, 0.05, 12)],
)
def test_intervals_have_their_coverage(count, motions_of_event, odd, seeds):
    assert 0.86 < share_covered(count, seeds, motions_of_event, odd) < 0.94
