"""A term of the motion is worth what it gains on earthquakes that were not fitted."""

import numpy as np
import pytest
from reliab_studies.validation.motion_terms import gain_of_terms

from reliab.core.errors import InputError
from reliab.criterion.population import Population


@pytest.fixture
def logarithms(grouped_ellipses):
    population = Population.from_ellipses(grouped_ellipses, threshold=0.05, metric="rms")
    return np.stack([population.log_alpha, population.log_beta], axis=-1)


def test_the_answer_itself_explains_everything(grouped_ellipses, logarithms):
    noise = np.random.default_rng(1).normal(0.0, 0.05, logarithms.shape)
    gains = gain_of_terms(grouped_ellipses, {"answer": logarithms + noise}).loc["answer"]
    assert gains["gain"] > 1.0
    assert gains["explained_a"] > 0.97
    assert gains["explained_b"] > 0.95


def test_terms_unrelated_to_a_motion_gain_nothing(grouped_ellipses):
    rng = np.random.default_rng(2)
    gains = gain_of_terms(grouped_ellipses, {f"noise {k}": rng.normal(size=60) for k in range(10)})
    assert gains["gain"].mean() < 0.0
    assert (gains["gain"] < 3.0 * gains["standard_error"]).all()
    assert gains["explained_a"].mean() == pytest.approx(1.0 / 60.0, abs=0.03)


def test_motions_without_an_ellipse_are_left_out(grouped_ellipses, logarithms):
    lacking = grouped_ellipses.copy(deep=True)
    lacking["a"][0, 0, 0] = np.nan
    complete, part = (
        gain_of_terms(ellipses, {"mean": logarithms.mean(axis=(1, 2, 3))}).loc["mean"]
        for ellipses in (grouped_ellipses, lacking)
    )
    assert part["gain"] == pytest.approx(complete["gain"], rel=0.05)


def test_terms_of_another_shape_are_refused(grouped_ellipses):
    with pytest.raises(InputError, match="one value for each motion"):
        gain_of_terms(grouped_ellipses, {"wrong": np.zeros(3)})
