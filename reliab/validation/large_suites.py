"""Containment on suites of a thousand earthquakes, where sampling noise is small.

Two kinds of suites tell different things. Ellipses drawn from a distribution that is known show
whether a method keeps its word when nothing else is wrong; ellipses of simulated synthetic motions show
it for the distributions that ground motions really have.
"""

from collections.abc import Iterable, Sequence

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from reliab.criterion.scaling import scales
from reliab.progress import Progress, silent
from reliab.validation.cross_validation import Candidate, cross_validate, k_fold
from reliab.validation.generalisation import tabulate
from reliab.vocabulary import ELLIPSE_DIMENSIONS

_ALPHA, _BETA = 0.4, 0.3
"""Geometric means of a/ξ² and bω₀²/ξ², about those of real motions."""


def draw_ellipses(
    *,
    events: int = 1000,
    motions_per_event: int = 2,
    spread: float = 0.6,
    correlation: float = 0.9,
    between_events: float = 0.5,
    skewness: float = 0.0,
    frequencies: Sequence[float] = (1.0,),
    damping_ratio: float = 0.02,
    seed: int = 0,
) -> xr.Dataset:
    """Draw ellipses of motions from a known distribution.

    Parameters
    ----------
    events : int, optional
        Earthquakes.
    motions_per_event : int, optional
        Motions of each.
    spread : float, optional
        Standard deviation of ln a and ln b.
    correlation : float, optional
        Correlation of ln a and ln b.
    between_events : float, optional
        Share of the variance that lies between earthquakes.
    skewness : float, optional
        How much of the deviation is exponential instead of normal, from 0 (lognormal) to 1.
    frequencies : sequence of float, optional
        Frequencies [Hz] at which ellipses are drawn independently.
    damping_ratio : float, optional
        Damping ratio [-].
    seed : int, optional
        Seed.

    Returns
    -------
    xarray.Dataset
        `a` [-] and `b` [ms²] over (motion, f, xi, threshold, metric, curve), at 5 % RMS^R.
    """
    rng = np.random.default_rng(seed)
    covariance = np.linalg.cholesky([[1.0, correlation], [correlation, 1.0]])
    count = len(frequencies)

    def deviation(rows: int) -> NDArray[np.float64]:
        normal = rng.normal(size=(rows, count, 2))
        skewed = rng.exponential(size=(rows, count, 2)) - 1.0
        return np.asarray((np.sqrt(1.0 - skewness) * normal + np.sqrt(skewness) * skewed) @ covariance.T)

    between = np.repeat(deviation(events), motions_per_event, axis=0)
    within = deviation(events * motions_per_event)
    total = spread * (np.sqrt(between_events) * between + np.sqrt(1.0 - between_events) * within)
    scale_a, scale_b = scales(np.asarray(frequencies), damping_ratio)
    values = {"a": _ALPHA * scale_a * np.exp(total[..., 0]), "b": _BETA * scale_b * np.exp(total[..., 1])}
    event = np.repeat([f"E{number}" for number in range(events)], motions_per_event)
    return xr.Dataset(
        {name: (ELLIPSE_DIMENSIONS, each[..., None, None, None, None]) for name, each in values.items()},
        coords={
            "motion": [f"{each}/{number}" for number, each in enumerate(event)],
            "event": ("motion", event),
            "f": list(frequencies),
            "xi": [damping_ratio],
            "threshold": [0.05],
            "metric": ["rms"],
            "curve": ["ellipse"],
        },
    )


def suite_containment(
    suites: Iterable[tuple[str, xr.Dataset]],
    candidates: Sequence[Candidate],
    *,
    count: int,
    folds: int = 5,
    confidences: Sequence[float] = (0.80, 0.90, 0.95, 0.99),
    threshold: float = 0.05,
    metric: str = "rms",
    progress: Progress = silent,
) -> pd.DataFrame:
    """Cross-validate criteria on large suites, by groups of earthquakes.

    Parameters
    ----------
    suites : iterable of (str, xarray.Dataset)
        Name and ellipses of each suite.
    candidates : sequence of Candidate
        Criteria on trial.
    count : int
        Number of suites, for the progress.
    folds : int, optional
        Groups of earthquakes.
    confidences : sequence of float, optional
        Stated shares of the motions.
    threshold : float, optional
        Error on the boundary [-].
    metric : str, optional
        Which error.
    progress : callable, optional
        Called after each suite.

    Returns
    -------
    pandas.DataFrame
        Columns `suite` and those of :func:`reliab.validation.generalisation.tabulate`.
    """
    tables = []
    for done, (name, ellipses) in enumerate(suites, start=1):
        found = cross_validate(
            ellipses,
            k_fold(ellipses["event"].values, folds),
            candidates,
            scheme=name,
            confidences=confidences,
            threshold=threshold,
            metric=metric,
            trials=64,
        )
        tables.append(tabulate(found).assign(suite=name))
        progress(done, count)
    return pd.concat(tables, ignore_index=True)
