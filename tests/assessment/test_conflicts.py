"""Stated values against what the channels show: the distance over what both leave open."""

from types import SimpleNamespace

import numpy as np
import pytest

from reliab.assessment.inference import posterior as inference

VALUE, DEVIATION = 1.5, 0.2  # of a likelihood, over the deviation of the prior


def posterior(value: float, deviation: float) -> SimpleNamespace:
    """Closed form of a likelihood and of a standard normal prior, in closed form."""
    shrunk = 1.0 / (1.0 + deviation**2)
    fit = SimpleNamespace(mode=np.array([shrunk * value]), covariance=np.array([[deviation**2 * shrunk]]))
    return SimpleNamespace(unknowns=("frequency",), fit=fit)


@pytest.mark.parametrize("share", [1.0, 0.1, 0.0])
def test_a_conflict_is_the_distance_over_the_deviations_of_both(share):
    result = inference.TestPosterior.conflict(posterior(VALUE, DEVIATION), "frequency", share)
    assert result == pytest.approx(VALUE / np.hypot(DEVIATION, share))


def test_channels_that_show_nothing_contradict_nothing():
    assert inference.TestPosterior.conflict(posterior(5.0, 3.0), "frequency") == 0.0
