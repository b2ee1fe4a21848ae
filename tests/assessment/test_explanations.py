"""Causes that explain a test together are put together part by part."""

import pytest

from reliab.assessment.explanations import Explanation, VelocityTerm, explain

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
