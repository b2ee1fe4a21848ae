"""How close the suite is to the 100 real components, in intensity, duration and period."""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from reliab.motions.loading import load_motions
from reliab.motions.motion import measure
from reliab.motions.suite import MotionSuite
from reliab.motions.synthetic.suite import synthetic_suite


def _logarithms(suite: MotionSuite) -> NDArray[np.float64]:
    """Peak, Arias intensity, D5-95 and mean period, shape (4, n)."""
    measures = [measure(motion) for motion in suite]
    return np.log(
        [
            [item.peak_acceleration, item.arias_intensity, item.significant_duration, item.mean_period]
            for item in measures
        ]
    ).T


@pytest.fixture(scope="module")
def distributions(real_motions_folder: Path) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    return _logarithms(load_motions(real_motions_folder)), _logarithms(synthetic_suite(count=400))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("row", "ratio"),
    [(0, 0.85), (1, 1.1), (2, 1.3), (3, 0.65)],
    ids=["peak", "Arias intensity", "duration", "mean period"],
)
def test_medians_stand_in_the_stated_ratio(
    distributions: tuple[NDArray[np.float64], NDArray[np.float64]], row: int, ratio: float
) -> None:
    real, synthetic = (np.median(measures[row]) for measures in distributions)
    assert np.exp(synthetic - real) == pytest.approx(ratio, rel=0.15)


@pytest.mark.slow
@pytest.mark.parametrize("row", range(4), ids=["peak", "Arias intensity", "duration", "mean period"])
def test_scatter_matches_real_records(
    distributions: tuple[NDArray[np.float64], NDArray[np.float64]], row: int
) -> None:
    real, synthetic = (np.std(measures[row]) for measures in distributions)
    assert synthetic == pytest.approx(real, rel=0.25)
