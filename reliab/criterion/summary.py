"""What `reliab criterion` says about one structure: plain numbers with stable keys."""

from typing import Any

import numpy as np
import xarray as xr

from reliab.criterion.criterion import Criterion
from reliab.criterion.distributions import Lognormal
from reliab.criterion.ellipse_sample import sample_of


def summarise(criterion: Criterion, frequency: float, damping_ratio: float) -> dict[str, Any]:
    """Summarise a criterion at one structure.

    Parameters
    ----------
    criterion : Criterion
        The criterion.
    frequency, damping_ratio : float
        The structure [Hz, -].

    Returns
    -------
    dict
        Limits `a` [-] and `b` [ms²], their roots `amplitude_limit` [-] and `delay_limit_ms` [ms], what
        was asked for, and what stands behind it; ready for JSON.

    Examples
    --------
    >>> from reliab.criterion.criterion import published_criterion
    >>> found = summarise(published_criterion("guo_2017_12"), 1.0, 0.02)
    >>> round(found["amplitude_limit"], 4), round(found["delay_limit_ms"], 2)
    (0.0073, 1.02)
    """
    a, b = (float(limit) for limit in criterion.limits(frequency, damping_ratio))
    return {
        "a": a,
        "b": b,
        "f": frequency,
        "xi": damping_ratio,
        "threshold": criterion.threshold,
        "metric": criterion.metric,
        "confidence": criterion.confidence,
        "method": criterion.method,
        "joint": criterion.joint,
        **criterion.provenance.settings,
        "law": criterion.law.name,
        "equation": criterion.law.equation,
        "amplitude_limit": float(np.sqrt(a)),
        "delay_limit_ms": float(np.sqrt(b)),
        "n_motions": criterion.provenance.n_motions,
        "n_events": criterion.provenance.n_events,
        "warnings": list(criterion.provenance.warnings),
    }


def describe_sample(
    ellipses: xr.Dataset, criterion: Criterion, frequency: float, damping_ratio: float
) -> dict[str, Any]:
    """Describe the motions of one structure that a criterion was derived from.

    Parameters
    ----------
    ellipses : xarray.Dataset
        The ellipses.
    criterion : Criterion
        The criterion, for its threshold and metric.
    frequency, damping_ratio : float
        The structure [Hz, -], one of the dataset's.

    Returns
    -------
    dict
        `correlation` of a and b (None where one is constant), `n_motions` and `n_events` with an ellipse
        there, and the parameters of the lognormal distributions fitted to a and b.
    """
    sample = sample_of(
        ellipses,
        frequency=frequency,
        damping_ratio=damping_ratio,
        threshold=criterion.threshold,
        metric=criterion.metric,
    )
    fits = {"a": Lognormal.fit(sample.a), "b": Lognormal.fit(sample.b)}
    return {
        "correlation": sample.correlation if np.isfinite(sample.correlation) else None,
        "n_motions": sample.n_motions,
        "n_events": sample.n_events,
        "lognormal": {name: {"mu": fit.mu, "sigma": fit.sigma} for name, fit in fits.items()},
    }
