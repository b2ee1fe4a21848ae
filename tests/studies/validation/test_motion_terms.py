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
    found = gain_of_terms(grouped_ellipses, {"answer": logarithms + noise}).loc["answer"]
    assert found["gain"] > 1.0
    assert found["explained_a"] > 0.97
    assert found["explained_b"] > 0.95


def test_what_has_nothing_to_do_with_a_motion_gains_nothing(grouped_ellipses):
    rng = np.random.default_rng(2)
    found = gain_of_terms(grouped_ellipses, {f"noise {k}": rng.normal(size=60) for k in range(10)})
    assert found["gain"].mean() < 0.0
    assert (found["gain"] < 3.0 * found["standard_error"]).all()
    assert found["explained_a"].mean() == pytest.approx(1.0 / 60.0, abs=0.03)


def test_motions_without_an_ellipse_are_left_out(grouped_ellipses, logarithms):
    lacking = grouped_ellipses.copy(deep=True)
    lacking["a"][0, 0, 0] = np.nan
    whole, part = (
        gain_of_terms(each, {"mean": logarithms.mean(axis=(1, 2, 3))}).loc["mean"]
        for each in (grouped_ellipses, lacking)
    )
    assert part["gain"] == pytest.approx(whole["gain"], rel=0.05)


def test_terms_of_another_shape_are_refused(grouped_ellipses):
    with pytest.raises(InputError, match="one value for each motion"):
        gain_of_terms(grouped_ellipses, {"wrong": np.zeros(3)})
