"""Components of variance between and within earthquakes."""

import numpy as np
import pytest
from scipy import stats

from reliab.criterion.motion_predictive import MotionPredictive, event_components


def draw_motions(rng, sizes, event_variance, motion_variance):
    events = np.repeat(np.arange(len(sizes)), sizes)
    values = np.sqrt(event_variance) * rng.normal(size=len(sizes))[events]
    return values + np.sqrt(motion_variance) * rng.normal(size=events.size), events.astype(str)


def test_components_are_unbiased_for_unequal_earthquakes():
    rng = np.random.default_rng(3)
    sizes = [2, 2, 4, 6, 12, 2, 8, 2, 2, 4]
    result = [event_components(*draw_motions(rng, sizes, 0.5, 1.0)) for _ in range(3000)]
    assert np.mean([item.within for item in result]) == pytest.approx(1.0, rel=0.03)
    assert np.mean([item.between for item in result]) == pytest.approx(0.5, rel=0.08)


def test_effective_number_is_of_the_mean():
    """Equal earthquakes: n_eff = n / (1 + (m − 1) ρ), the design effect of cluster sampling."""
    values, events = draw_motions(np.random.default_rng(5), [5] * 40, 1.0, 1.0)
    result = event_components(values, events)
    expected = 200 / (1.0 + 4.0 * float(result.event_share))
    assert float(result.effective_number) == pytest.approx(expected)


def test_observed_event_means_scatter_even_where_earthquakes_do_not():
    """The naive share of variance between event means is large without any effect of the earthquake."""
    values, events = draw_motions(np.random.default_rng(6), [5] * 20, 0.0, 1.0)
    means = np.array([values[events == event].mean() for event in np.unique(events)])
    assert means.var() / values.var() > 0.12
    assert float(event_components(values, events).event_share) < 0.05


@pytest.mark.parametrize("events", [np.zeros(10), np.arange(10)])
def test_motions_count_as_independent_where_nothing_tells(events):
    result = event_components(np.arange(10.0), events.astype(int).astype(str))
    assert (float(result.between), float(result.effective_number)) == (0.0, 10.0)


def test_several_quantities_are_done_at_once():
    values, events = draw_motions(np.random.default_rng(7), [3] * 10, 1.0, 1.0)
    both = event_components(np.stack([values, values**2], axis=1), events)
    for column, item in enumerate((values, values**2)):
        separate = event_components(item, events)
        assert both.between[column] == pytest.approx(float(separate.between))
        assert both.effective_number[column] == pytest.approx(float(separate.effective_number))


@pytest.fixture(scope="module")
def predictive():
    values = np.random.default_rng(2).gamma(3.0, size=(60, 2)) * [1.0, -1.0]
    return MotionPredictive.fit(values, np.repeat(np.arange(20), 3).astype(str))


@pytest.mark.slow
def test_it_is_a_distribution(predictive):
    x = np.linspace(-30.0, 60.0, 4001)
    cumulative = np.array([predictive.cumulative(np.full(2, item)) for item in x])
    assert (np.diff(cumulative, axis=0) >= 0.0).all()
    np.testing.assert_allclose(cumulative[[0, -1]], [[0.0, 0.0], [1.0, 1.0]], atol=1e-6)


@pytest.mark.parametrize("probability", [1e-4, 0.01, 0.05, 0.5, 0.95, 0.999])
def test_the_quantile_inverts_it(predictive, probability):
    np.testing.assert_allclose(
        predictive.cumulative(predictive.quantile(probability)), probability, rtol=1e-6, atol=1e-9
    )


def test_many_motions_speak_for_themselves():
    """A shape that no skew-normal distribution has is learned all the same."""
    values = np.random.default_rng(3).choice([-1.0, 1.0], 20_000) * 3.0
    values += np.random.default_rng(4).normal(size=20_000)
    result = MotionPredictive.fit(values[:, None], np.arange(20_000).astype(str))
    truth = stats.norm.cdf(-3.5, -3.0) / 2.0 + stats.norm.cdf(-3.5, 3.0) / 2.0
    assert float(result.cumulative([-3.5])[0]) == pytest.approx(truth, abs=0.006)


@pytest.mark.slow
def test_few_normal_motions_get_the_bound_of_a_further_one_about_right():
    """On average over suites the stated share of further motions exceeds the bound."""
    rng = np.random.default_rng(5)
    for motions, tolerance in ((10, 0.03), (40, 0.015)):
        values = rng.normal(size=(motions, 2000))
        result = MotionPredictive.fit(values, np.arange(motions).astype(str))
        for confidence in (0.8, 0.9, 0.95):
            content = stats.norm.sf(result.quantile(1.0 - confidence)).mean()
            assert content == pytest.approx(confidence, abs=tolerance)


def test_motions_of_one_earthquake_widen_it():
    rng = np.random.default_rng(6)
    events = np.repeat(np.arange(8), 5)
    values = (rng.normal(size=8)[events] + 0.3 * rng.normal(size=40))[:, None]
    joint = MotionPredictive.fit(values, events.astype(str))
    separate = MotionPredictive.fit(values, np.arange(40).astype(str))
    assert joint.effective_number < 12.0 < separate.effective_number
    assert joint.quantile(0.01) < separate.quantile(0.01)


@pytest.mark.parametrize("power", [-0.6, -0.4, 0.3, 0.6])
def test_the_skew_normal_has_the_first_three_moments_of_the_sample(power):
    raw = np.random.default_rng(7).gamma(1.0, size=3000)
    values = np.sign(power) * raw ** abs(power)
    result = MotionPredictive.fit(values[:, None], np.arange(values.size).astype(str))
    moments = stats.skewnorm.stats(result.shape[0], result.location[0], result.scale[0], moments="mvs")
    np.testing.assert_allclose(moments, (values.mean(), values.var(), stats.skew(values)), rtol=1e-9)


def test_equal_values_and_an_outlier_do_no_harm():
    values = np.array([[0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 1e4]]).T
    result = MotionPredictive.fit(values, np.arange(7).astype(str))
    assert np.isfinite(result.quantile(0.05)).all()
