"""Check of stated probabilities: how many of the tests stated to be good with 80 % are good."""

from collections.abc import Sequence
from itertools import product

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from reliab.core.progress import Progress, silent
from reliab.criterion.population import Population
from reliab.validation.counts import event_bootstrap
from reliab.validation.folds import folds_of
from reliab.validation.truth import Cell, EllipseTruth, Truth, draw_trials

EDGES = (0.0, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99, 1.0)
"""Edges of the bins of stated probability."""


def probability_calibration(
    ellipses: xr.Dataset,
    *,
    scheme: str = "leave_one_event_out",
    edges: Sequence[float] = EDGES,
    threshold: float = 0.05,
    metric: str = "rms",
    truth: Truth | None = None,
    trials: int = 256,
    progress: Progress = silent,
) -> pd.DataFrame:
    """Compare probabilities stated for tests with the share of good tests under unseen motions.

    `threshold` [-].
    Returns one row a bin: mean `stated` probability, share `observed` of good tests with `low` and `high`
    ends of its 95 % interval over earthquakes, and number of `tests`.
    """
    events, truth = ellipses["event"].values, truth or EllipseTruth(ellipses)
    folds = folds_of(scheme, events, ellipses["duration"].values if "duration" in ellipses.coords else None)
    structures = list(product(ellipses["f"].values.tolist(), ellipses["xi"].values.tolist()))
    shape = (events.size, len(edges) - 1)
    stated_sums, good, count = (np.zeros(shape) for _ in range(3))
    for step, (f, xi) in enumerate(structures, start=1):
        structure_ellipses = ellipses.sel(f=[f], xi=[xi])
        cell = Cell(frequency=f, damping_ratio=xi, threshold=threshold, metric=metric)
        tests = draw_trials(ellipses, cell, trials)
        errors = np.array([truth.errors(cell, k, tests.gain, tests.delay) for k in range(events.size)])
        for fold in folds:
            population = Population.from_ellipses(
                structure_ellipses.isel(motion=fold.learned), threshold=threshold, metric=metric
            )
            probability = population.probability(tests.gain, tests.delay, f, xi)
            bins = np.clip(np.digitize(probability, edges) - 1, 0, shape[1] - 1)
            for motion in np.flatnonzero(fold.judged):
                is_finite = np.isfinite(errors[motion])
                stated_sums[motion] += np.bincount(bins[is_finite], probability[is_finite], shape[1])
                good[motion] += np.bincount(bins[is_finite], errors[motion][is_finite] <= 1.0, shape[1])
                count[motion] += np.bincount(bins[is_finite], minlength=shape[1])
        progress(step, len(structures))
    return _table(stated_sums, good, count, events)


def _table(
    stated_sums: NDArray[np.float64],
    good: NDArray[np.float64],
    count: NDArray[np.float64],
    events: NDArray[np.str_],
) -> pd.DataFrame:
    is_filled = count.sum(axis=0) > 0.0
    low, high = event_bootstrap(good[:, is_filled], count[:, is_filled], events)
    total = count[:, is_filled].sum(axis=0)
    return pd.DataFrame(
        {
            "stated": stated_sums[:, is_filled].sum(axis=0) / total,
            "observed": good[:, is_filled].sum(axis=0) / total,
            "low": low,
            "high": high,
            "tests": total.astype(np.int64),
        }
    )
