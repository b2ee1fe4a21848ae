"""Confidence intervals of rates over motions that are grouped by earthquake."""

import numpy as np
from numpy.typing import NDArray

_REPETITIONS = 2000


def event_bootstrap(
    numerator: NDArray[np.float64],
    denominator: NDArray[np.float64],
    events: NDArray[np.str_],
    *,
    level: float = 0.95,
    seed: int = 0,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Interval of Σ numerator / Σ denominator, whole earthquakes being drawn with replacement.

    `events` (motions,).
    Returns `low, high`: ends of the interval, in the trailing shape; NaN where there is nothing to be
    counted.

    Davison, A. C. and Hinkley, D. V. (1997). *Bootstrap Methods and their Application*, section 3.8.
    """
    distinct, group = np.unique(events, return_inverse=True)
    top = np.zeros((distinct.size, *numerator.shape[1:]))
    bottom = np.zeros_like(top)
    np.add.at(top, group, numerator)
    np.add.at(bottom, group, denominator)
    rng = np.random.default_rng(seed)
    drawn = rng.multinomial(distinct.size, np.full(distinct.size, 1.0 / distinct.size), _REPETITIONS)
    with np.errstate(invalid="ignore", divide="ignore"):  # nothing accepted in a drawing
        rates = np.tensordot(drawn, top, axes=1) / np.tensordot(drawn, bottom, axes=1)
    ends = np.full((2, *rates.shape[1:]), np.nan)
    known = bottom.sum(axis=0) > 0.0
    ends[:, known] = np.nanquantile(rates[:, known], [0.5 * (1.0 - level), 0.5 * (1.0 + level)], axis=0)
    return ends[0], ends[1]
