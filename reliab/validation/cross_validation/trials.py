"""Tests that a criterion is asked about, and what really became of them.

A laboratory's tests have an amplitude error and a delay somewhere around the boundary. Here they lie
evenly over the area of an ellipse of twice the typical size, the typical being the geometric means of
a and b over the motions, so that about a quarter of them would be good for the typical motion.
Whether a test is good for a motion is read from the simulated error, or from the motion's ellipse.
"""

from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.stats import qmc

from reliab.vocabulary import Metric

_SIZE = 2.0
_MILLISECONDS = 1e3


@dataclass(frozen=True, kw_only=True)
class Cell:
    """One structure and one error.

    Parameters
    ----------
    frequency, damping_ratio : float
        The structure [Hz, -].
    threshold : float
        Error on the boundary [-].
    metric : str
        Which error, "rms" or "mte".
    """

    frequency: float
    damping_ratio: float
    threshold: float
    metric: str


@dataclass(frozen=True, kw_only=True, eq=False)
class Trials:
    """Tests and their fate.

    Attributes
    ----------
    offset : numpy.ndarray
        Amplitude error A − 1 [-], shape (trials,).
    delay : numpy.ndarray
        Equivalent delay [ms], not negative, shape (trials,).
    good : numpy.ndarray
        Whether the error stays below the threshold, boolean, shape (motions, trials).
    """

    offset: NDArray[np.float64]
    delay: NDArray[np.float64]
    good: NDArray[np.bool_]

    def accepted(self, a: float, b: float) -> NDArray[np.bool_]:
        """Which trials a criterion with limits a [-] and b [ms²] accepts, shape (trials,)."""
        if not (a > 0.0 and b > 0.0):
            return np.zeros(self.offset.size, dtype=np.bool_)
        return np.asarray(self.offset**2 / a + self.delay**2 / b <= 1.0)


def draw_trials(
    ellipses: xr.Dataset, cell: Cell, count: int, *, results: xr.Dataset | None = None, seed: int = 0
) -> Trials:
    """Draw tests for one structure and find what becomes of them.

    Parameters
    ----------
    ellipses : xarray.Dataset
        Ellipses of all motions.
    cell : Cell
        Structure and error.
    count : int
        Number of tests.
    results : xarray.Dataset, optional
        Simulated results of the same motions, from which the errors are read; without them a test
        is good for a motion when it lies inside the motion's ellipse.
    seed : int, optional
        Seed of the scrambled Sobol points.

    Returns
    -------
    Trials
        The tests.
    """
    at = ellipses.sel(
        f=cell.frequency, xi=cell.damping_ratio, threshold=cell.threshold, metric=cell.metric, curve="ellipse"
    )
    a, b = at["a"].values, at["b"].values
    known = np.isfinite(a) & np.isfinite(b) & (a > 0.0) & (b > 0.0)
    half_axes = _SIZE * np.sqrt(np.exp([np.log(a[known]).mean(), np.log(b[known]).mean()]))
    uniform = qmc.Sobol(2, rng=seed).random(count)
    radius, angle = np.sqrt(uniform[:, 0]), np.pi * uniform[:, 1]
    offset, delay = half_axes[0] * radius * np.cos(angle), half_axes[1] * radius * np.sin(angle)
    if results is None:
        index = np.square(offset) / a[:, np.newaxis] + np.square(delay) / b[:, np.newaxis]
        good = (index <= 1.0) | ~known[:, np.newaxis]
    else:
        error = results.reliab.errors(
            f=cell.frequency,
            xi=cell.damping_ratio,
            gain=1.0 + offset,
            delay=delay / _MILLISECONDS,
            metric=Metric(cell.metric),
        )
        good = error.values <= cell.threshold
    return Trials(offset=offset, delay=delay, good=np.asarray(good, dtype=np.bool_))
