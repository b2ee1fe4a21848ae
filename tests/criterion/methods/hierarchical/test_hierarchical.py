"""The hierarchical posterior as a criterion."""

from dataclasses import replace

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.criterion.criterion import Criterion
from reliab.criterion.derivation import Derivation, derive_criterion
from reliab.criterion.laws.dimensionless import Dimensionless
from reliab.criterion.laws.exponential import Exponential
from reliab.criterion.laws.power import Power
from reliab.criterion.methods.hierarchical.fit import hierarchical_model
from reliab.criterion.methods.hierarchical.method import HierarchicalNormal
from reliab.criterion.methods.predictive import Predictive
from reliab.criterion.methods.registry import method_of
from reliab.criterion.population import Population
from reliab.sampling.ensembles import Laplace
from reliab.sampling.posterior_sample import ConvergenceWarning

ERROR = {"threshold": 0.05, "metric": "rms"}
GRID = np.array([0.5, 1.0, 2.0])[:, None], np.array([0.02, 0.05])


def derivation(ellipses, method, **options):
    return Derivation.from_ellipses(ellipses, method=method, **{**ERROR, **options})


def posterior_of(fit):
    return fit.lag.learned.posterior


@pytest.fixture(scope="module")
def fit(ellipses):
    return derivation(ellipses, HierarchicalNormal(steps=300), law=Power)


def sizes(criterion):
    return np.log(np.stack(criterion.limits(*GRID)))


@pytest.mark.slow
def test_limits_are_near_those_of_each_structure_alone(ellipses, fit):
    result = fit.criterion(0.95, joint=False)
    separate = derive_criterion(ellipses, method=Predictive(), joint=False, **ERROR)
    np.testing.assert_allclose(sizes(result), sizes(separate), atol=0.35)


@pytest.mark.slow
def test_joint_limits_are_smaller(fit):
    assert (sizes(fit.criterion(0.95)) < sizes(fit.criterion(0.95, joint=False))).all()


def change_assurance(fit, assurance):
    lag = replace(fit.lag, learned=replace(fit.lag.learned, assurance=assurance))
    return replace(fit, lag=lag)


@pytest.mark.slow
def test_an_assurance_makes_limits_smaller_and_more_of_it_smaller_still(fit):
    def assured(assurance):
        return sizes(change_assurance(fit, assurance).criterion(0.95))

    predictive, weak, strong = assured(None), assured(0.5), assured(0.95)
    assert (strong < weak - 0.05).all()
    assert (strong < predictive).all()


@pytest.mark.slow
def test_the_assured_bound_is_the_quantile_over_draws_of_the_populations_own_quantile(fit):
    """At one structure and for a alone each draw's quantile is known in closed form."""
    theta = posterior_of(fit).spread_out(4000)
    model = fit.lag.learned.model
    covariance = model.covariances(theta)
    eta = model.grid.eta[0]
    covariance_of_effect = dict(zip(model.grid.effects, np.moveaxis(covariance[..., 0], 1, 0), strict=True))
    variance = sum(
        item * (eta**2 if "slope" in name else 1.0) for name, item in covariance_of_effect.items()
    )  # of ln α over motions
    centre = np.einsum("wt,t->w", model.coefficients(theta)[..., 0], model.terms[0, 0])
    quantiles = centre - 1.6449 * np.sqrt(variance)
    limits = change_assurance(fit, 0.9).lag.learned.limits(0.95, joint=False)
    assert np.log(limits[0, 0, 0] / 0.02**2) == pytest.approx(np.quantile(quantiles, 0.1), abs=0.03)


@pytest.mark.slow
def test_a_short_run_is_confessed_in_words_settings_and_by_a_warning(ellipses):
    with pytest.warns(ConvergenceWarning, match="NOT CONVERGED"):
        result = derive_criterion(ellipses, method="hierarchical", steps=20, **ERROR)
    assert result.provenance.settings["converged"] is False
    assert "NOT CONVERGED" in result.provenance.warnings[0]
    assert any("R-hat" in sentence for sentence in result.provenance.warnings)
    assert Criterion.from_json(result.to_json()) == result


@pytest.mark.slow
def test_chains_in_a_file_serve_a_further_confidence_and_one_file_serves_all_errors(ellipses, tmp_path):
    method = HierarchicalNormal(steps=40)
    file = tmp_path / "chains.h5"
    ellipses = ellipses.sel(f=[1.0], xi=[0.02])
    first = derivation(ellipses, method, chains=file)
    derivation(ellipses.assign_coords(threshold=[0.1]), method, threshold=0.1, chains=file)
    options = []
    second = derivation(ellipses, method, chains=file, progress=lambda *step: options.append(step))
    np.testing.assert_array_equal(posterior_of(second).draws, posterior_of(first).draws)
    assert not options


@pytest.mark.slow
def test_posterior_law_is_the_requested_law(ellipses, fit):
    assert fit.criterion(0.95).law.name == "power"
    assert not fit.lag.learned.model.has_curvature
    quick = HierarchicalNormal(steps=20)
    assert derivation(ellipses, quick, law=Dimensionless).lag.learned.model.has_curvature
    with pytest.raises(InputError, match="do not take this law"):
        derivation(ellipses, quick, law=Exponential)


@pytest.mark.slow
def test_diagnostics_name_every_parameter(fit):
    (result,) = fit.diagnostics
    assert [item["parameter"] for item in result["parameters"]] == list(posterior_of(fit).names)
    assert {"r_hat", "bulk_size", "tail_size", "autocorrelation_time"} <= set(result["parameters"][0])
    assert (result["ensembles"], result["steps"], result["converged"]) == (4, 300, False)


@pytest.mark.slow
def test_missing_ellipses_are_drawn_and_leave_the_spread_as_it_is(ellipses):
    """The greatest tenth at the most damped structures is lost, as it is for real motions."""
    full = hierarchical_model(Population.from_ellipses(ellipses, **ERROR))
    lacking = ellipses.copy(deep=True)
    for k in range(3):
        a = lacking["a"].values[:, k, 1]
        a[a >= np.quantile(a, 0.9)] = np.nan
    assert 6 <= np.isnan(lacking["a"].values).any(axis=(1, 2)).sum() <= 18
    model = hierarchical_model(Population.from_ellipses(lacking, **ERROR))
    assert model.values.shape == full.values.shape

    complete = lacking.isel(motion=~np.isnan(lacking["a"].values).any(axis=(1, 2)).ravel())
    narrow = hierarchical_model(Population.from_ellipses(complete, **ERROR))

    def quantile(model):
        theta = Laplace.about_mode(model).mode[None]
        samples = model.draw_motions(theta, np.arange(20_000), np.random.default_rng(1))[0]
        return np.quantile(samples[:, 1, 1, 0], 0.05)

    assert abs(quantile(model) - quantile(full)) < abs(quantile(narrow) - quantile(full))
    assert quantile(model) == pytest.approx(quantile(full), abs=0.1)


def test_method_refuses_unknown_settings():
    with pytest.raises(InputError, match="quantile has no assurance"):
        method_of("quantile", assurance=0.9)
    with pytest.raises(InputError, match="tolerance has no steps"):
        method_of("tolerance", steps=100)
    with pytest.raises(InputError, match="hierarchical_robust"):
        method_of("magic")


def test_chains_without_a_posterior_are_refused(ellipses):
    with pytest.raises(InputError, match="have chains"):
        derive_criterion(ellipses, chains="chains.h5", **ERROR)
