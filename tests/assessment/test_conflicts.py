"""Values that were stated as exact, against what the channels show."""

import pytest

from reliab.assessment.conflicts import Identification, IdentifiedParameter

NAMES = ("frequency", "damping_ratio", "experimental_fraction", "feedback_lag")


@pytest.mark.parametrize(
    ("off", "deviation", "departs"),
    [
        (0.0301, 0.01, True),
        (0.0299, 0.01, False),
        (0.021, 1e-4, True),
        (0.019, 1e-4, False),
        (-0.0301, 0.01, True),
    ],
)
def test_a_stated_value_is_wrong_by_three_standard_errors_and_more_than_matters(off, deviation, departs):
    assert IdentifiedParameter(value=1.0 + off, deviation=deviation, stated=1.0).departs(0.02) is departs


def test_deviations_are_relative_except_for_a_lag():
    """0.5 % of the frequency, 2 % of the damping ratio, 2 % of the share, 0.1 ms of the lag."""

    def identification(factor):
        return Identification(
            frequency=IdentifiedParameter(value=2.0 * (1.0 + 0.005 * factor), deviation=0.0, stated=2.0),
            damping_ratio=IdentifiedParameter(value=0.04 * (1.0 - 0.02 * factor), deviation=0.0, stated=0.04),
            experimental_fraction=IdentifiedParameter(
                value=0.5 * (1.0 + 0.02 * factor), deviation=0.0, stated=0.5
            ),
            feedback_lag=IdentifiedParameter(value=1e-3 - 1e-4 * factor, deviation=0.0, stated=1e-3),
            misfit=0.0,
        )

    assert identification(0.99).disagreements() == ()
    assert identification(1.01).disagreements() == NAMES
