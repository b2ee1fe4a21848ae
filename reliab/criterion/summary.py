"""What `reliab criterion` says about one structure: plain numbers with stable keys."""

from typing import Any

import numpy as np

from reliab.criterion.criterion import Criterion
from reliab.criterion.distributions import Lognormal
from reliab.criterion.ellipse_sample import sample_of
from reliab.criterion.ellipse_table import Ellipses


def summarise(criterion: Criterion, frequency: float, damping_ratio: float) -> dict[str, Any]:
    """Summarise a criterion at one structure.

    `frequency`, `damping_ratio`: the structure [Hz, -]. Returns limits `a` [-] and `b` [ms²] of lags,
    `a_lead` and `b_lead` of leads (None where the criterion has none); `amplitude_limit` [-],
    `delay_limit_ms` and `lead_limit_ms` [ms], the largest amplitude error, lag and lead of a test that has no
    other error; the promise, and the data behind it; ready for JSON.

    >>> from reliab.criterion.published import published_criterion
    >>> summary = summarise(published_criterion("guo_2017_12"), 1.0, 0.02)
    >>> round(summary["amplitude_limit"], 4), round(summary["delay_limit_ms"], 2)
    (0.0073, 1.02)
    """
    a, b = (float(limit) for limit in criterion.limits(frequency, damping_ratio))
    lead = (None, None) if criterion.lead_law is None else criterion.lead_law.limits(frequency, damping_ratio)
    a_lead, b_lead = (None if limit is None else float(limit) for limit in lead)
    return {
        "a": a,
        "b": b,
        "a_lead": a_lead,
        "b_lead": b_lead,
        "f": frequency,
        "xi": damping_ratio,
        "threshold": criterion.threshold,
        "metric": criterion.metric,
        "confidence": criterion.promise,
        "method": criterion.method,
        "joint": criterion.joint,
        **criterion.provenance.settings,
        "law": criterion.law.name,
        "equation": criterion.law.equation,
        "amplitude_limit": float(np.sqrt(a)),
        "delay_limit_ms": float(np.sqrt(b)),
        "lead_limit_ms": None if b_lead is None else float(np.sqrt(b_lead)),
        "window": criterion.provenance.window,
        "alpha": criterion.provenance.experimental_fraction,
        "curve": criterion.provenance.curve,
        "motions": criterion.provenance.motions,
        "n_motions": criterion.provenance.n_motions,
        "n_events": criterion.provenance.n_events,
        "population": criterion.provenance.population,
        "scope": criterion.provenance.scope,
        "position": criterion.provenance.position,
        "warnings": list(criterion.provenance.warnings),
    }


def describe_sample(
    ellipses: Ellipses, criterion: Criterion, frequency: float, damping_ratio: float
) -> dict[str, Any]:
    """Describe the motions of one structure that a criterion was derived from.

    `frequency`, `damping_ratio`: the structure [Hz, -], one of the dataset's. Returns `correlation` of a and
    b, `n_motions` and `n_events` with an ellipse there, and the parameters of the lognormal distributions
    fitted to a and b.
    """
    sample = sample_of(
        ellipses,
        frequency=frequency,
        damping_ratio=damping_ratio,
        threshold=criterion.threshold,
        metric=criterion.metric,
        curve=criterion.provenance.curve,
    )
    fits = {"a": Lognormal.fit(sample.a), "b": Lognormal.fit(sample.b)}
    return {
        "correlation": sample.correlation,
        "n_motions": sample.n_motions,
        "n_events": sample.n_events,
        "lognormal": {name: {"mu": fit.mu, "sigma": fit.sigma} for name, fit in fits.items()},
    }
