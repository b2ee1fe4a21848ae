"""Probabilities come true on ellipses of known distribution."""

import numpy as np
import pytest

from reliab.validation.judge import probability_calibration


@pytest.mark.slow
def test_stated_probabilities_come_true(draw_ellipses):
    ellipses = draw_ellipses(events=60, skewness=0.5, frequencies=(0.5, 1.0, 2.0), seed=7)
    table = probability_calibration(ellipses, scheme="k_fold", trials=128)
    assert table["tests"].sum() == 120 * 3 * 128
    assert (np.diff(table["stated"]) > 0.0).all()
    assert (np.diff(table["observed"]) > 0.0).all()
    np.testing.assert_allclose(table["observed"], table["stated"], atol=0.06)
    is_inside = (table["low"] <= table["stated"]) & (table["stated"] <= table["high"])
    assert is_inside.mean() > 0.7


def test_each_test_is_counted_where_its_probability_lies(draw_ellipses):
    ellipses = draw_ellipses(events=8, seed=8)
    table = probability_calibration(ellipses, edges=(0.0, 0.5, 1.0), trials=64)
    assert len(table) == 2
    assert table["stated"][0] < 0.5 < table["stated"][1]
    assert table["tests"].sum() == 16 * 64
