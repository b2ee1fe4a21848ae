"""What must hold for every distribution of an ellipse parameter."""

from typing import Any

import numpy as np
import pytest
from scipy import integrate, stats

from reliab.core.errors import InputError
from reliab.criterion.distributions import DISTRIBUTIONS, Empirical

SKEW_NORMAL: Any = DISTRIBUTIONS["skew_normal"]
EACH_DISTRIBUTION = pytest.mark.parametrize("family", DISTRIBUTIONS.values(), ids=DISTRIBUTIONS)
SOURCES = {
    "lognormal": stats.lognorm(0.6, scale=1e-4),
    "student_t": stats.lognorm(0.6, scale=1e-4),
    "skew_normal": stats.lognorm(0.6, scale=1e-4),
    "gamma": stats.gamma(2.5, scale=1e-4),
    "weibull": stats.weibull_min(1.6, scale=1e-4),
    "gaussian_mixture": stats.lognorm(0.6, scale=1e-4),
    "empirical": stats.lognorm(0.6, scale=1e-4),
}


@pytest.fixture(scope="module")
def values():
    return SOURCES["lognormal"].rvs(200, random_state=np.random.default_rng(1))


@EACH_DISTRIBUTION
def test_the_density_is_the_slope_of_the_cumulative(family, values):
    fit = family.fit(values)
    x = np.quantile(values, np.linspace(0.02, 0.98, 25))
    step = 1e-5 * x
    slope = (fit.cumulative(x + step) - fit.cumulative(x - step)) / (2.0 * step)
    np.testing.assert_allclose(np.exp(fit.log_density(x)), slope, rtol=1e-4)


@pytest.mark.default_cases(2)
@EACH_DISTRIBUTION
def test_the_density_integrates_to_one(family, values):
    fit = family.fit(values)
    total, _ = integrate.quad(lambda t: float(np.exp(fit.log_density(np.exp(t)) + t)), -22.0, 5.0, limit=500)
    assert total == pytest.approx(1.0, abs=1e-3)


@EACH_DISTRIBUTION
def test_the_quantile_inverts_the_cumulative(family, values):
    fit = family.fit(values)
    probability = np.array([1e-4, 0.01, 0.05, 0.5, 0.95, 0.999])
    np.testing.assert_allclose(fit.cumulative(fit.quantile(probability)), probability, rtol=1e-6)


@EACH_DISTRIBUTION
def test_the_fit_does_not_depend_on_the_unit(family, values):
    small_sample = values[:60]
    np.testing.assert_allclose(
        family.fit(1e6 * small_sample).quantile(0.05),
        1e6 * family.fit(small_sample).quantile(0.05),
        rtol=2e-4,
    )


@EACH_DISTRIBUTION
def test_quantiles_of_its_own_kind_are_recovered(family):
    source = SOURCES[family.name]
    fit = family.fit(source.rvs(5_000, random_state=np.random.default_rng(7)))
    for probability in (0.05, 0.5, 0.9):
        assert float(fit.quantile(probability)) == pytest.approx(source.ppf(probability), rel=0.04)


@pytest.mark.parametrize(
    "family", [each for each in DISTRIBUTIONS.values() if each is not Empirical], ids=lambda each: each.name
)
def test_no_neighbour_is_likelier(family, values):
    """The fit is a maximum: values scaled a little are less likely under it than the values themselves."""
    fit = family.fit(values)
    here = fit.log_density(values).sum()
    for factor in (0.97, 1.03):
        assert (fit.log_density(factor * values) + np.log(factor)).sum() < here


@EACH_DISTRIBUTION
@pytest.mark.parametrize("wrong", [[1.0, 2.0], [1.0, 2.0, 0.0], [1.0, np.nan, 2.0], [3.0, 3.0, 3.0]])
def test_fit_refuses_unusable_values(family, wrong):
    with pytest.raises(InputError):
        family.fit(wrong)


def test_a_heavy_tail_is_recognised():
    heavy = np.exp(stats.t(3.0).rvs(2000, random_state=np.random.default_rng(3)))
    light = np.exp(stats.norm().rvs(2000, random_state=np.random.default_rng(3)))
    family: Any = DISTRIBUTIONS["student_t"]
    assert family.fit(heavy).degrees_of_freedom == pytest.approx(3.0, rel=0.25)
    assert family.fit(light).degrees_of_freedom > 20.0


@pytest.mark.parametrize("shape", [-4.0, 0.0, 4.0])
def test_skewness_is_recognised(shape):
    samples = np.exp(stats.skewnorm(shape).rvs(5000, random_state=np.random.default_rng(5)))
    assert SKEW_NORMAL.fit(samples).shape == pytest.approx(shape, abs=0.8)


def test_the_smaller_of_two_correlated_normals_is_skew_normal():
    """Azzalini's property on which the joint bound rests."""
    pair = np.random.default_rng(9).multivariate_normal([0.0, 0.0], [[1.0, 0.6], [0.6, 1.0]], 40_000)
    fit = SKEW_NORMAL.fit(np.exp(pair.min(axis=1)))
    expected = -np.sqrt((1.0 - 0.6) / (1.0 + 0.6))
    assert fit.shape == pytest.approx(expected, abs=0.12)
