"""Simulation-based calibration: ranks of true parameters are uniform, for each model.

Parameters are drawn from the prior, data from the model at these parameters, and a posterior from the data.
If all is right, the rank of the true parameter among draws of its posterior is uniform (Talts, S. and others
2018, Validating Bayesian inference algorithms with simulation-based calibration, arXiv:1804.06788).
"""

import numpy as np
import pytest
from normal_values import NormalValues
from scipy.stats import chisquare, kstest

from reliab.criterion.methods.hierarchical.model import Hierarchical
from reliab.sampling.ensembles import Ensembles, draw

DRAWS = 99  # of a posterior, among which the true parameter is ranked
EVENTS = np.repeat([f"E{number}" for number in range(6)], 2)


def hierarchical(**options):
    return Hierarchical(
        values=np.zeros((12, 2, 3, 2)),
        events=EVENTS,
        frequencies=np.array([0.5, 2.0]),
        damping_ratios=np.array([0.02, 0.05, 0.1]),
        **options,
    )


MODELS = {
    "normal_values": (NormalValues(values=np.zeros(12)), 200),
    "hierarchical": (hierarchical(), 1000),
    "hierarchical_curved": (hierarchical(has_curvature=True), 1000),
    "hierarchical_robust": (hierarchical(robust=True), 1000),
}


def calibration_ranks(model, *, fits, steps, seed=2017):
    """Rank true parameters among draws of their posteriors, shape (fits, parameters)."""
    rng = np.random.default_rng(seed)
    ranks = np.empty((fits, len(model.parameters)), dtype=np.int64)
    for number, truth in enumerate(model.draw_prior(fits, rng)):
        settings = Ensembles(steps=steps, count=1, seed=seed + number)
        posterior = draw(model.simulate(truth, rng), settings)
        ranks[number] = (rng.choice(posterior.flat, DRAWS, replace=False) < truth).sum(axis=0)
    return ranks


def deviation(ranks):
    """Least p-value over the parameters, as one of that many."""
    uniform = (ranks + 0.5) / (DRAWS + 1)
    p_values = np.array([kstest(item, "uniform").pvalue for item in uniform.T])
    return min(1.0, p_values.min() * p_values.size)


@pytest.mark.slow
def test_ranks_are_uniform_over_a_few_fits():
    model, steps = MODELS["normal_values"]
    assert deviation(calibration_ranks(model, fits=20, steps=steps)) > 0.01


@pytest.mark.slow
@pytest.mark.parametrize("name", MODELS)
def test_ranks_are_uniform_over_many_fits(name):
    model, steps = MODELS[name]
    ranks = calibration_ranks(model, fits=100 if "robust" in name else 200, steps=steps)
    counts = np.stack(
        [np.histogram(parameter_draws, np.linspace(0, DRAWS + 1, 11))[0] for parameter_draws in ranks.T]
    )
    p_values = chisquare(counts, axis=1).pvalue
    assert p_values.min() * p_values.size > 0.01
    assert deviation(ranks) > 0.01


@pytest.mark.slow
def test_a_wrong_posterior_is_found_out():
    class Overconfident(NormalValues):
        def log_likelihood(self, theta):
            return 4.0 * super().log_likelihood(theta)

    ranks = calibration_ranks(Overconfident(values=np.zeros(12)), fits=40, steps=200)
    assert deviation(ranks) < 0.01


@pytest.mark.default_cases(1)
@pytest.mark.parametrize("name", MODELS)
def test_priors_cover_plausible_structures(name):
    model, rng = MODELS[name][0], np.random.default_rng(2017)
    samples = np.stack([model.simulate(theta, rng).data for theta in model.draw_prior(1000, rng)])
    low, middle, high = np.exp(np.quantile(samples, [0.025, 0.5, 0.975]))
    # α and β of real records lie between 0.03 and 5; no prior may rule that out or expect the absurd.
    assert low < 0.03
    assert 0.1 < middle < 1.0
    assert 5.0 < high < 1e4
