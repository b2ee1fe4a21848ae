"""Causes that explain a test together are put together part by part."""

from types import SimpleNamespace

import numpy as np
import pytest

from reliab.assessment import own_motion
from reliab.assessment.own_equation import Explanation, VelocityTerm, explain
from reliab.assessment.tracking_index import LEVEL
from reliab.core.vocabulary import Side
from reliab.structures.structure import Structure

OF_FORCE = VelocityTerm(value=2e-3, deviation=1e-5, least=0.0)


def test_the_sum_of_two_causes_is_the_sum_of_each_part():
    first = Explanation(damping=1.0, skew=2.0, feedback_lag=3.0, dashpot=4.0)
    second = Explanation(damping=10.0, skew=20.0, feedback_lag=30.0, dashpot=40.0)
    assert first + second == Explanation(damping=11.0, skew=22.0, feedback_lag=33.0, dashpot=44.0)


@pytest.mark.parametrize("late", [2e-3, -2e-3])
def test_what_ground_and_force_show_is_explained_by_one_cause_or_by_two(late):
    of_equation = VelocityTerm(value=5e-3, deviation=1e-5, least=0.0)
    of_force = VelocityTerm(value=late, deviation=1e-5, least=0.0)
    found = explain(of_equation, of_force, 4.0)
    alone, together = found[:3], found[3:]
    assert [(each.damping, each.skew, each.feedback_lag) for each in alone] == [
        (5e-3, 0.0, 0.0),
        (0.0, 5e-3, 0.0),
        (0.0, 0.0, -5e-3),
    ]
    beside = 5e-3 - late  # what the force does not account for
    expected = {
        (beside, late, 0.0, 0.0),
        (0.0, beside + late, 0.0, 0.0),
        (0.0, late, -beside, 0.0),
        *(
            {
                (beside + late, 0.0, 0.0, late),
                (late, beside, 0.0, late),
                (late, 0.0, -beside, late),
            }
            if late > 0.0
            else {(beside, 0.0, -late, 0.0), (0.0, beside, -late, 0.0), (0.0, 0.0, -beside - late, 0.0)}
        ),
    }
    rounded = {
        tuple(round(part, 9) for part in (each.damping, each.skew, each.feedback_lag, each.dashpot))
        for each in together
    }
    assert rounded == {tuple(round(part, 9) for part in each) for each in expected}


@pytest.mark.parametrize(("lag", "word"), [(1e-3, "later"), (-1e-3, "earlier")])
def test_a_force_that_is_fed_back_late_or_early_is_called_so(lag, word):
    structure = Structure(frequency=1.0, damping_ratio=0.02)
    assert f"a force that is fed back 1 ms {word}" in Explanation(feedback_lag=lag).spoken(structure)


def test_the_interval_on_a_motion_itself_is_that_of_the_draws_of_gain_and_delay(monkeypatch):
    class Boundary:
        """Whose error is the gain's distance from one, and grows with the delay."""

        def __init__(self, **_given):
            pass

        def error(self, gain, delay):
            return np.abs(gain - 1.0) + delay

        def index(self, _gain, _delay):
            return 0.5

        def ellipse(self, side):
            return (1.0, 2.0) if side is Side.LAG else (3.0, 4.0)

    monkeypatch.setattr(own_motion, "OwnBoundary", Boundary)
    monkeypatch.setattr(own_motion, "_excitation", lambda *_given: (None, (1.0, 9.0)))
    draws = np.stack([1.0 + np.linspace(0.01, 0.05, 101), np.full(101, 0.002)])
    for delay, ellipse in ((0.002, (1.0, 2.0)), (-0.002, (3.0, 4.0))):
        tracking = SimpleNamespace(amplitude=1.03, delay=delay, draws=draws)
        question = SimpleNamespace(structure=None, threshold=0.042, metric="rms")
        placed = own_motion.place_on_own(SimpleNamespace(name="m"), tracking, None, question)
        ends = 0.012 + 0.04 * np.array([0.5 - 0.5 * LEVEL, 0.5 + 0.5 * LEVEL])
        np.testing.assert_allclose(placed.error_interval, ends)
        assert placed.error == pytest.approx(0.03 + delay)
        np.testing.assert_allclose(placed.index_interval, 0.5 * (ends / placed.error) ** 2)
        assert placed.probability == pytest.approx(np.mean(draws[0] - 1.0 + 0.002 <= 0.042))
        assert (placed.a, placed.b) == ellipse
