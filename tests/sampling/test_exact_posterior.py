"""The sampler agrees with the posterior that is known exactly."""

import numpy as np
import pytest
from normal_values import REFERENCE_PRIOR, WEAK_PRIOR, NormalValues, drawn, updated
from scipy import stats

from reliab.sampling.ensembles import Ensembles, sample
from reliab.sampling.normal_inverse_chi_squared import NormalInverseChiSquared

SHARES = np.array([0.05, 0.25, 0.5, 0.75, 0.95])
VALUES = np.random.default_rng(2017).normal(-0.8, 0.6, 40)


@pytest.fixture(scope="module", params=[pytest.param("reference", marks=pytest.mark.slow), "weak"])
def posteriors(request):
    prior = REFERENCE_PRIOR if request.param == "reference" else WEAK_PRIOR
    samples = sample(NormalValues(values=VALUES, prior=prior), Ensembles(steps=400, walkers=16))
    return samples, updated(prior, VALUES)


def error_of_share(share, effective_size):
    return np.sqrt(share * (1.0 - share) / effective_size)


@pytest.mark.slow
def test_quantiles_of_mean_and_spread_are_exact_within_monte_carlo_error(posteriors):
    samples, exact = posteriors
    degrees, spread = exact.degrees_of_freedom, np.sqrt(exact.variance / exact.mean_weight)
    mu = stats.t.ppf(SHARES, degrees, exact.mean, spread)
    sigma = np.sqrt(degrees * exact.variance / stats.chi2.isf(SHARES, degrees))
    for place, quantiles in enumerate((mu, np.log(sigma))):
        result = (samples.flat[:, [place]] <= quantiles).mean(axis=0)
        size = min(samples.diagnostics.bulk_size[place], samples.diagnostics.tail_size[place])
        assert (np.abs(result - SHARES) < 4.0 * error_of_share(SHARES, size)).all()


def test_predictive_quantiles_are_exact_within_monte_carlo_error(posteriors):
    samples, exact = posteriors
    mu, log_sigma = samples.flat.T
    cumulative = stats.norm.cdf(exact.predictive_quantile(SHARES)[:, None], mu, np.exp(log_sigma)).mean(
        axis=1
    )
    assert (
        np.abs(cumulative - SHARES) < 4.0 * error_of_share(SHARES, samples.diagnostics.bulk_size.min())
    ).all()


@pytest.mark.parametrize("share", [0.1, 0.5, 0.95])
def test_quantiles_of_the_populations_quantile_are_those_of_draws(share):
    """Draws of μ and σ need neither Student's nor the non-central distribution."""
    exact = NormalInverseChiSquared.posterior(VALUES[:6])
    mu, sigma = drawn(exact, 40_000, np.random.default_rng(31))
    quantiles = mu + stats.norm.ppf(share) * sigma
    result = (quantiles[:, None] <= exact.quantile_of_quantile(share, SHARES)).mean(axis=0)
    assert (np.abs(result - SHARES) < 4.0 * error_of_share(SHARES, quantiles.size)).all()


def test_density_equals_conjugate_posterior():
    model = NormalValues(values=VALUES)
    exact = updated(WEAK_PRIOR, VALUES)
    mu, log_sigma = np.random.default_rng(1).normal([-0.8, -0.5], 0.3, (20, 2)).T
    variance = np.exp(2.0 * log_sigma)
    scaled_copy = exact.degrees_of_freedom * exact.variance
    density = (
        stats.norm.logpdf(mu, exact.mean, np.sqrt(variance / exact.mean_weight))
        + stats.invgamma.logpdf(variance, exact.degrees_of_freedom / 2.0, scale=scaled_copy / 2.0)
        + 2.0 * log_sigma  # from the variance to the logarithm of the spread
    )
    offset = model.log_posterior(np.stack([mu, log_sigma], axis=1)) - density
    np.testing.assert_allclose(offset, offset[0], rtol=1e-9)
