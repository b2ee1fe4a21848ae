"""Probabilities come true on ellipses of known distribution."""

import numpy as np

from reliab.validation.large_suites import draw_ellipses
from reliab.validation.probability_calibration import probability_calibration


def test_stated_probabilities_come_true():
    ellipses = draw_ellipses(events=60, skewness=0.5, frequencies=(0.5, 1.0, 2.0), seed=7)
    found = probability_calibration(ellipses, scheme="k_fold", trials=128)
    assert found["tests"].sum() == 120 * 3 * 128
    assert (np.diff(found["stated"]) > 0.0).all()
    assert (np.diff(found["observed"]) > 0.0).all()
    np.testing.assert_allclose(found["observed"], found["stated"], atol=0.06)
    inside = (found["low"] <= found["stated"]) & (found["stated"] <= found["high"])
    assert inside.mean() > 0.7


def test_each_test_is_counted_where_its_probability_lies():
    ellipses = draw_ellipses(events=8, seed=8)
    found = probability_calibration(ellipses, edges=(0.0, 0.5, 1.0), trials=64)
    assert len(found) == 2
    assert found["stated"][0] < 0.5 < found["stated"][1]
    assert found["tests"].sum() == 16 * 64
