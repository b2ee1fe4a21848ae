"""Scores of distributions on the motions of held-out earthquakes."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from reliab.criterion.distributions import DISTRIBUTIONS, Distribution, Lognormal

TAIL = 0.05
"""The quantile by which tails are judged, that of a criterion at 95 %."""


@dataclass(frozen=True, kw_only=True, eq=False)
class HeldOutScores:
    """Scores of every motion by a distribution fitted without its earthquake."""

    # Logarithm of the density of the motion's logarithm; higher is better, shape (motions,)
    log_score: NDArray[np.float64]
    # Pinball loss of the 5 % quantile of the logarithm; lower is better, shape (motions,)
    tail_score: NDArray[np.float64]


def leave_one_event_out(events: NDArray[np.str_]) -> Iterator[NDArray[np.bool_]]:
    """Masks of the motions of each earthquake in turn, shape (motions,)."""
    for event in np.unique(events):
        yield events == event


def held_out_scores(
    values: NDArray[np.float64], events: NDArray[np.str_], family: type[Distribution]
) -> HeldOutScores:
    """Score motions by a distribution fitted to those of all other earthquakes.

    `values`, `events` (motions,).
    """
    log_score, tail_score = np.empty(values.size), np.empty(values.size)
    for held_out in leave_one_event_out(events):
        fitted = family.fit(values[~held_out])
        log_score[held_out] = fitted.log_density(values[held_out]) + np.log(values[held_out])
        excess = np.log(values[held_out]) - np.log(fitted.quantile(TAIL))
        tail_score[held_out] = excess * (TAIL - (excess < 0.0))
    return HeldOutScores(log_score=log_score, tail_score=tail_score)


def compare_distributions(values: NDArray[np.float64], events: NDArray[np.str_]) -> pd.DataFrame:
    """Compare all distributions by their scores on held-out earthquakes.

    Returns one row for each distribution, best log score first: mean scores, the gain in log score over the
    lognormal with its standard error over earthquakes, and the fitted 5 % quantile.

    >>> rng = np.random.default_rng(1)
    >>> values, events = rng.weibull(1.0, 300), np.repeat(np.arange(10), 30).astype(str)
    >>> compare_distributions(values, events).loc["weibull", "gain"] > 0.0
    np.True_
    """
    reference = held_out_scores(values, events, Lognormal)
    rows = {}
    for name, family in DISTRIBUTIONS.items():
        scores = held_out_scores(values, events, family)
        difference = scores.log_score - reference.log_score
        rows[name] = {
            "log_score": scores.log_score.mean(),
            "gain": difference.mean(),
            "standard_error": _error_over_events(difference, events),
            "tail_score": scores.tail_score.mean(),
            "quantile_05": float(family.fit(values).quantile(TAIL)),
        }
    return pd.DataFrame.from_dict(rows, orient="index").sort_values("log_score", ascending=False)


def _error_over_events(values: NDArray[np.float64], events: NDArray[np.str_]) -> float:
    """Find the standard error of a mean over motions whose earthquakes were drawn."""
    deviation = values - values.mean()
    sums = np.array([deviation[event].sum() for event in leave_one_event_out(events)])
    return float(np.sqrt((sums**2).sum()) / values.size)
