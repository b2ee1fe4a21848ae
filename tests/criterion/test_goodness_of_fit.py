"""Tests of lognormality."""

import numpy as np
import pytest
from scipy import stats

from reliab.criterion.distributions import Lognormal
from reliab.criterion.ellipse_sample import sample_of
from reliab.criterion.goodness_of_fit import lognormality, objection, quantile_plot


def test_the_printed_table_is_not_lognormal(printed_table2):
    """Shapiro-Wilk on logarithms: p = 0.007 for a and 5e-5 for b."""
    sample = sample_of(printed_table2, frequency=1.0, damping_ratio=0.02, threshold=0.05, metric="rms")
    found = {"a": lognormality(sample.a), "b": lognormality(sample.b)}
    assert found["a"].shapiro_wilk == pytest.approx(0.007, abs=0.0005)
    assert found["b"].shapiro_wilk == pytest.approx(5e-5, rel=0.1)
    assert "b is not lognormal over these motions (Shapiro-Wilk p = 5" in objection(sample.b, "b")


@pytest.mark.slow
def test_p_values_of_lognormal_motions_are_uniform():
    rng = np.random.default_rng(11)
    fits = [lognormality(np.exp(rng.normal(size=40))) for _ in range(60)]
    for test in ("kolmogorov_smirnov", "anderson_darling", "shapiro_wilk"):
        p_values = [getattr(fit, test) for fit in fits]
        assert stats.kstest(p_values, "uniform").pvalue > 0.01, test


def test_nothing_is_said_when_nothing_is_rejected():
    values = np.exp(stats.norm.ppf((np.arange(50) + 0.5) / 50))
    assert objection(values, "a") == ""


def test_the_band_of_a_quantile_plot_holds_19_of_20_points():
    rng = np.random.default_rng(12)
    truth = Lognormal(mu=1.0, sigma=0.5)
    plots = [quantile_plot(np.exp(rng.normal(1.0, 0.5, 60)), truth) for _ in range(300)]
    inside = [(plot.low <= plot.observed) & (plot.observed <= plot.high) for plot in plots]
    assert np.mean(inside) == pytest.approx(0.95, abs=0.012)
