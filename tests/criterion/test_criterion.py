"""Limits, index and probability of a criterion."""

import json

import numpy as np
import pytest
import scipy

import reliab
from reliab.core.errors import InputError
from reliab.criterion.carrying import _line_above_zero
from reliab.criterion.criterion import Criterion
from reliab.criterion.derivation import derive_criterion, published_criterion, share_at_rest
from reliab.criterion.ellipse_table import EllipseTable
from reliab.criterion.laws.dimensionless import Dimensionless
from reliab.criterion.laws.exponential import Exponential
from reliab.criterion.laws.power import Power
from reliab.criterion.laws.table import TabulatedLimits
from reliab.criterion.methods.dirichlet import Dirichlet
from reliab.criterion.methods.quantile import Quantile
from reliab.criterion.motion_predictive import roots_of_increasing
from reliab.criterion.response_measures import read_shipped_ellipses


@pytest.fixture(scope="module")
def criterion(ellipses):
    return derive_criterion(ellipses, method=Dirichlet(), joint=True)


def test_the_index_is_one_on_the_boundary(criterion):
    a, b = criterion.limits(0.7, 0.03)
    angle = np.linspace(0.0, np.pi, 7)
    amplitude, delay = 1.0 + np.sqrt(a) * np.cos(angle), 1e-3 * np.sqrt(b) * np.sin(angle)
    np.testing.assert_allclose(criterion.index(amplitude, delay, 0.7, 0.03), 1.0)


def test_the_criterion_contains_the_stated_share_of_motions_jointly(ellipses, criterion):
    a, b = criterion.limits(ellipses["f"].values[:, None], ellipses["xi"].values[None, :])
    is_contained = (ellipses["a"].values[..., 0, 0, 0] >= a) & (ellipses["b"].values[..., 0, 0, 0] >= b)
    assert is_contained.mean() == pytest.approx(0.95, abs=0.01)


def test_on_the_boundary_a_test_is_at_least_as_probable_as_stated(criterion):
    """Joint containment is the stricter demand."""
    a, b = criterion.limits(1.0, 0.05)
    angle = np.linspace(0.0, np.pi, 9)
    probability = criterion.probability(
        1.0 + np.sqrt(a) * np.cos(angle), 1e-3 * np.sqrt(b) * np.sin(angle), 1.0, 0.05
    )
    assert (probability >= 0.949).all()
    assert (probability <= 0.99).all()


@pytest.mark.parametrize("law", [Dimensionless, Power, Exponential])
def test_a_fitted_law_contains_as_many_motions_on_average(ellipses, law):
    shares = []
    for item in (TabulatedLimits, law):
        criterion = derive_criterion(ellipses, method=Dirichlet(), joint=True, law=item)
        a, b = criterion.limits(ellipses["f"].values[:, None], ellipses["xi"].values[None, :])
        shares.append(
            ((ellipses["a"].values[..., 0, 0, 0] >= a) & (ellipses["b"].values[..., 0, 0, 0] >= b)).mean()
        )
    assert shares[1] == pytest.approx(shares[0], abs=0.003)


def test_one_structure_can_be_chosen(ellipses, criterion):
    separate = derive_criterion(ellipses, method=Dirichlet(), joint=True, f=0.5, xi=0.05)
    for single, multi_limit in zip(separate.limits(0.5, 0.05), criterion.limits(0.5, 0.05), strict=True):
        assert float(single) == pytest.approx(float(multi_limit))
    with pytest.raises(InputError, match="does not hold for this natural frequency"):
        separate.limits(1.0, 0.05)


def test_the_order_of_the_structures_does_not_matter(ellipses, criterion):
    mixture = ellipses.isel(f=[2, 0, 1], xi=[1, 0], motion=np.random.default_rng(1).permutation(60))
    second = derive_criterion(mixture, method=Dirichlet(), joint=True)
    assert [float(item) for item in second.limits(0.6, 0.03)] == pytest.approx(
        [float(item) for item in criterion.limits(0.6, 0.03)]
    )
    assert second.provenance.records_checksum == criterion.provenance.records_checksum


def test_it_comes_back_from_json(criterion):
    second = Criterion.from_json(criterion.to_json())
    assert second == criterion
    arguments = (1.004, 0.0005, 0.8, 0.04)
    assert float(second.index(*arguments)) == float(criterion.index(*arguments))
    assert float(second.probability(*arguments)) == pytest.approx(
        float(criterion.probability(*arguments)), abs=1e-4
    )


def test_the_json_says_where_it_comes_from(criterion):
    content = json.loads(criterion.to_json())
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
def test_file_without_criterion_is_refused(text):
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


def test_skipped_motions_are_mentioned(ellipses):
    ellipses = ellipses.copy(deep=True)
    ellipses["a"][:15:3, 0, 0] = np.nan
    warnings = derive_criterion(ellipses, method=Quantile(), joint=False).provenance.warnings
    assert any("Up to 5 of 60 motions have no ellipse" in warning for warning in warnings)
    assert any("only 20 earthquakes" in warning for warning in warnings)


def test_unachievable_limits_are_zero_with_a_caution(ellipses):
    result = derive_criterion(ellipses, method="order_statistic", confidence=0.99)
    assert "no test is accepted" in result.provenance.warnings[0]
    assert float(result.limits(1.0, 0.02)[0]) == 0.0
    for amplitude, delay in ((1.0, 0.0), (1.0, 1e-4), (1.001, 0.0)):  # the perfect test as well
        assert float(result.index(amplitude, delay, 1.0, 0.02)) == np.inf
    with pytest.raises(InputError, match="found too few motions or earthquakes for o"):
        derive_criterion(ellipses, method="order_statistic", confidence=0.99, law="dimensionless")


def add_rest_errors(ellipses, share):
    """Give a share of the motions an error at rest below 5 % at 2 Hz and ξ = 0.05, and 20 % elsewhere."""
    errors = np.full((60, 3, 2, 1), 0.2)
    errors[: round(60 * share), 2, 1] = 0.04
    return ellipses.assign(error_at_rest=(("motion", "f", "xi", "metric"), errors))


def test_threshold_above_all_errors_is_refused(ellipses):
    with pytest.raises(InputError, match=r"does not move .* 10 % .* f = 2 Hz and ξ = 0\.05"):
        derive_criterion(add_rest_errors(ellipses, 0.10))
    result = derive_criterion(add_rest_errors(ellipses, 0.10), f=1.0)
    assert result.limits(1.0, 0.02) == derive_criterion(ellipses, f=1.0).limits(1.0, 0.02)


def test_one_motion_in_twenty_is_not_held_against_it(ellipses):
    assert derive_criterion(add_rest_errors(ellipses, 0.05)).threshold == 0.05


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
    result = roots_of_increasing(function, np.full(3, -0.5), np.full(3, 0.75))
    np.testing.assert_allclose(result, roots, rtol=1e-11, atol=1e-12)


def test_a_function_without_a_root_has_none_and_leaves_the_others_theirs():
    result = roots_of_increasing(
        lambda x: np.stack([1.0 + np.exp(-abs(x[0])), x[1] - 3.0]), np.zeros(2), np.ones(2)
    )
    assert np.isnan(result[0])
    assert result[1] == pytest.approx(3.0)


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
def ellipse_table():
    """Ellipses of synthetic motions at errors of which some are then asked for without them."""
    motions = reliab.load_motions("synthetic")[:3]
    return EllipseTable.from_dataset(
        reliab.ellipses(motions, f=[1.0], xi=[0.05], threshold=[0.005, 0.01, 0.03, 0.04, 0.05])
    )


def drop_threshold(table, error):
    return table.take(threshold=~np.isclose(table.coordinates["threshold"], error))


def largest_difference(result, reference):
    """Largest relative difference of the semi-axes of inscribed ellipses."""
    lag_index = (
        ...,
        list(reference.coordinates["curve"]).index("inscribed"),
        list(reference.coordinates["side"]).index("lag"),
    )
    pairs = (result.a, reference.a), (result.b, reference.b)
    return max(
        np.nanmax(np.abs(np.sqrt(single[lag_index] / second[lag_index]) - 1.0)) for single, second in pairs
    )


@pytest.mark.parametrize(("error", "largest"), [(0.005, 0.05), (0.04, 0.02)])
def test_untraced_error_has_nearly_its_own_ellipses(ellipse_table, error, largest):
    reference = ellipse_table.interpolate_threshold(error)
    result = drop_threshold(ellipse_table, error).interpolate_threshold(error)
    assert result.coordinates["threshold"].tolist() == [error]
    assert largest_difference(result, reference) < largest


def test_a_traced_error_is_taken_as_it_is(ellipse_table):
    place = int(np.flatnonzero(ellipse_table.coordinates["threshold"] == 0.03)[0])
    assert np.array_equal(
        ellipse_table.interpolate_threshold(0.03).a, ellipse_table.a[:, :, :, [place]], equal_nan=True
    )


@pytest.mark.parametrize("error", [0.0, -0.01, np.nan, np.inf, 0.3])
def test_an_error_beyond_the_traced_ones_is_refused(error):
    with pytest.raises(InputError, match="or trace boundaries"):
        read_shipped_ellipses("inscribed", "record", "rms").interpolate_threshold(error)


def test_one_large_error_alone_serves_no_smaller_one(ellipse_table):
    only = ellipse_table.take(threshold=[int(np.argmax(ellipse_table.coordinates["threshold"]))])
    with pytest.raises(InputError, match="Choose among"):
        only.interpolate_threshold(0.04)
