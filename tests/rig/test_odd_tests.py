"""Odd tests are told from ordinary ones, and say little of a step."""

import math

import numpy as np
import pytest
import scipy

from reliab.rig.watching import OddTests, odd_density, ordinary_tests


def test_the_density_of_odd_tests_is_a_student_distribution():
    assert odd_density(7.0) == pytest.approx(scipy.stats.t.pdf(7.0, 2, scale=5.0))


def test_the_share_of_odd_tests_is_learned():
    rng = np.random.default_rng(1)
    found = OddTests()
    for score in rng.normal(size=270) + np.where(np.arange(270) % 10, 0.0, 30.0):
        found.learn(found.ordinary(float(score)))
    assert found.share == pytest.approx(0.1, abs=0.03)


def test_what_a_test_says_for_a_step_is_a_ratio_of_densities():
    """Without odd tests that of two normal distributions; one far off says less where they are common."""
    none = OddTests(odd=0.0, tests=1e9)
    assert none.evidence(1.0, 1.4) == pytest.approx(1.4 * 1.0 - 0.98 + math.log(0.9), abs=0.05)
    assert none.evidence(1.0, 1.4) == none.evidence(-1.0, -1.4)
    rare, common = OddTests(odd=0.0, tests=200.0), OddTests(odd=20.0, tests=200.0)
    assert rare.evidence(9.0, 1.4) > 2.0
    assert 0.0 < common.evidence(9.0, 1.4) < 1.3
    assert abs(common.evidence(-9.0, 1.4)) < 0.01


def test_level_effects_and_spread_are_those_of_ordinary_tests():
    rng = np.random.default_rng(2)
    rows = np.column_stack([np.ones(64), np.arange(64) % 2])
    values = rows @ [3.0, 5.0] + 0.1 * rng.normal(size=64)
    values[[5, 20, 33, 50, 61]] += [9.0, -7.0, 30.0, 4.0, -12.0]
    found = ordinary_tests(values, rows, np.diag([1e8, 1e4]))
    assert found.effects == pytest.approx([3.0, 5.0], abs=0.06)
    assert found.spread == pytest.approx(0.1, rel=0.25)
    assert np.flatnonzero(found.ordinary < 0.1).tolist() == [5, 20, 33, 50, 61]
