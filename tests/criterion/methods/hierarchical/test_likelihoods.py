"""Integrated likelihoods against dense covariance matrices and brute-force integration."""

import numpy as np
import pytest
from scipy import stats

from reliab.core.errors import InputError
from reliab.criterion.methods.hierarchical.model import Hierarchical, MotionMeans
from reliab.criterion.methods.hierarchical.strata import covariance_of, factor_of

EVENTS = np.array(["A", "A", "A", "B", "C", "C"])


def model_on(f_count, xi_count, *, seed=3, **options):
    values = np.random.default_rng(seed).normal(-1.0, 0.5, (EVENTS.size, f_count, xi_count, 2))
    return Hierarchical(
        values=values,
        events=EVENTS,
        frequencies=np.linspace(0.5, 2.0, f_count),
        damping_ratios=np.linspace(0.02, 0.1, xi_count),
        **options,
    )


def matrix(covariance):
    aa, bb, ab = covariance
    return np.array([[aa, ab], [ab, bb]])


def dense_log_density(model, theta):
    """The same model, effect by effect, as one large normal distribution."""
    motions, f_count, xi_count = model.values.shape[:3]
    eta, identity = model.grid.eta, np.eye
    event = (EVENTS[:, None] == EVENTS[None, :]).astype(float)
    ones_f, ones_xi, slopes = np.ones((f_count,) * 2), np.ones((xi_count,) * 2), np.outer(eta, eta)
    patterns = {
        "event": (event, ones_f, ones_xi),
        "motion": (identity(motions), ones_f, ones_xi),
        "motion, slope in ln ξ": (identity(motions), ones_f, slopes),
        "motion at a frequency": (identity(motions), identity(f_count), ones_xi),
        "motion at a frequency, slope in ln ξ": (identity(motions), identity(f_count), slopes),
        "remainder": (identity(motions), identity(f_count), identity(xi_count)),
    }
    total = 0.0
    for name, covariance in zip(model.grid.effects, model.covariances(theta[None])[0], strict=True):
        motion_pattern, f_pattern, xi_pattern = patterns[name]
        total = total + np.kron(np.kron(np.kron(motion_pattern, f_pattern), xi_pattern), matrix(covariance))
    law = np.einsum("tq,fxt->fxq", model.coefficients(theta[None])[0], model.terms)
    mean = np.broadcast_to(law, model.values.shape)
    return stats.multivariate_normal(mean.ravel(), total, allow_singular=True).logpdf(model.values.ravel())


@pytest.mark.parametrize("shape", [(3, 4), (1, 1), (2, 1), (1, 3), (3, 2)])
@pytest.mark.parametrize("has_curvature", [False, True])
def test_strata_give_the_likelihood_of_the_dense_normal_distribution(shape, has_curvature):
    model = model_on(*shape, has_curvature=has_curvature)
    theta = 0.7 * model.draw_prior(4, np.random.default_rng(1))
    dense = np.array([dense_log_density(model, item) for item in theta])
    difference = model.log_likelihood(theta) - dense
    np.testing.assert_allclose(difference, difference[0], rtol=1e-7)


@pytest.mark.slow
@pytest.mark.default_cases(2)
@pytest.mark.parametrize("degrees", [3.0, 10.0])
@pytest.mark.parametrize("outlier", [0.0, 4.0, 8.0])
def test_quadrature_over_event_effects_agrees_with_brute_force(degrees, outlier):
    rng = np.random.default_rng(3)
    groups = np.array([0, 0, 1, 1, 1, 1, 1, 2])
    means = 0.5 * rng.normal(size=(8, 2))
    means[1] += outlier
    means[4] -= outlier
    event_variance, motion_variance, centre = (
        np.array([0.3, 0.25, 0.2]),
        np.array([0.4, 0.3, 0.3]),
        np.array([-0.1, 0.2]),
    )
    result = MotionMeans(means=means, groups=groups).robust(
        centre[None], event_variance[None], motion_variance[None], np.array([degrees])
    )
    x = np.linspace(-6.0, 6.0, 601)
    effects = np.stack(np.meshgrid(x, x), axis=-1)
    exact = 0.0
    for event in range(3):
        density = stats.multivariate_normal([0.0, 0.0], matrix(event_variance)).pdf(effects)
        for mean in means[groups == event]:
            density *= stats.multivariate_t(centre, matrix(motion_variance), df=degrees).pdf(mean - effects)
        exact += np.log(density.sum() * (x[1] - x[0]) ** 2)
    # Constants that the likelihood leaves out: 1/2π of each motion's density, with those of the events.
    assert result[0] - exact == pytest.approx(8 * np.log(2.0 * np.pi) + 3 * np.log(2.0 * np.pi), abs=0.02)


def test_many_degrees_of_freedom_are_normal():
    normal, robust = model_on(2, 3), model_on(2, 3, robust=True)
    theta = normal.draw_prior(5, np.random.default_rng(2))
    heavy = np.column_stack([theta, np.full(5, np.log(1e9))])
    difference = robust.log_likelihood(heavy) - normal.log_likelihood(theta)
    np.testing.assert_allclose(difference, difference[0], rtol=1e-5)


def test_an_outlying_motion_costs_the_robust_model_less():
    normal, robust = model_on(2, 3), model_on(2, 3, robust=True)
    theta = np.array([parameter.mean for parameter in normal.parameters])[None]
    heavy = np.column_stack([theta, [[np.log(4.0)]]])

    def cost(model, vector):
        displacement = model.values.copy()
        displacement[0] += 4.0
        deviation = Hierarchical(**{**vars_of(model), "values": displacement})
        return (model.log_likelihood(vector) - deviation.log_likelihood(vector))[0]

    assert cost(robust, heavy) < 0.5 * cost(normal, theta)


def vars_of(model):
    names = ("values", "events", "frequencies", "damping_ratios", "has_curvature", "robust")
    return {name: getattr(model, name) for name in names}


@pytest.mark.slow
def test_simulated_motions_have_the_covariance_of_the_model():
    model = model_on(2, 3)
    theta = np.array([item.mean for item in model.parameters])
    rng = np.random.default_rng(5)
    samples = np.stack([model.simulate(theta, rng).values.ravel() for _ in range(6000)])
    densities = np.array([dense_log_density(model_of(model, item), theta) for item in samples[:400]])
    total = model.values.size
    # −2 ln of a normal density of dimension n about its greatest value has the mean n.
    mean_density = dense_log_density(model_of(model, samples.mean(axis=0)), theta)
    assert 2.0 * (mean_density - densities).mean() == pytest.approx(total, rel=0.05)


def model_of(model, values):
    return Hierarchical(**{**vars_of(model), "values": values.reshape(model.values.shape)})


def test_covariances_come_from_their_factors():
    covariance = covariance_of(np.random.default_rng(1).normal(size=(7, 3)))
    factor = factor_of(covariance)
    product = factor @ factor.swapaxes(-1, -2)
    np.testing.assert_allclose(product[:, 0, 0], covariance[:, 0])
    np.testing.assert_allclose(product[:, 1, 1], covariance[:, 1])
    np.testing.assert_allclose(product[:, 0, 1], covariance[:, 2])


def test_missing_ellipses_are_refused():
    values = np.zeros((6, 1, 1, 2))
    values[2] = np.nan
    with pytest.raises(InputError, match="1 motions without"):
        Hierarchical(values=values, events=EVENTS, frequencies=np.ones(1), damping_ratios=np.full(1, 0.02))


@pytest.mark.parametrize("robust", [False, True])
def test_singular_covariances_have_no_probability_and_spare_the_others(robust):
    model = model_on(2, 3, robust=robust)
    theta = model.draw_prior(6, np.random.default_rng(4))
    sound = model.log_posterior(theta)
    places = [k for k, parameter in enumerate(model.parameters) if "Fisher z" in parameter.name]
    theta[1, places] = 40.0
    result = model.log_posterior(theta)
    assert result[1] == -np.inf
    np.testing.assert_allclose(np.delete(result, 1), np.delete(sound, 1))
