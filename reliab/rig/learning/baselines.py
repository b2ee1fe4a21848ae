"""Two simpler ways to predict a test, to compare with: all tests pooled, and the last ten."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.core.arrays import Array

_LAST = 10
_FEWEST = 3

Baseline = Callable[[Array], "StudentPrediction"]
"""Predicts a further value from values in the order of tests."""


@dataclass(frozen=True, kw_only=True)
class StudentPrediction:
    """A scaled Student t distribution."""

    centre: float
    scale: float
    degrees: float

    def log_density(self, value: float) -> float:
        """Logarithm of the density."""
        return float(scipy.stats.t.logpdf(value, self.degrees, self.centre, self.scale))


def pooled(values: Array) -> StudentPrediction:
    """Predict from all tests, as if they were independent and normal.

    >>> pooled(np.array([1.0, 2.0, 3.0])).centre
    2.0
    """
    spread = max(float(values.std(ddof=1)), 1e-9)
    return StudentPrediction(
        centre=float(values.mean()),
        scale=spread * np.sqrt(1.0 + 1.0 / values.size),
        degrees=values.size - 1.0,
    )


def last_ten(values: Array) -> StudentPrediction:
    """Predict from the last ten tests."""
    return pooled(values[-_LAST:])


def left_out_scores(values: Array, events: NDArray[np.str_], baseline: Baseline, *, before: bool) -> Array:
    """Log scores of a baseline for each test, its earthquake left out.

    `before`: whether only tests before each are known; NaN where there are fewer than three.
    """
    scores = np.full(values.size, np.nan)
    for place, event in enumerate(events):
        usable = events != event
        if before:
            usable[place:] = False
        if usable.sum() >= _FEWEST:
            scores[place] = baseline(values[usable]).log_density(values[place])
    return scores
