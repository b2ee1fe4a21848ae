"""Histories at another rate than they were recorded or predicted at are the same motions."""

from types import SimpleNamespace

import numpy as np
import pytest

from reliab.discrepancy.blocks.loop import _resample
from reliab.discrepancy.blocks.observed import ObservedBlock

RATE, SIZE = 256.0, 4097
TIME = np.arange(SIZE) / RATE
MIDDLE = slice(SIZE // 4, 3 * SIZE // 4)


def slow(time):
    return np.sin(2.0 * np.pi * 1.3 * time) + 0.4 * np.cos(2.0 * np.pi * 3.1 * time)


@pytest.mark.parametrize(("parts", "every"), [(1, 1), (4, 1), (1, 4), (1, 8)])
def test_a_ground_motion_at_another_rate_is_the_same_motion(parts, every):
    found = _resample(slow(TIME), parts, every)
    expected = slow(np.arange(0.0, TIME[-1] + 1e-9, every / parts / RATE))
    assert found.size == expected.size
    inside = slice(found.size // 4, 3 * found.size // 4)
    np.testing.assert_allclose(found[inside], expected[inside], atol=2e-3)


@pytest.mark.parametrize("every", [4, 8])
def test_what_a_lower_rate_cannot_hold_is_filtered_out(every):
    fast = np.sin(2.0 * np.pi * 0.8 * RATE / every * TIME)
    assert np.abs(_resample(fast, 1, every)[200:300]).max() < 0.01


@pytest.mark.parametrize("every", [1, 4])
def test_a_prediction_at_few_instants_is_read_at_all(every):
    block = SimpleNamespace(tests=[SimpleNamespace(size=SIZE)], every=every)
    found = ObservedBlock.interpolate(block, slow(TIME[::every]), 0)
    np.testing.assert_allclose(found, slow(TIME), atol=2e-4)
