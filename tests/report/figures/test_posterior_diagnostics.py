"""Figures of posteriors show every chosen parameter and every ensemble."""

import numpy as np
import pytest

from reliab.report.figures.parameter_distributions import pairs, ranks, traces
from reliab.report.style import svg
from reliab.sampling.posterior_sample import PosteriorSample

NAMES = ("mean of a", "mean of b", "spread")
ENSEMBLES = 4


@pytest.fixture(scope="module")
def posterior():
    draws = np.random.default_rng(1).normal(size=(ENSEMBLES, 60, 12, 3))
    return PosteriorSample(names=NAMES, draws=draws, thin=2, accepted=0.3)


def with_outlier(posterior):
    draws = posterior.draws.copy()
    draws[0] += 3.0
    return PosteriorSample(names=NAMES, draws=draws, thin=2, accepted=0.3)


def widest(axes):
    """Greatest range of an ensemble's draws over what is expected."""
    return max(np.ptp(row.get_data().values) for row in axes.patches)


def test_traces_have_a_row_for_each_parameter_and_name_its_convergence(posterior):
    figure = traces(posterior)
    densities, courses = figure.axes[0::2], figure.axes[1::2]
    assert [row.get_title(loc="left") for row in densities] == list(NAMES)
    assert all("effective draws" in row.get_title(loc="left") for row in courses)
    assert all(len(row.lines) == ENSEMBLES for row in courses)


def test_a_strayed_ensemble_is_seen(posterior):
    level, away = (ranks(row, ("spread",)).axes for row in (posterior, with_outlier(posterior)))
    assert len(level) == 1
    assert widest(away[0]) > 3.0 * widest(level[0])
    assert (
        "1.0" not in traces(with_outlier(posterior), ("spread",)).axes[1].get_title(loc="left").split(",")[0]
    )


def test_ranks_have_a_panel_for_each_parameter(posterior):
    assert [row.get_title(loc="left") for row in ranks(posterior).axes] == list(NAMES)


def test_ranks_of_ensembles_add_up_to_their_count(posterior):
    (place,) = ranks(with_outlier(posterior), ("mean of b",)).axes
    row = np.array([steps.get_data().values for steps in place.patches])  # type: ignore[attr-defined]
    assert row.shape[0] == ENSEMBLES
    np.testing.assert_allclose(row.mean(axis=0), 1.0, atol=0.02)
    np.testing.assert_allclose(row.mean(axis=1), 1.0)


def test_equal_draws_are_drawn_without_a_warning(posterior):
    still = PosteriorSample(names=NAMES, draws=np.ones_like(posterior.draws), thin=2, accepted=0.0)
    for draw in (traces, ranks, pairs):
        assert draw(still, NAMES).axes


@pytest.mark.slow
def test_pairs_fill_the_lower_triangle(posterior):
    figure = pairs(posterior, NAMES)
    assert len([row for row in figure.axes if row.axison and (row.lines or row.collections)]) == 6
    assert svg(figure) == svg(pairs(posterior, NAMES))
