"""Whether stated probabilities come true: how many tests said to be good with 80 % are good."""

from collections.abc import Sequence
from itertools import product

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from reliab.criterion.population import Population
from reliab.progress import Progress, silent
from reliab.validation.cross_validation import folds_of
from reliab.validation.cross_validation.intervals import event_bootstrap
from reliab.validation.cross_validation.trials import Cell, draw_trials

EDGES = (0.0, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99, 1.0)
"""Edges of the bins of stated probability."""

_MILLISECONDS = 1e3


def probability_calibration(
    ellipses: xr.Dataset,
    *,
    scheme: str = "leave_one_event_out",
    edges: Sequence[float] = EDGES,
    threshold: float = 0.05,
    metric: str = "rms",
    results: xr.Dataset | None = None,
    trials: int = 256,
    progress: Progress = silent,
) -> pd.DataFrame:
    """Compare probabilities stated for tests with what becomes of the tests under unseen motions.

    Parameters
    ----------
    ellipses : xarray.Dataset
        Ellipses over (motion, f, xi, threshold, metric, curve).
    scheme : str, optional
        How the earthquakes are divided.
    edges : sequence of float, optional
        Edges of the bins of probability, from 0 to 1.
    threshold : float, optional
        Error on the boundary [-].
    metric : str, optional
        Which error.
    results : xarray.Dataset, optional
        Simulated results of the same motions, from which the fate of tests is read.
    trials : int, optional
        Tests for each structure.
    progress : callable, optional
        Called after each structure.

    Returns
    -------
    pandas.DataFrame
        One row a bin: mean `stated` probability, share `observed` of good tests with `low` and `high`
        ends of its 95 % interval over earthquakes, and number of `tests`.
    """
    events = ellipses["event"].values
    folds = folds_of(scheme, events)
    structures = list(product(ellipses["f"].values.tolist(), ellipses["xi"].values.tolist()))
    shape = (events.size, len(edges) - 1)
    stated, good, count = (np.zeros(shape) for _ in range(3))
    for done, (f, xi) in enumerate(structures, start=1):
        at = ellipses.sel(f=[f], xi=[xi])
        cell = Cell(frequency=f, damping_ratio=xi, threshold=threshold, metric=metric)
        drawn = draw_trials(ellipses, cell, trials, results=results)
        for fold in folds:
            population = Population.of(at.isel(motion=fold.learned), threshold=threshold, metric=metric)
            told = population.probability(1.0 + drawn.offset, drawn.delay / _MILLISECONDS, f, xi)
            bins = np.clip(np.digitize(told, edges) - 1, 0, shape[1] - 1)
            judged = np.flatnonzero(fold.judged)
            place = np.ix_(judged, np.arange(shape[1]))
            sums = (np.bincount(bins, weights, shape[1]) for weights in (told, np.ones_like(told)))
            stated[place], count[place] = (
                total[place] + each for total, each in zip((stated, count), sums, strict=True)
            )
            for motion in judged:
                good[motion] += np.bincount(bins, drawn.good[motion], shape[1])
        progress(done, len(structures))
    return _table(stated, good, count, events)


def _table(
    stated: NDArray[np.float64],
    good: NDArray[np.float64],
    count: NDArray[np.float64],
    events: NDArray[np.str_],
) -> pd.DataFrame:
    filled = count.sum(axis=0) > 0.0
    low, high = event_bootstrap(good[:, filled], count[:, filled], events)
    total = count[:, filled].sum(axis=0)
    return pd.DataFrame(
        {
            "stated": stated[:, filled].sum(axis=0) / total,
            "observed": good[:, filled].sum(axis=0) / total,
            "low": low,
            "high": high,
            "tests": total.astype(np.int64),
        }
    )
