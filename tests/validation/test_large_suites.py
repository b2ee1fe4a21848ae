"""A method keeps its word on large suites of known distribution."""

import numpy as np
import pytest

from reliab.criterion.event_components import event_components
from reliab.criterion.methods import RECOMMENDED, method_of
from reliab.criterion.scaling import scales
from reliab.validation.cross_validation import Derived
from reliab.validation.large_suites import draw_ellipses, suite_containment

OURS = Derived(name="recommended", method=method_of(RECOMMENDED))


@pytest.mark.parametrize("skewness", [0.0, 0.8])
def test_drawn_ellipses_have_the_spread_that_was_asked_for(skewness):
    found = draw_ellipses(events=3000, spread=0.5, correlation=0.8, between_events=0.4, skewness=skewness)
    logarithms = np.log([found["a"].values.ravel(), found["b"].values.ravel()])
    np.testing.assert_allclose(logarithms.std(axis=1), 0.5, rtol=0.05)
    assert np.corrcoef(logarithms)[0, 1] == pytest.approx(0.8, abs=0.03)
    parts = event_components(logarithms.T, found["event"].values)
    of_a_pair = np.corrcoef(logarithms[0].reshape(-1, 2).T)[0, 1]
    assert of_a_pair == pytest.approx(0.4, abs=0.06)
    assert (parts.effective_number < 6000).all()


def test_drawn_ellipses_scale_with_the_structure():
    found = draw_ellipses(events=4000, frequencies=(0.5, 2.0), spread=0.3)
    means = np.exp(np.log(found["b"].values.squeeze()).mean(axis=0))
    np.testing.assert_allclose(means[0] / means[1], 16.0, rtol=0.03)
    assert float(np.exp(np.log(found["a"]).mean())) == pytest.approx(0.4 * scales(1.0, 0.02)[0], rel=0.03)


def test_containment_of_a_large_suite_is_the_stated_one_quick():
    suites = [(f"skewness {s:g}", draw_ellipses(events=300, skewness=s, seed=1)) for s in (0.0, 0.8)]
    found = suite_containment(suites, [OURS], count=2, confidences=(0.8, 0.95))
    assert list(found["suite"]) == ["skewness 0", "skewness 0", "skewness 0.8", "skewness 0.8"]
    for row in found.itertuples():
        slack = 3.5 * np.sqrt(1.5 * row.confidence * (1.0 - row.confidence) / 600)
        assert row.containment == pytest.approx(row.confidence, abs=slack)


@pytest.mark.slow
@pytest.mark.parametrize("skewness", [0.0, 0.5, 1.0])
def test_containment_of_a_thousand_earthquakes_is_within_a_point(skewness):
    frequencies = (0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0)
    suite = draw_ellipses(events=1000, skewness=skewness, frequencies=frequencies, seed=2)
    found = suite_containment([("suite", suite)], [OURS], count=1)
    np.testing.assert_allclose(found["containment"], found["confidence"], atol=0.01)
