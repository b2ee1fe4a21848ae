"""Histories at another rate than they were recorded or predicted at are the same motions."""

from types import SimpleNamespace

import numpy as np
import pytest

from reliab.discrepancy.blocks.loop import _resample
from reliab.discrepancy.blocks.observed import ObservedBlock

RATE, SIZE = 256.0, 4097
TIME = np.arange(SIZE) / RATE


def slow(time):
    return np.sin(2.0 * np.pi * 1.3 * time) + 0.4 * np.cos(2.0 * np.pi * 3.1 * time)


@pytest.mark.parametrize(("parts", "thinning"), [(1, 1), (4, 1), (1, 4), (1, 8)])
def test_a_ground_motion_at_another_rate_is_the_same_motion(parts, thinning):
    result = _resample(slow(TIME), parts, thinning)
    reference = slow(np.arange(0.0, TIME[-1] + 1e-9, thinning / parts / RATE))
    assert result.size == reference.size
    interior = slice(result.size // 4, 3 * result.size // 4)
    np.testing.assert_allclose(result[interior], reference[interior], atol=2e-3)


@pytest.mark.parametrize("thinning", [4, 8])
def test_frequencies_above_a_lower_rate_are_filtered_out(thinning):
    fast = np.sin(2.0 * np.pi * 0.8 * RATE / thinning * TIME)
    assert np.abs(_resample(fast, 1, thinning)[200:300]).max() < 0.01


@pytest.mark.parametrize("thinning", [1, 4])
def test_a_prediction_at_few_instants_is_read_at_all(thinning):
    block = SimpleNamespace(tests=[SimpleNamespace(size=SIZE)], every=thinning)
    result = ObservedBlock.interpolate(block, slow(TIME[::thinning]), 0)
    np.testing.assert_allclose(result, slow(TIME), atol=2e-4)
