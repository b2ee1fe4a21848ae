"""A criterion protects every length of its population, where lengths tell something of limits."""

import numpy as np
import pytest

from reliab.criterion import derive_criterion, protect_over_lengths, read_ellipses
from reliab.criterion.carrying import carry_to_length

SELECTED = {"f": [0.5, 1.0, 2.0], "xi": [0.02, 0.05], "threshold": [0.05], "side": ["lag"]}


@pytest.fixture(scope="module")
def population():
    return read_ellipses("real_suite").sel(**SELECTED)


def test_at_each_structure_one_of_three_lengths_counts_and_it_is_the_least_favourable(population):
    protected = protect_over_lengths(population).sel(curve="inscribed", metric="rms").squeeze()
    lengths = np.quantile(population["duration"], [1 / 6, 1 / 2, 5 / 6])
    carried = [
        carry_to_length(population.sel(metric=["rms"]), float(length)).sel(curve="inscribed").squeeze()
        for length in lengths
    ]
    for name in ("a", "b"):
        low = [np.nanquantile(part[name].transpose("motion", ...), 0.05, axis=0) for part in carried]
        counted = np.nanquantile(protected[name].transpose("motion", ...), 0.05, axis=0)
        assert counted == pytest.approx(np.min(low, axis=0), rel=0.05)
        equal = [np.isclose(protected[name], part[name], equal_nan=True) for part in carried]
        assert np.any(equal, axis=0).all()


def test_other_errors_and_curves_stay_as_they_are(population):
    protected = protect_over_lengths(population)
    for other in ({"metric": "mte"}, {"metric": "rms", "curve": "ellipse"}):
        for name in ("a", "b"):
            np.testing.assert_array_equal(protected[name].sel(other), population[name].sel(other))


def test_short_records_are_protected_at_little_cost_of_area(population):
    whole = population.sel(curve=["inscribed"], metric=["rms"])
    protected, recorded = derive_criterion(whole), derive_criterion(whole.drop_vars("duration"))
    short = whole.isel(motion=population["duration"].values <= 25.0)
    shares, areas = [], []
    for criterion in (protected, recorded):
        a, b = criterion.limits(*np.meshgrid(SELECTED["f"], SELECTED["xi"], indexing="ij"))
        areas.append(np.sqrt(a * b))
        at = short.squeeze().transpose("motion", "f", "xi")
        inside = [~(at[name].values < limit) for name, limit in (("a", a), ("b", b))]
        shares.append(np.mean(inside[0] & inside[1]))
    assert shares[0] > shares[1]
    assert np.median(areas[0] / areas[1]) >= 0.85


@pytest.mark.parametrize(
    ("change", "options"),
    [
        (lambda ellipses: ellipses, {"metric": "mte"}),
        (lambda ellipses: ellipses, {"curve": "ellipse"}),
        (lambda ellipses: ellipses.assign_attrs(window="20"), {}),
        (lambda ellipses: ellipses.assign_attrs(experimental_fraction=0.5), {}),
        (lambda ellipses: ellipses.isel(motion=slice(29)), {}),
        (lambda ellipses: ellipses.drop_vars("duration"), {}),
        (lambda ellipses: ellipses.assign_coords(duration=("motion", np.full(100, 30.0))), {}),
        (lambda ellipses: carry_to_length(ellipses.sel(metric=["rms"]), 30.0), {}),
    ],
)
def test_a_population_that_shows_no_lengths_stays_as_it_is(population, change, options):
    ellipses = change(population)
    assert protect_over_lengths(ellipses, **options) is ellipses


def test_a_criterion_says_that_lengths_are_protected(population):
    assert "least favourable of" in derive_criterion(population).provenance.population
    assert "least" not in derive_criterion(population, method="quantile").provenance.population


def test_small_shares_are_of_all_lengths_together_as_recorded(population):
    together = protect_over_lengths(population, confidence=0.8)
    for name in ("a", "b"):
        np.testing.assert_array_equal(together[name], population[name])
    criterion = derive_criterion(population, confidence=0.8)
    assert "all lengths together" in criterion.provenance.population
    assert any("short records have less" in sentence for sentence in criterion.provenance.warnings)
    assert not any(
        "short records" in sentence for sentence in derive_criterion(population).provenance.warnings
    )


def test_limits_do_not_grow_with_the_share_where_protection_begins(population):
    places = np.meshgrid(SELECTED["f"], SELECTED["xi"], indexing="ij")
    below, from_there_on = (derive_criterion(population, confidence=share) for share in (0.899, 0.9))
    for smaller, larger in zip(from_there_on.limits(*places), below.limits(*places), strict=True):
        assert (smaller <= larger * 1.01).all()
