"""The normal approximation of a normal posterior is this posterior, in units of any size."""

from types import SimpleNamespace

import numpy as np
import pytest

from reliab.sampling.ensembles import Laplace

COVARIANCE = np.array([[4e-6, 9e-4], [9e-4, 0.36]])
MODE = np.array([1.003, 7.2])


def model_of(covariance, spreads):
    inverse = np.linalg.inv(covariance)

    def log_posterior(values):
        away = values - MODE
        return -0.5 * np.einsum("nd,de,ne->n", away, inverse, away)

    means = MODE + 0.5 * np.sqrt(np.diag(covariance))
    parameters = [
        SimpleNamespace(mean=mean, spread=spread) for mean, spread in zip(means, spreads, strict=True)
    ]
    return SimpleNamespace(parameters=parameters, log_posterior=log_posterior)


def test_mode_and_covariance_of_a_normal_posterior_come_back():
    result = Laplace.about_mode(model_of(COVARIANCE, (0.01, 3.0)))
    assert result.mode == pytest.approx(MODE, rel=1e-4)
    np.testing.assert_allclose(result.factor @ result.factor.T, COVARIANCE, rtol=1e-3)


def test_the_approximation_is_nowhere_wider_than_the_prior():
    narrow = (5e-4, 0.1)
    result = Laplace.about_mode(model_of(COVARIANCE, narrow))
    np.testing.assert_allclose(np.sqrt(np.diag(result.factor @ result.factor.T)), narrow, rtol=0.03)


def test_draws_about_the_mode_reach_as_far_as_is_asked():
    result = Laplace.about_mode(model_of(COVARIANCE, (0.01, 3.0)))
    draws = result.around(20_000, 1.7, np.random.default_rng(1))
    np.testing.assert_allclose(np.cov(draws.T), 1.7**2 * COVARIANCE, rtol=0.05)
    np.testing.assert_allclose(draws.mean(axis=0), MODE, rtol=0.01)


def test_leaps_keep_the_balance_of_their_proposals():
    """Weighted by the Hastings factor, proposals from a Student-t count as draws of the approximation."""
    result = Laplace.about_mode(model_of(COVARIANCE, (0.01, 3.0)))
    walkers = result.around(4000, 1.0, np.random.default_rng(2))
    proposal, factors = result._leap(walkers, np.random.RandomState(3))  # noqa: SLF001 - as emcee calls it
    posterior = model_of(COVARIANCE, (1.0, 1.0)).log_posterior
    is_accepted = (
        np.log(np.random.default_rng(4).uniform(size=4000))
        < posterior(proposal) - posterior(walkers) + factors
    )
    second = np.where(is_accepted[:, None], proposal, walkers)
    np.testing.assert_allclose(np.cov(second.T), COVARIANCE, rtol=0.1)
    assert 0.4 < is_accepted.mean() < 0.98
