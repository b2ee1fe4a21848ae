"""Scrambled Sobol points without the import of `scipy.stats`."""

import numpy as np
import pytest
import scipy

from reliab.assessment.inference.sobol import sobol_points


@pytest.mark.parametrize("dimensions", [1, 2, 17, 40, 41, 100, 150])
@pytest.mark.parametrize("count", [1, 2, 256])
@pytest.mark.parametrize("seed", [0, 5])
def test_points_are_those_of_scipy_to_the_last_bit(dimensions, count, seed):
    expected = scipy.stats.qmc.Sobol(dimensions, seed=seed).random(count)
    np.testing.assert_array_equal(sobol_points(dimensions, count, seed), expected)


def test_points_are_spread_more_evenly_than_random_ones():
    points, random = sobol_points(6, 512, 1), np.random.default_rng(1).random((512, 6))
    assert scipy.stats.qmc.discrepancy(points) < 0.2 * scipy.stats.qmc.discrepancy(random)
