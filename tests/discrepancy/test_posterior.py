"""The sampled posterior agrees with what can be computed otherwise."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import stats

from reliab.discrepancy.blocks.specimen import SpecimenBlock
from reliab.discrepancy.campaign.campaign import Campaign, Channel, MeasuredTest
from reliab.discrepancy.fitting.fit import CorrectedSketch, fit
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.fitting.space import MODEL_ERROR, ModelSpace
from reliab.discrepancy.posterior import (
    ENOUGH,
    LikelihoodSurface,
    agreement_of,
    sample_posterior,
)
from reliab.discrepancy.segment import cut_segments, motions_of, scales_of
from reliab.effects.registry import find_effect
from reliab.sampling.importance import draw_by_importance
from reliab.signals.noise import NoiseModel
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.hybrid_test.open_loop import Motion3, load
from reliab.structures.frame import Specimen

RATE, NOISE = 256.0, 2.0
SPECIMEN = Specimen(stiffness=2000.0)


def displacement(rng):
    t = np.arange(0.0, 24.0, 1.0 / RATE)
    waves = [np.sin(2 * np.pi * f * t + rng.uniform(0, 7)) for f in rng.uniform(0.4, 2.0, 6)]
    return 0.01 * np.sum(waves, axis=0) * np.sin(np.pi * t / t[-1]) ** 2


def problem_with(effect, seed, noise=NOISE):
    rng = np.random.default_rng(seed)
    tests = []
    for k in range(4):
        command = displacement(rng)
        force = load(
            HybridTest(specimen=SPECIMEN, effects=(effect,)), Motion3.interpolate(command, 1.0 / RATE)
        )
        channels = {
            Channel.COMMAND: command,
            Channel.MEASURED: command,
            Channel.FORCE: force + noise * rng.standard_normal(force.size),
        }
        tests.append(MeasuredTest(file=f"{k}", motion="waves", held_out=k == 3, channels=channels))
    campaign = Campaign(
        name="", structure=None, mass=1.0, actuator=None, specimen=SPECIMEN, rate=RATE, tests=tuple(tests)
    )
    motions = motions_of(campaign)
    block = SpecimenBlock(campaign, scales_of(campaign, motions), motions)
    return Problem(block=block, segments=cut_segments(campaign.training, RATE, lambda _: 40.0))


def fit_effect(problem, name, noise=NOISE):
    space = ModelSpace(problem.block, (find_effect(name),))
    start = next(space.starts(ModelSpace(problem.block, ()), np.zeros(ModelSpace(problem.block, ()).size)))
    return fit(problem, space, [start], NoiseModel.white(RATE, noise**2))


@pytest.fixture(scope="module")
def damping_posterior():
    effect = find_effect("viscous_damping")(damping_n_s_per_m=30.0)
    problem = problem_with(effect, 1)
    model_fit = fit_effect(problem, "viscous_damping")
    return problem, model_fit, sample_posterior(problem, model_fit)


@pytest.mark.slow
def test_a_linear_effect_has_the_posterior_of_least_squares(damping_posterior):
    _, model_fit, posterior = damping_posterior
    exact = model_fit.space.standard_deviations(model_fit.coordinates, model_fit.covariance)
    slope = model_fit.jacobian.T @ model_fit.residual + model_fit.coordinates
    mode = model_fit.space.values(model_fit.coordinates - model_fit.covariance @ slope)
    assert (exact > MODEL_ERROR * np.abs(mode)).all()
    spreads, low, high = np.array([posterior.spread_of(name) for name in posterior.names]).T
    np.testing.assert_allclose(spreads, exact, rtol=0.06)
    np.testing.assert_allclose((posterior.draws.mean(axis=0) - mode) / exact, 0.0, atol=0.08)
    assert posterior.agreement > 0.99
    np.testing.assert_allclose(0.5 * (high - low), stats.norm.ppf(0.95) * exact, rtol=0.06)


@pytest.mark.slow
def test_convergence_is_reported(damping_posterior):
    posterior = damping_posterior[2]
    assert posterior.converged
    assert not posterior.simulated
    assert "48 were checked by simulation" in posterior.statement


@pytest.mark.slow
def test_the_truth_lies_within_four_standard_deviations(damping_posterior):
    name = "viscous_damping.damping_n_s_per_m"
    mean = damping_posterior[2].draws[:, damping_posterior[2].names.index(name)].mean()
    sd, low, high = damping_posterior[2].spread_of(name)
    assert abs(mean - 30.0) < 4.0 * sd
    assert low < mean < high


def draw_points(log_density, size, population, enough):
    rng = np.random.default_rng(2017)
    return draw_by_importance(
        log_density, size, rng, draws=4000, population=population, populations=24, enough=enough
    )


@pytest.mark.parametrize("highest", [9.0, 1.5])
def test_a_conjugate_posterior_is_met_exactly_and_cut_at_a_bound(highest):
    """Residual y − x with y = 3 and a standard normal prior of x: normal about 1.5, variance 1/2."""
    surface = LikelihoodSurface(
        centre=np.array([1.4]),
        axes=np.array([[0.7]]),
        bounds=(np.array([-9.0]), np.array([highest])),
        coefficients=np.array([[1.6], [-0.7], [0.0]]),  # 3 − (1.4 + 0.7 z)
    )
    standard, effective = draw_points(surface.log_density, 1, 4000, 2000.0)
    draws = surface.coordinates(standard)[:, 0]
    exact = stats.truncnorm(-np.inf, (highest - 1.5) / np.sqrt(0.5), loc=1.5, scale=np.sqrt(0.5))
    assert effective > 2000.0
    assert draws.max() <= highest
    assert draws.mean() == pytest.approx(exact.mean(), abs=0.04)
    assert draws.std() == pytest.approx(exact.std(), rel=0.06)


def sample_effect(name, values):
    """A specimen of one effect with little noise: its problem, fit and posterior."""
    problem = problem_with(find_effect(name)(**values), 2, noise=0.5)
    model_fit = fit_effect(problem, name, noise=0.5)
    return problem, model_fit, sample_posterior(problem, model_fit)


FRICTION = {"force_n": 4.0, "regularisation_velocity_m_per_s": 3e-3}


@pytest.fixture(scope="module")
def rubbing():
    return sample_effect("coulomb_friction", FRICTION)


def assert_values_come_back(posterior, name, values):
    for parameter, truth in values.items():
        key = f"{name}.{parameter}"
        mean = posterior.draws[:, posterior.names.index(key)].mean()
        assert abs(mean - truth) < 4.0 * posterior.spread_of(key)[0]


@pytest.mark.slow
def test_the_surface_agrees_with_simulations_where_the_data_are_good(rubbing):
    assert rubbing[2].agreement > 0.99
    assert_values_come_back(rubbing[2], "coulomb_friction", FRICTION)


@pytest.mark.slow
def test_the_surface_of_a_stiffness_agrees_with_simulations():
    values = {"cubic_n_per_m3": 1e5}
    posterior = sample_effect("cubic_stiffness", values)[2]
    assert posterior.agreement > 0.9
    assert_values_come_back(posterior, "cubic_stiffness", values)


@pytest.mark.slow
def test_failing_surface_is_detected(rubbing):
    """Simulated far beyond where the data leave the posterior, a polynomial does not follow friction."""
    problem, model_fit, _ = rubbing
    careless = replace(model_fit, jacobian=1e-3 * model_fit.jacobian)
    surface = LikelihoodSurface.around(problem, careless)
    draws = 0.1 * np.random.default_rng(3).standard_normal((48, model_fit.space.size))
    assert agreement_of(problem, careless, surface, draws) < 0.5


def test_beyond_a_bound_nothing_is_probable_nor_simulated(damping_posterior):
    problem, model_fit, _ = damping_posterior
    surface = LikelihoodSurface.around(problem, model_fit)
    excess = np.linalg.solve(surface.axes, [0.0, 0.0, 1e9])[np.newaxis]
    assert surface.log_density(excess) == surface.simulate_density(None, None, excess) == -np.inf
    assert agreement_of(problem, model_fit, surface, 0.01 * np.ones((8, 3))) > 0.99


def test_constant_error_of_a_sketch_moves_no_parameter(damping_posterior):
    """Five times the noise at every frequency, of a model that is linear in its parameters."""
    problem, model_fit, _ = damping_posterior
    sketch = SimpleNamespace(whiten=lambda *arguments: problem.whiten(*arguments) + 5.0)
    surface = LikelihoodSurface.around(problem, model_fit)
    draws = np.random.default_rng(3).standard_normal((8, model_fit.space.size))
    np.testing.assert_allclose(
        surface.simulate_density(CorrectedSketch(sketch, model_fit), model_fit, draws),
        surface.simulate_density(problem, model_fit, draws),
        rtol=1e-9,
    )


def test_too_few_draws_have_not_converged(damping_posterior):
    doubtful = replace(damping_posterior[2], effective=0.9 * ENOUGH)
    assert not doubtful.converged
    assert "have not converged" in doubtful.statement


@pytest.mark.parametrize(("wider", "offset"), [(3.0, 1.0), (0.4, 0.5), (1.0, 2.0)])
def test_draws_by_importance_find_the_posterior_from_a_poor_beginning(damping_posterior, wider, offset):
    """The posterior is that of least squares; the normal approximation stands apart and has another width."""
    problem, model_fit, _ = damping_posterior
    sd = np.sqrt(np.diag(model_fit.covariance))
    slope = model_fit.jacobian.T @ model_fit.residual + model_fit.coordinates
    mode = model_fit.coordinates - model_fit.covariance @ slope
    surface = LikelihoodSurface.around(problem, model_fit)
    poor = replace(surface, centre=surface.centre + offset * sd, axes=wider * surface.axes)
    standard, effective = draw_points(
        lambda x: poor.simulate_density(problem, model_fit, x), sd.size, 300, ENOUGH
    )
    draws = poor.coordinates(standard)
    assert effective >= ENOUGH
    np.testing.assert_allclose((draws.mean(axis=0) - mode) / sd, 0.0, atol=4.0 / np.sqrt(effective))
    np.testing.assert_allclose(draws.std(axis=0) / sd, 1.0, atol=4.0 / np.sqrt(2.0 * effective))


@pytest.mark.parametrize(
    ("spread", "coupling", "statement"),
    [(0.5, 1.0, "ratio"), (0.5, -1.0, "product"), (0.1, 1.0, None), (0.5, 0.0, None)],
)
def test_inseparable_parameters_are_told_as_their_combination(damping_posterior, spread, coupling, statement):
    rng = np.random.default_rng(3)
    first, second, fine = rng.standard_normal((3, 4000))
    logs = spread * np.stack([first, coupling * first + (1.0 - abs(coupling)) * second + 0.02 * fine])
    posterior = replace(
        damping_posterior[2],
        names=("damper.c_n_s_per_m", "damper.x_m"),
        draws=np.exp(logs.T) * np.array([6.0, 2.0]),
    )
    sentences = posterior.inseparable(["damper"])
    value = {"ratio": "3", "product": "12", None: ""}[statement]
    assert len(sentences) == (statement is not None)
    assert all(f"their {statement} is {value}" in sentence for sentence in sentences)


@pytest.mark.slow
def test_intervals_cover_the_truth_as_often_as_they_say(damping_posterior):
    problem, model_fit, _ = damping_posterior
    surface = LikelihoodSurface.around(problem, model_fit)
    rng = np.random.default_rng(11)
    hits = 0
    for _ in range(200):
        truth = 0.5 * rng.standard_normal(surface.centre.size)
        coefficients = surface.coefficients.copy()
        coefficients[0] = (
            rng.standard_normal(coefficients.shape[1]) - truth @ coefficients[1 : truth.size + 1]
        )
        second_noise = replace(surface, coefficients=coefficients)
        draws = draw_points(second_noise.log_density, truth.size, 2000, 1000.0)[0]
        low, high = np.quantile(draws, (0.05, 0.95), axis=0)
        hits += int(((low < truth) & (truth < high)).sum())
    total = 200 * surface.centre.size
    assert stats.binomtest(hits, total, 0.9).pvalue > 1e-3
