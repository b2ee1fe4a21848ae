"""Limits, index and probability of a criterion."""

import json

import numpy as np
import pytest
import scipy

import reliab
from reliab.core.errors import InputError
from reliab.criterion.carrying import _line_above_zero
from reliab.criterion.criterion import Criterion
from reliab.criterion.derivation import derive_criterion, share_at_rest
from reliab.criterion.ellipse_table import EllipseTable
from reliab.criterion.laws.dimensionless import Dimensionless
from reliab.criterion.laws.exponential import Exponential
from reliab.criterion.laws.power import Power
from reliab.criterion.laws.table import Table
from reliab.criterion.methods.dirichlet import Dirichlet
from reliab.criterion.methods.quantile import Quantile
from reliab.criterion.motion_predictive import roots_of_increasing
from reliab.criterion.published import published_criterion
from reliab.criterion.shipped_tables import read_shipped_ellipses


@pytest.fixture(scope="module")
def derived(ellipses):
    return derive_criterion(ellipses, method=Dirichlet(), joint=True)


def test_the_index_is_one_on_the_boundary(derived):
    a, b = derived.limits(0.7, 0.03)
    angle = np.linspace(0.0, np.pi, 7)
    amplitude, delay = 1.0 + np.sqrt(a) * np.cos(angle), 1e-3 * np.sqrt(b) * np.sin(angle)
    np.testing.assert_allclose(derived.index(amplitude, delay, 0.7, 0.03), 1.0)


def test_the_criterion_contains_the_stated_share_of_motions_jointly(ellipses, derived):
    a, b = derived.limits(ellipses["f"].values[:, None], ellipses["xi"].values[None, :])
    contained = (ellipses["a"].values[..., 0, 0, 0] >= a) & (ellipses["b"].values[..., 0, 0, 0] >= b)
    assert contained.mean() == pytest.approx(0.95, abs=0.01)


def test_on_the_boundary_a_test_is_at_least_as_probable_as_stated(derived):
    """Joint containment is the stricter demand."""
    a, b = derived.limits(1.0, 0.05)
    angle = np.linspace(0.0, np.pi, 9)
    probability = derived.probability(
        1.0 + np.sqrt(a) * np.cos(angle), 1e-3 * np.sqrt(b) * np.sin(angle), 1.0, 0.05
    )
    assert (probability >= 0.949).all()
    assert (probability <= 0.99).all()


@pytest.mark.parametrize("law", [Dimensionless, Power, Exponential])
def test_a_fitted_law_contains_as_many_motions_on_average(ellipses, law):
    shares = []
    for each in (Table, law):
        criterion = derive_criterion(ellipses, method=Dirichlet(), joint=True, law=each)
        a, b = criterion.limits(ellipses["f"].values[:, None], ellipses["xi"].values[None, :])
        shares.append(
            ((ellipses["a"].values[..., 0, 0, 0] >= a) & (ellipses["b"].values[..., 0, 0, 0] >= b)).mean()
        )
    assert shares[1] == pytest.approx(shares[0], abs=0.003)


def test_one_structure_can_be_chosen(ellipses, derived):
    alone = derive_criterion(ellipses, method=Dirichlet(), joint=True, f=0.5, xi=0.05)
    for one, of_many in zip(alone.limits(0.5, 0.05), derived.limits(0.5, 0.05), strict=True):
        assert float(one) == pytest.approx(float(of_many))
    with pytest.raises(InputError, match="does not hold for this natural frequency"):
        alone.limits(1.0, 0.05)


def test_the_order_of_the_structures_does_not_matter(ellipses, derived):
    mixed = ellipses.isel(f=[2, 0, 1], xi=[1, 0], motion=np.random.default_rng(1).permutation(60))
    again = derive_criterion(mixed, method=Dirichlet(), joint=True)
    assert [float(each) for each in again.limits(0.6, 0.03)] == pytest.approx(
        [float(each) for each in derived.limits(0.6, 0.03)]
    )
    assert again.provenance.records_checksum == derived.provenance.records_checksum


def test_it_comes_back_from_json(derived):
    again = Criterion.from_json(derived.to_json())
    assert again == derived
    at = (1.004, 0.0005, 0.8, 0.04)
    assert float(again.index(*at)) == float(derived.index(*at))
    assert float(again.probability(*at)) == pytest.approx(float(derived.probability(*at)), abs=1e-4)


def test_the_json_says_where_it_comes_from(derived):
    content = json.loads(derived.to_json())
    assert content["schema_version"] == 2
    provenance = content["provenance"]
    assert (provenance["n_motions"], provenance["n_events"]) == (60, 20)
    assert len(provenance["records_checksum"]) == 64
    assert {"reliab", "numpy"} <= set(provenance["packages"])
    assert provenance["settings"] == {
        "concentration": 20.0,
        "carried_confidence": pytest.approx(1.0 - (2.0 / 21.0) ** 2),
    }


@pytest.mark.parametrize("text", ["", "[]", "{}", "null", '{"schema_version": 99}', "not json"])
def test_what_is_no_criterion_is_refused(text):
    with pytest.raises(InputError):
        Criterion.from_json(text)


def test_a_published_law_has_an_index_but_no_probability():
    criterion = published_criterion("guo_2017_18")
    assert float(criterion.index(1.0080, 0.78e-3, 1.0, 0.02)) == pytest.approx(3.830, abs=0.001)
    with pytest.raises(InputError, match="has no ellipses of ground motions"):
        criterion.probability(1.008, 0.78e-3, 1.0, 0.02)


def test_a_law_is_not_used_at_another_threshold():
    law = published_criterion("guo_2017_18").law
    with pytest.raises(InputError, match=r"error of 0\.05 only"):
        Criterion(
            law=law,
            threshold=0.1,
            metric="rms",
            confidence=0.95,
            method="quantile",
            joint=False,
            provenance=published_criterion("guo_2017_18").provenance,
        )


def test_motions_that_were_left_out_are_mentioned(ellipses):
    ellipses = ellipses.copy(deep=True)
    ellipses["a"][:15:3, 0, 0] = np.nan
    warnings = derive_criterion(ellipses, method=Quantile(), joint=False).provenance.warnings
    assert any("Up to 5 of 60 motions have no ellipse" in warning for warning in warnings)
    assert any("only 20 earthquakes" in warning for warning in warnings)


def test_limits_that_cannot_be_promised_are_zero_with_a_caution_and_fit_no_law(ellipses):
    found = derive_criterion(ellipses, method="order_statistic", confidence=0.99)
    assert "no test is accepted" in found.provenance.warnings[0]
    assert float(found.limits(1.0, 0.02)[0]) == 0.0
    for amplitude, delay in ((1.0, 0.0), (1.0, 1e-4), (1.001, 0.0)):  # the perfect test as well
        assert float(found.index(amplitude, delay, 1.0, 0.02)) == np.inf
    with pytest.raises(InputError, match="every structure; found too few motions or earthquakes for o"):
        derive_criterion(ellipses, method="order_statistic", confidence=0.99, law="dimensionless")


def at_rest(ellipses, share):
    """Give a share of the motions an error at rest below 5 % at 2 Hz and ξ = 0.05, and 20 % elsewhere."""
    errors = np.full((60, 3, 2, 1), 0.2)
    errors[: round(60 * share), 2, 1] = 0.04
    return ellipses.assign(error_at_rest=(("motion", "f", "xi", "metric"), errors))


def test_a_threshold_that_nothing_exceeds_is_refused_where_it_means_nothing(ellipses):
    with pytest.raises(InputError, match=r"does not move .* 10 % .* f = 2 Hz and ξ = 0\.05"):
        derive_criterion(at_rest(ellipses, 0.10))
    found = derive_criterion(at_rest(ellipses, 0.10), f=1.0)
    assert found.limits(1.0, 0.02) == derive_criterion(ellipses, f=1.0).limits(1.0, 0.02)


def test_one_motion_in_twenty_is_not_held_against_it(ellipses):
    assert derive_criterion(at_rest(ellipses, 0.05)).threshold == 0.05


def test_motions_without_a_known_error_at_rest_do_not_count():
    assert share_at_rest(np.array([[np.nan], [np.nan]]), 0.05).tolist() == [0.0]


@pytest.mark.parametrize(
    ("function", "roots"),
    [
        (
            lambda x: scipy.special.ndtr(x) - np.array([1e-6, 0.5, 0.95]),
            [-4.753424308823, 0.0, 1.644853626951],
        ),
        (lambda x: np.sign(x - 0.3) * np.abs(x - 0.3) ** 0.2 * np.ones(3), [0.3, 0.3, 0.3]),
        (lambda x: np.where(x < 2.0, -1.0, 1.0) * np.ones(3), [2.0, 2.0, 2.0]),  # a jump
        (lambda x: x - np.array([-1e5, 1e5, 7.0]), [-1e5, 1e5, 7.0]),  # far outside of the first interval
        (lambda x: np.expm1(20.0 * x) - np.array([0.0, 1.0, 1e7]), np.log1p([0.0, 1.0, 1e7]) / 20.0),
    ],
)
def test_the_root_lies_where_the_sign_changes(function, roots):
    found = roots_of_increasing(function, np.full(3, -0.5), np.full(3, 0.75))
    np.testing.assert_allclose(found, roots, rtol=1e-11, atol=1e-12)


def test_a_function_without_a_root_has_none_and_leaves_the_others_theirs():
    found = roots_of_increasing(
        lambda x: np.stack([1.0 + np.exp(-abs(x[0])), x[1] - 3.0]), np.zeros(2), np.ones(2)
    )
    assert np.isnan(found[0])
    assert found[1] == pytest.approx(3.0)


def test_few_evaluations_are_enough():
    calls = []

    def function(x):
        calls.append(x)
        return scipy.special.ndtr(x) - 0.95

    roots_of_increasing(function, np.array([0.0]), np.array([3.0]))
    assert len(calls) < 20


@pytest.mark.parametrize("seed", range(5))
def test_a_line_above_zero_is_the_one_of_least_squares_with_bounds(seed):
    rng = np.random.default_rng(seed)
    places, values = rng.uniform(0.0, 3.0, 40), rng.uniform(0.0, 1.0, 40)
    values = values + places * (seed - 1) if seed else np.maximum(values - places, 0.0)
    values = np.abs(values)
    expected = scipy.optimize.nnls(np.stack([np.ones(40), places], axis=-1), values)[0]
    np.testing.assert_allclose(_line_above_zero(places, values), expected, rtol=1e-9, atol=1e-12)
    level = _line_above_zero(np.zeros(40), values)
    np.testing.assert_allclose(level, [values.mean(), 0.0])


@pytest.fixture(scope="module")
def traced():
    """Ellipses of synthetic motions at errors of which some are then asked for without them."""
    motions = reliab.load_motions("synthetic")[:3]
    return EllipseTable.from_dataset(
        reliab.ellipses(motions, f=[1.0], xi=[0.05], threshold=[0.005, 0.01, 0.03, 0.04, 0.05])
    )


def without(table, error):
    return table.take(threshold=~np.isclose(table.coordinates["threshold"], error))


def apart(found, known):
    """Largest relative difference of the semi-axes of inscribed ellipses."""
    of_lag = (
        ...,
        list(known.coordinates["curve"]).index("inscribed"),
        list(known.coordinates["side"]).index("lag"),
    )
    pairs = (found.a, known.a), (found.b, known.b)
    return max(np.nanmax(np.abs(np.sqrt(one[of_lag] / other[of_lag]) - 1.0)) for one, other in pairs)


@pytest.mark.parametrize(("error", "largest"), [(0.005, 0.05), (0.04, 0.02)])
def test_an_error_that_was_not_traced_has_nearly_its_own_ellipses(traced, error, largest):
    known = traced.interpolate_threshold(error)
    found = without(traced, error).interpolate_threshold(error)
    assert found.coordinates["threshold"].tolist() == [error]
    assert apart(found, known) < largest


def test_a_traced_error_is_taken_as_it_is(traced):
    place = int(np.flatnonzero(traced.coordinates["threshold"] == 0.03)[0])
    assert np.array_equal(traced.interpolate_threshold(0.03).a, traced.a[:, :, :, [place]], equal_nan=True)


@pytest.mark.parametrize("error", [0.0, -0.01, np.nan, np.inf, 0.3])
def test_an_error_beyond_the_traced_ones_is_refused(error):
    with pytest.raises(InputError, match="or trace boundaries"):
        read_shipped_ellipses("inscribed", "record", "rms").interpolate_threshold(error)


def test_one_large_error_alone_serves_no_smaller_one(traced):
    only = traced.take(threshold=[int(np.argmax(traced.coordinates["threshold"]))])
    with pytest.raises(InputError, match="Choose among"):
        only.interpolate_threshold(0.04)
