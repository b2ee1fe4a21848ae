"""Sentences of caution, and the tests of fit behind them."""

from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from scipy import stats

from reliab.core.vocabulary import CurveName
from reliab.criterion.cautions import (
    _curve_fit_caution,
    _extrapolation_caution,
    _omission_caution,
    _shortfall,
    not_lognormal,
    objection,
    quantile_plot,
)
from reliab.criterion.derivation import derive_criterion
from reliab.criterion.distributions import Lognormal
from reliab.criterion.experimental_share import whole_is_worst
from reliab.criterion.methods.registry import METHODS, method_of
from reliab.criterion.population import SampleGrid, sample_of

SELECTION = {"threshold": 0.05, "metric": "rms", "curve": CurveName.INSCRIBED, "side": "lag"}


def grid(*, motions=100, remaining=100, events=19, curve=CurveName.ELLIPSE):
    """Structures of which one has only `remaining` motions."""
    return SimpleNamespace(n_motions=motions, fewest_motions=remaining, fewest_events=events, curve=curve)


@pytest.mark.parametrize("method", [method() for method in METHODS.values()], ids=METHODS)
def test_only_a_fitted_distribution_reaches_beyond_the_earthquakes(method):
    """Nineteen earthquakes support nineteen twentieths without any distribution."""
    assert _extrapolation_caution(grid(), method, 0.95) == ""
    excess = _extrapolation_caution(grid(), method, 0.96)
    assert (excess == "") is method.distribution_free
    assert excess == "" or "19 earthquakes support 0.95" in excess


@pytest.mark.parametrize("method", [method() for method in METHODS.values()], ids=METHODS)
def test_motions_without_an_ellipse_are_told_of_unless_they_are_drawn(method):
    assert _omission_caution(grid(), method) == ""
    sentence = _omission_caution(grid(remaining=93), method)
    if method.samples_chains:
        assert sentence == ""
    else:
        assert "Up to 7 of 100 motions" in sentence
        assert ("too high" in sentence) is method.assumes_lognormality


@pytest.mark.parametrize("method", [method() for method in METHODS.values()], ids=METHODS)
def test_curves_of_another_method_raise_a_caution(method):
    for curve in (CurveName.ELLIPSE, CurveName.INSCRIBED):
        assert (_curve_fit_caution(grid(curve=curve), method) == "") is (curve == method.curve)


def test_a_plug_in_quantile_falls_short_with_few_motions_and_not_with_very_many():
    assert "10 motions" in _shortfall(grid(remaining=10), METHODS["quantile"](), 0.95)
    assert _shortfall(grid(remaining=10**6), METHODS["quantile"](), 0.95) == ""
    assert _shortfall(grid(remaining=10), METHODS["predictive"](), 0.95) == ""


def test_worst_case_is_stated_for_simulated_structures_only():
    assert all(whole_is_worst(f, xi) for f in (0.5, 1.0, 3.0) for xi in (0.01, 0.02, 0.1))
    assert not any(whole_is_worst(f, 0.05) for f in (0.49, 3.01))
    assert not any(whole_is_worst(1.0, xi) for xi in (0.0099, 0.101))


def test_non_lognormal_motions_have_no_assurance(two_sided):
    """Skewed to the left, lognormal bounds lie too high, and nothing says how often."""
    logarithms = -np.random.default_rng(8).exponential(size=two_sided.sizes["motion"])
    skewed_table = two_sided.copy(deep=True)
    for name in ("a", "b"):
        skewed_table[name] = skewed_table[name] * xr.DataArray(np.exp(3.0 * logarithms), dims="motion")
    for method in ("tolerance", "hierarchical"):
        message = not_lognormal(
            SampleGrid.from_ellipses(skewed_table, **SELECTION), method_of(method, assurance=0.9)
        )
        assert any("not lognormal" in sentence for sentence in message)
        assert "No assurance is stated: it would need lognormal motions." in message
    criterion = derive_criterion(skewed_table, method="tolerance", confidence=0.8)
    assert criterion.provenance.settings["assurance"] is None
    assert not_lognormal(SampleGrid.from_ellipses(skewed_table, **SELECTION), method_of("dirichlet")) == []


def test_the_printed_table_is_not_lognormal(printed_table2):
    """Shapiro-Wilk on logarithms: p = 0.007 for a and 5e-5 for b."""
    sample = sample_of(printed_table2, frequency=1.0, damping_ratio=0.02, threshold=0.05, metric="rms")
    assert "a is not lognormal over these motions (Shapiro-Wilk p = 0.007" in objection(sample.a, "a")
    assert "b is not lognormal over these motions (Shapiro-Wilk p = 5" in objection(sample.b, "b")


def test_nothing_is_said_when_nothing_is_rejected():
    values = np.exp(stats.norm.ppf((np.arange(50) + 0.5) / 50))
    assert objection(values, "a") == ""


def test_the_band_of_a_quantile_plot_holds_19_of_20_points():
    rng = np.random.default_rng(12)
    truth = Lognormal(mu=1.0, sigma=0.5)
    plots = [quantile_plot(np.exp(rng.normal(1.0, 0.5, 60)), truth) for _ in range(300)]
    is_inside = [(plot.low <= plot.observed) & (plot.observed <= plot.high) for plot in plots]
    assert np.mean(is_inside) == pytest.approx(0.95, abs=0.012)
