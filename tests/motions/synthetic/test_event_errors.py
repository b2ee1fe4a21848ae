"""The errors of the stations: their published scatter and correlation, and what an earthquake shares."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats

from reliab.motions.synthetic.dabaghi_der_kiureghian_2018 import NO_PULSE, PULSE, Regression
from reliab.motions.synthetic.random_stream import RandomStream
from reliab.motions.synthetic.suite import EVENT_SHARE, EventErrors

_BOTH = pytest.mark.parametrize("regression", [NO_PULSE, PULSE], ids=["no pulse", "pulse"])
_EVENTS = 2000


def _keep(error: NDArray[np.float64]) -> NDArray[np.float64]:
    return error


def _standard_errors(regression: Regression, stations: int) -> NDArray[np.float64]:
    """Errors over their standard deviations, shape (events, stations, p)."""
    drawn = []
    for event in range(_EVENTS):
        errors = EventErrors(regression, RandomStream(1, event, 0))
        drawn.append([errors.draw(RandomStream(1, event, 1 + i), _keep) for i in range(stations)])
    return np.array(drawn) / regression.deviations


@pytest.mark.default_cases(1)
@_BOTH
def test_first_station_has_the_published_distribution(regression: Regression) -> None:
    """Against draws by NumPy, cut in the same way."""
    ours = _standard_errors(regression, 1)[:, 0]
    theirs = np.random.default_rng(7).multivariate_normal(
        np.zeros(len(regression.names)), regression.correlation, size=20000
    )
    theirs = theirs[np.abs(theirs).max(axis=1) <= 2.0]
    assert np.abs(ours).max() <= 2.0
    assert np.corrcoef(ours.T) == pytest.approx(np.corrcoef(theirs.T), abs=0.12)
    levels = [stats.ks_2samp(*pair).pvalue for pair in zip(ours.T, theirs.T, strict=True)]
    assert min(levels) > 0.01 / len(levels)


@pytest.mark.default_cases(1)
@_BOTH
def test_stations_of_an_earthquake_share_a_part_of_the_variance(regression: Regression) -> None:
    """The cut at two standard deviations takes a fifth of the share away."""
    first, second, third = _standard_errors(regression, 3).transpose(1, 2, 0)
    for one, other in [(first, second), (second, third), (first, third)]:
        correlations = [np.corrcoef(*pair)[0, 1] for pair in zip(one, other, strict=True)]
        assert np.mean(correlations) == pytest.approx(0.8 * EVENT_SHARE, abs=0.04)


def test_earthquakes_share_nothing() -> None:
    first = _standard_errors(NO_PULSE, 1)[:, 0, 0]
    assert abs(np.corrcoef(first[:-1], first[1:])[0, 1]) < 0.1


def test_later_stations_leave_the_first_alone() -> None:
    alone = EventErrors(PULSE, RandomStream(1, 0))
    crowded = EventErrors(PULSE, RandomStream(1, 0))
    first = crowded.draw(RandomStream(1, 1), _keep)
    crowded.draw(RandomStream(1, 2), _keep)
    assert np.array_equal(alone.draw(RandomStream(1, 1), _keep), first)


def test_errors_without_a_motion_are_drawn_again() -> None:
    seen = []

    def attempt(error: NDArray[np.float64]) -> str | None:
        seen.append(error)
        return "a motion" if len(seen) == 3 else None

    errors = EventErrors(NO_PULSE, RandomStream(1, 0))
    assert errors.draw(RandomStream(1, 1), attempt) == "a motion"
    assert len(seen) == 3
