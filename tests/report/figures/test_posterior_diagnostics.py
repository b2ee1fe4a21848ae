"""Figures of posteriors show every chosen parameter and every ensemble."""

import numpy as np
import pytest

from reliab.criterion.bayes import PosteriorSample
from reliab.report.figures.posterior_diagnostics import pairs, ranks, traces
from reliab.report.style import svg

NAMES = ("mean of a", "mean of b", "spread")


@pytest.fixture(scope="module")
def posterior():
    draws = np.random.default_rng(1).normal(size=(4, 60, 12, 3))
    return PosteriorSample(names=NAMES, draws=draws, thin=2, accepted=0.3)


def test_traces_have_a_row_for_each_parameter_and_name_its_convergence(posterior):
    figure = traces(posterior)
    assert [each.get_title(loc="left").split(":")[0] for each in figure.axes] == list(NAMES)
    assert all("effective draws" in each.get_title(loc="left") for each in figure.axes)
    assert all(len(each.lines) == 4 * 3 for each in figure.axes)


def test_ranks_of_equal_ensembles_are_level(posterior):
    figure = ranks(posterior, ("mean of a", "spread"))
    for axes in figure.axes:
        densities = np.array([patch.get_data().values for patch in axes.patches])
        assert densities.shape == (4, 20)
        np.testing.assert_allclose(densities.mean(axis=1), 1.0)


def test_a_strayed_ensemble_is_seen(posterior):
    draws = posterior.draws.copy()
    draws[0] += 3.0
    strayed = PosteriorSample(names=NAMES, draws=draws, thin=2, accepted=0.3)
    (axes,) = ranks(strayed, ("spread",)).axes
    assert axes.patches[0].get_data().values[-1] > 2.5
    assert "1.0" not in traces(strayed, ("spread",)).axes[0].get_title(loc="left").split(",")[0]


def test_pairs_fill_the_lower_triangle(posterior):
    figure = pairs(posterior, NAMES)
    visible = [each for each in figure.axes if each.axison]
    assert len(visible) == 6
    assert svg(figure) == svg(pairs(posterior, NAMES))
