"""What `reliab criterion` says about one structure: plain numbers with stable keys."""

from typing import Any

import numpy as np
import xarray as xr

from reliab.criterion.criterion import Criterion
from reliab.criterion.distributions import Lognormal
from reliab.criterion.ellipse_sample import sample_of


def summarise(
    criterion: Criterion, ellipses: xr.Dataset, frequency: float, damping_ratio: float
) -> dict[str, Any]:
    """Summarise a criterion at one structure beside the sample it was derived from.

    Parameters
    ----------
    criterion : Criterion
        The criterion.
    ellipses : xarray.Dataset
        The ellipses it was derived from.
    frequency, damping_ratio : float
        The structure [Hz, -].

    Returns
    -------
    dict
        Limits `a` [-] and `b` [ms²], their roots `amplitude_limit` [-] and `delay_limit_ms` [ms], what
        was asked for, and the sample's size, correlation and lognormal parameters; ready for JSON.
    """
    a, b = (float(limit) for limit in criterion.limits(frequency, damping_ratio))
    sample = sample_of(
        ellipses,
        frequency=frequency,
        damping_ratio=damping_ratio,
        threshold=criterion.threshold,
        metric=criterion.metric,
    )
    fits = {"a": Lognormal.fit(sample.a), "b": Lognormal.fit(sample.b)}
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
        "amplitude_limit": float(np.sqrt(a)),
        "delay_limit_ms": float(np.sqrt(b)),
        "correlation": sample.correlation if np.isfinite(sample.correlation) else None,
        "n_motions": sample.n_motions,
        "n_events": sample.n_events,
        "lognormal": {name: {"mu": fit.mu, "sigma": fit.sigma} for name, fit in fits.items()},
        "law": criterion.law.name,
        "warnings": list(criterion.provenance.warnings),
    }
