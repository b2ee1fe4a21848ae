"""What modes leave over of a loop acts at once, a lag later or a lead earlier, on straight lines."""

from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

from reliab.simulation.frames.reduced_loop import _remainder
from reliab.simulation.linear_loop.pole_recursion import LeadingLoop, leading_recursion

STEP = 0.02
GROUND = np.random.default_rng(8).normal(size=60)
TIME = STEP * np.arange(GROUND.size)


@pytest.mark.parametrize("lead", [0.004, 0.02, 0.033, 0.079])
def test_direct_term_of_a_lead_takes_later_ground(lead):
    no_poles = np.zeros(1, dtype=complex)
    loop = LeadingLoop(
        pole=no_poles - 0.3 + 6.0j, residue=no_poles, feedthrough=np.array([1.7]), lead=np.array([lead])
    )
    ahead, coefficients = leading_recursion(loop, STEP)
    left_weight, right = coefficients[-4:-2, 0]
    now, second = GROUND[10 + ahead[0] - 1], GROUND[10 + ahead[0]]
    assert left_weight * now + right * second == pytest.approx(
        -1.7 * np.interp(TIME[10] + lead, TIME, GROUND)
    )


@pytest.mark.parametrize("ahead", [0.0, 0.005, 0.018])
def test_remainder_of_modes_takes_later_ground(ahead):
    loop = SimpleNamespace(remainder=np.array([2.5]), remainder_time=np.array([-ahead]))
    row = _remainder(loop, STEP)[:, 0]
    result = row[2] * GROUND[10] + row[6] * GROUND[11]
    assert result == pytest.approx(-2.5 * np.interp(TIME[10] + ahead, TIME, GROUND))
    assert row[[0, 1, 3, 4, 5]].tolist() == [0.0] * 5


@pytest.mark.parametrize("late", [0.003, 0.05])
def test_lagging_remainder_of_modes_is_a_first_order_lag(late):
    loop = SimpleNamespace(remainder=np.array([2.5]), remainder_time=np.array([late]))
    row, result = _remainder(loop, STEP)[:, 0], [0.0]
    for first, now in pairwise(GROUND):
        result.append(row[0] * result[-1] + row[2] * now + row[3] * first)
    fine = np.linspace(0.0, TIME[-1], 200 * (TIME.size - 1) + 1)
    ground, lagging = np.interp(fine, TIME, GROUND), np.zeros(fine.size)
    decay = np.exp(-(fine[1] - fine[0]) / late)
    for i in range(1, fine.size):  # of the mean of each small step
        lagging[i] = decay * lagging[i - 1] + (1.0 - decay) * 0.5 * (ground[i] + ground[i - 1])
    np.testing.assert_allclose(result, -2.5 * lagging[::200], atol=1e-3)
