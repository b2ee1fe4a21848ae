"""Limits of few motions, and those for leads."""

import warnings
from itertools import pairwise

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings, strategies as st

from reliab.app.api.derived_criteria import summarise
from reliab.core.errors import InputError
from reliab.core.vocabulary import ELLIPSE_DIMENSIONS
from reliab.criterion.criterion import Criterion
from reliab.criterion.derivation import derive_criterion, published_criterion
from reliab.criterion.distributions import DISTRIBUTIONS
from reliab.criterion.laws.registry import FITTED_LAWS
from reliab.criterion.methods.method import BoundMethod, limits
from reliab.criterion.methods.registry import METHODS, method_of
from reliab.criterion.motion_predictive import MotionPredictive
from reliab.criterion.population import EllipseSample

BOUND_METHODS = [name for name, method in METHODS.items() if issubclass(method, BoundMethod)]

EXAMPLES = 6
CONFIDENCES = (0.3, 0.6, 0.75, 0.9, 0.95, 0.99, 0.995, 0.999)
EVERY = {
    **{name: method_of(name) for name in BOUND_METHODS},
    **{f"quantile, {name}": method_of("quantile", distribution=name) for name in DISTRIBUTIONS},
}


def sample_of(logarithms, events):
    number = np.arange(len(logarithms)).astype(np.str_)
    return EllipseSample(
        a=1e-4 * np.exp(logarithms[:, 0]),
        b=np.exp(logarithms[:, 1]),
        motions=number,
        events=np.asarray(events).astype(np.str_),
        frequency=1.0,
        damping_ratio=0.02,
        threshold=0.05,
        metric="rms",
    )


@st.composite
def small_samples(draw):
    """Two to six records of one to four earthquakes, scattered, with ties or outlying."""
    motions = draw(st.integers(3, 6))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    logarithms = draw(st.sampled_from([0.01, 0.5, 3.0])) * rng.normal(size=(motions, 2))
    logarithms = logarithms.round(draw(st.sampled_from([0, 1, 12])))
    if draw(st.booleans()):
        logarithms[:, 1] = logarithms[:, 0]
    return logarithms, rng.integers(draw(st.integers(1, 4)), size=motions)


@pytest.mark.slow
@pytest.mark.default_cases(8)
@pytest.mark.parametrize("joint", [True, False], ids=["joint", "each"])
@pytest.mark.parametrize("method", EVERY.values(), ids=EVERY)
@settings(max_examples=EXAMPLES, deadline=None, derandomize=True)
@given(given_motions=small_samples())
def test_limits_are_finite_and_never_wider_at_a_higher_confidence(method, joint, given_motions):
    try:
        sample = sample_of(*given_motions)
    except InputError:
        return  # all motions alike
    result = np.array([limits(sample, method, confidence, joint=joint) for confidence in CONFIDENCES])
    assert np.isfinite(result).all()
    assert (result >= 0.0).all()
    for lower, higher in pairwise(result):
        assert (higher <= lower * (1.0 + 1e-6)).all()


@pytest.mark.slow
@pytest.mark.default_cases(4)
@pytest.mark.parametrize("method", EVERY.values(), ids=EVERY)
@settings(max_examples=EXAMPLES, deadline=None, derandomize=True)
@given(given_motions=small_samples())
def test_bounds_beyond_the_sample_still_fall(method, given_motions):
    """The methods by themselves: minus infinity is a bound, NaN and plus infinity are none."""
    logarithms, events = given_motions
    values = logarithms[:, 0]
    if np.ptp(values) == 0.0:
        return
    bounds = [method.lower_bound(values, events.astype(np.str_), confidence) for confidence in CONFIDENCES]
    assert all(bound < np.inf for bound in bounds)
    for lower, higher in pairwise(bounds):
        assert higher <= lower + 1e-6 * np.ptp(values)


@pytest.mark.slow
@settings(max_examples=20, deadline=None, derandomize=True)
@given(given_motions=small_samples())
def test_a_predictive_quantile_is_always_there(given_motions):
    logarithms, events = given_motions
    fit = MotionPredictive.fit(logarithms, events.astype(np.str_))
    quantiles = np.array([fit.quantile(1.0 - confidence) for confidence in CONFIDENCES])
    assert np.isfinite(quantiles).all()
    assert (np.diff(quantiles, axis=0) <= 1e-9).all()
    np.testing.assert_allclose(fit.cumulative(logarithms.min(axis=0) - 1e12), 0.0, atol=1e-2)


def test_two_earthquakes_carry_no_99_percent():
    """Six records of two earthquakes gave d ≤ 1.05, 0.866 and then 3.18 ms at 95, 99 and 99.9 %."""
    for seed in range(30):
        rng = np.random.default_rng(seed)
        sample = sample_of(0.5 * rng.normal(size=(6, 2)), np.repeat([0, 1], 3))
        assert limits(sample, method_of("dirichlet"), 0.99, joint=True) == (0.0, 0.0)
        assert min(limits(sample, method_of("dirichlet"), 0.5, joint=True)) > 0.0


def test_equal_motions_are_refused():
    logarithms = np.random.default_rng(1).normal(size=(5, 2))
    logarithms[:, 1] = 0.3
    with pytest.raises(InputError, match="b is the same for all ground motions"):
        sample_of(logarithms, range(5))


@pytest.mark.parametrize("name", ["dirichlet", "quantile", "predictive", "tolerance"])
def test_one_earthquake_carries_nothing(name):
    sample = sample_of(np.random.default_rng(1).normal(size=(40, 2)), np.zeros(40))
    assert limits(sample, method_of(name), 0.5) == (0.0, 0.0)


def test_ties_have_an_empirical_distribution():
    with warnings.catch_warnings(action="error"):
        fit = DISTRIBUTIONS["empirical"].fit([1.0, 2.0, 2.0, 2.0, 2.0, 2.0])
        assert 0.0 < float(fit.quantile(0.05)) < 2.0


@settings(max_examples=25, deadline=None, derandomize=True)
@given(
    motions=st.integers(3, 12),
    earthquakes=st.integers(1, 8),
    seed=st.integers(0, 2**32 - 1),
    method=st.sampled_from(list(BOUND_METHODS)),
    law=st.sampled_from(list(FITTED_LAWS)),
    confidence=st.sampled_from(CONFIDENCES),
)
def test_a_criterion_of_few_motions_is_finite_and_comes_back_from_its_file_or_is_refused(
    motions, earthquakes, seed, method, law, confidence
):
    rng = np.random.default_rng(seed)
    shape = (motions, 2, 2, 1, 1, 1, 1)
    events = rng.integers(earthquakes, size=motions).astype(np.str_)
    ellipses = xr.Dataset(
        {name: (ELLIPSE_DIMENSIONS, np.exp(rng.normal(size=shape))) for name in "ab"},
        coords={
            "motion": np.arange(motions).astype(np.str_),
            "event": ("motion", events),
            "f": [0.5, 1.0],
            "xi": [0.02, 0.05],
            "threshold": [0.05],
            "metric": ["rms"],
            "curve": ["inscribed"],
            "side": ["lag"],
        },
    )
    try:
        criterion = derive_criterion(ellipses, method=method, law=law, confidence=confidence)
    except InputError:
        return
    second = Criterion.from_json(criterion.to_json())
    limits_of_both = [np.stack(single.limits([0.5, 0.7, 1.0], 0.03)) for single in (criterion, second)]
    np.testing.assert_array_equal(*limits_of_both)
    assert np.isfinite(limits_of_both[0]).all()
    assert (limits_of_both[0] >= 0.0).all()
    if (limits_of_both[0] == 0.0).any():
        assert "no test is accepted" in criterion.provenance.warnings[0]


STRUCTURE = (1.0, 0.02)


@pytest.fixture(scope="module")
def criterion(two_sided):
    return derive_criterion(two_sided)


def test_each_side_has_its_own_limits(two_sided, criterion):
    for side in ("lag", "lead"):
        separate = derive_criterion(two_sided.sel(side=side, drop=True))
        assert criterion.limits(*STRUCTURE, side) == separate.limits(*STRUCTURE)
    assert criterion.limits(*STRUCTURE, "lead")[1] > criterion.limits(*STRUCTURE)[1]


def test_the_sign_of_the_delay_chooses_the_side(criterion):
    (a, b), (a_lead, b_lead) = criterion.limits(*STRUCTURE), criterion.limits(*STRUCTURE, "lead")
    delay = np.array([1e-3, -1e-3, 0.0])
    expected = [1e-6 / a + 1.0 / b, 1e-6 / a_lead + 1.0 / b_lead, 1e-6 / a]
    np.testing.assert_allclose(criterion.index(1.001, delay, *STRUCTURE), expected, rtol=1e-9)
    lag, lead, _ = criterion.probability(1.001, delay, *STRUCTURE)
    assert lead > lag


def test_leads_come_back_from_json(criterion):
    second = Criterion.from_json(criterion.to_json())
    assert second == criterion
    arguments = (1.002, -0.8e-3, *STRUCTURE)
    assert float(second.index(*arguments)) == float(criterion.index(*arguments))
    assert float(second.probability(*arguments)) == pytest.approx(
        float(criterion.probability(*arguments)), abs=1e-4
    )


def test_the_summary_names_the_lead(criterion):
    result = summarise(criterion, *STRUCTURE)
    assert (result["a_lead"], result["b_lead"]) == criterion.limits(*STRUCTURE, "lead")
    assert result["lead_limit_ms"] ** 2 == pytest.approx(result["b_lead"])


def test_a_lead_is_not_judged_by_lags_alone(ellipses):
    lags_only = derive_criterion(ellipses)
    assert any("lags alone" in sentence for sentence in lags_only.provenance.warnings)
    assert summarise(lags_only, *STRUCTURE)["lead_limit_ms"] is None
    for judge in (lags_only.index, lags_only.probability):
        with pytest.raises(InputError, match="has no limits for leads"):
            judge(1.0, [1e-4, -1e-4], *STRUCTURE)


def test_the_papers_law_counts_a_lead_as_a_lag():
    law = published_criterion("guo_2017_18")
    assert float(law.index(1.0, -1e-4, *STRUCTURE)) == float(law.index(1.0, 1e-4, *STRUCTURE))


def test_too_few_leads_are_said_and_leave_the_lags(two_sided):
    small_sample = two_sided.copy(deep=True)
    small_sample["a"].loc[{"side": "lead", "f": 2.0}] = np.nan
    result = derive_criterion(small_sample)
    assert result.lead_law is None
    assert any(
        "Too few motions have a boundary for leads" in warning for warning in result.provenance.warnings
    )


@pytest.mark.parametrize("wrong", [(np.nan, 0.0), (1.0, np.inf)])
def test_non_finite_indices_are_refused(criterion, wrong):
    with pytest.raises(InputError, match="must be finite"):
        criterion.index(*wrong, *STRUCTURE)


def test_the_paper_rests_on_fitted_ellipses_and_every_other_method_on_inscribed_ones(two_sided, ellipses):
    paper = derive_criterion(two_sided, method="quantile")
    assert (paper.provenance.curve, paper.joint) == ("ellipse", False)
    assert paper.limits(*STRUCTURE) == derive_criterion(ellipses, method="quantile").limits(*STRUCTURE)
    default = derive_criterion(two_sided)
    assert (default.method, default.provenance.curve, default.joint) == ("dirichlet", "inscribed", True)
    fit = derive_criterion(ellipses)
    assert float(default.limits(*STRUCTURE)[0]) == pytest.approx(
        0.9 * float(fit.limits(*STRUCTURE)[0]), rel=1e-6
    )
    assert any("not inscribed" in warning for warning in derive_criterion(ellipses).provenance.warnings)
