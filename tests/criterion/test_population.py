"""Probabilities from the motions behind a criterion."""

import numpy as np
import pytest
import xarray as xr
from scipy import stats

from reliab.core.errors import InputError
from reliab.criterion.laws.law import scales
from reliab.criterion.methods.dirichlet import Dirichlet
from reliab.criterion.population import Population, SampleGrid


def dataset(frequencies, damping_ratios, *, motions=400, correlation=0.95, seed=1):
    """Lognormal dimensionless ellipses, the same at every structure."""
    rng = np.random.default_rng(seed)
    cov = [[0.36, 0.3 * correlation], [0.3 * correlation, 0.25]]
    logarithms = rng.multivariate_normal([-1.0, -1.5], cov, motions)
    scale = scales(np.asarray(frequencies)[:, None], np.asarray(damping_ratios)[None, :])
    a, b = (np.exp(logarithms[:, k])[:, None, None] * scale[k] for k in range(2))
    dims = ("motion", "f", "xi", "threshold", "metric", "curve")
    return xr.Dataset(
        {name: (dims, values[:, :, :, None, None, None]) for name, values in (("a", a), ("b", b))},
        coords={
            "motion": np.arange(motions).astype(str),
            "event": ("motion", (np.arange(motions) // 2).astype(str)),
            "f": list(frequencies),
            "xi": list(damping_ratios),
            "threshold": [0.05],
            "metric": ["rms"],
            "curve": ["ellipse"],
        },
    )


@pytest.fixture(scope="module")
def population():
    return Population.from_ellipses(dataset([1.0], [0.02]), threshold=0.05, metric="rms")


def test_a_perfect_test_is_certain(population):
    assert float(population.probability(1.0, 0.0, 1.0, 0.02)) == 1.0


def test_a_larger_error_is_less_probable(population):
    size = np.linspace(0.0, 4.0, 60)
    for angle in (0.0, 0.5, 1.2, np.pi / 2.0, 2.5):
        probability = population.probability(
            1.0 + 0.01 * size * np.cos(angle), 0.0015 * size * np.sin(angle), 1.0, 0.02
        )
        assert (np.diff(probability) <= 1e-12).all()
        assert probability[-1] < 0.05


def test_both_signs_of_an_error_count_alike(population):
    upper = population.probability([1.008, 0.992, 1.008], [0.001, 0.001, -0.001], 1.0, 0.02)
    assert upper.tolist() == pytest.approx([float(upper[0])] * 3)


def test_on_the_axes_it_is_the_predictive_quantile(population):
    """A test with amplitude error alone is below the threshold where a exceeds (A − 1)²."""
    log_a = np.log(dataset([1.0], [0.02])["a"].values.ravel())
    events = (np.arange(400) // 2).astype(str)
    for confidence in (0.8, 0.95, 0.99):
        limit = np.exp(Dirichlet().lower_bound(log_a, events, confidence))
        result = population.probability(1.0 + np.sqrt(limit), 0.0, 1.0, 0.02)
        assert float(result) == pytest.approx(confidence, abs=1e-6)


def test_it_tends_to_the_truth_with_many_motions():
    truth = stats.multivariate_normal([-1.0, -1.5], [[0.36, 0.285], [0.285, 0.25]]).rvs(
        400_000, random_state=np.random.default_rng(5)
    )
    many = Population.from_ellipses(dataset([1.0], [0.02], motions=6000), threshold=0.05, metric="rms")
    scale_a, scale_b = scales(1.0, 0.02)
    for offset, delay in ((0.006, 0.001), (0.01, 0.0005), (0.002, 0.0015)):
        index = offset**2 / (scale_a * np.exp(truth[:, 0])) + (1e3 * delay) ** 2 / (
            scale_b * np.exp(truth[:, 1])
        )
        result = many.probability(1.0 + offset, delay, 1.0, 0.02)
        assert float(result) == pytest.approx((index <= 1.0).mean(), abs=0.015)


def test_between_structures_the_same_dimensionless_error_is_as_probable():
    """Where all structures are alike, so is every structure in between."""
    grid = Population.from_ellipses(dataset([0.5, 1.0, 2.0], [0.02, 0.05]), threshold=0.05, metric="rms")
    expected = float(grid.probability(1.0 + 0.4 * 0.02, 0.0, 0.5, 0.02))
    for f, xi in ((0.5, 0.05), (0.7, 0.03), (1.9, 0.021)):
        assert float(grid.probability(1.0 + 0.4 * xi, 0.0, f, xi)) == pytest.approx(expected)
        same_delay = grid.probability(1.0, 0.3 * xi / (2.0 * np.pi * f), f, xi)
        assert float(same_delay) == pytest.approx(float(grid.probability(1.0, 0.3 * 0.02 / np.pi, 0.5, 0.02)))


def test_structures_outside_of_the_grid_are_refused(population):
    with pytest.raises(InputError, match="does not hold for this natural frequency"):
        population.probability(1.0, 0.0, 2.0, 0.02)


def test_motions_without_an_ellipse_are_left_out():
    ellipses = dataset([1.0], [0.02], motions=10)
    ellipses["a"][0] = np.nan
    ellipses["b"][1] = -1.0
    result = Population.from_ellipses(ellipses, threshold=0.05, metric="rms")
    assert np.isnan(result.log_alpha).sum() == 2
    assert 0.0 < float(result.probability(1.01, 0.001, 1.0, 0.02)) < 1.0


def test_it_comes_back_from_plain_lists(population):
    second = Population.from_dict(population.to_dict())
    assert float(second.probability(1.008, 0.001, 1.0, 0.02)) == pytest.approx(
        float(population.probability(1.008, 0.001, 1.0, 0.02)), abs=1e-4
    )


def test_too_few_motions_are_refused():
    with pytest.raises(InputError, match=r"Too few motions.*found 2"):
        Population.from_ellipses(dataset([1.0], [0.02], motions=2), threshold=0.05, metric="rms")


def test_errors_may_stand_in_any_order():
    single = dataset([1.0], [0.02])
    both = xr.concat([single, single.assign_coords(threshold=[0.01])], "threshold")
    result, separate = (
        Population.from_ellipses(item, threshold=0.05, metric="rms") for item in (both, single)
    )
    assert np.array_equal(result.log_alpha, separate.log_alpha)


@pytest.mark.parametrize(("motions", "enough"), [(2, False), (3, True)])
def test_three_motions_must_have_an_ellipse_at_every_structure(motions, enough):
    ellipses = dataset([1.0, 2.0], [0.02], motions=5)
    is_missing = (np.arange(5) >= motions)[:, None] & (ellipses["f"].values == 2.0)
    for name in ("a", "b"):
        ellipses[name] = ellipses[name].where(~xr.DataArray(is_missing, dims=("motion", "f")))
    if enough:
        population = Population.from_ellipses(ellipses, threshold=0.05, metric="rms")
        assert np.isfinite(population.log_alpha).sum(axis=0).ravel().tolist() == [5, 3]
    else:
        with pytest.raises(InputError, match=r"needs 3; found 2"):
            Population.from_ellipses(ellipses, threshold=0.05, metric="rms")


def test_a_grid_counts_the_motions_of_its_poorest_structure(ellipses):
    gaps = ellipses.copy(deep=True)
    for name in ("a", "b"):
        gaps[name][:4, 0, 0] = np.nan  # all motions of one earthquake, and one of another
    grid = SampleGrid.from_ellipses(gaps, threshold=0.05, metric="rms", curve="ellipse", side="lag")
    assert (grid.fewest_motions, grid.fewest_events, grid.n_motions) == (56, 19, 60)
