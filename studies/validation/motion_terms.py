"""Whether a property of the ground motion improves a law: its gain on held-out earthquakes."""

from collections.abc import Mapping

import numpy as np
import pandas as pd
import scipy
import xarray as xr
from numpy.typing import NDArray

from reliab.core.errors import InputError
from reliab.criterion.laws.dimensionless import Dimensionless
from reliab.criterion.population import Population

from .law_comparison import leave_one_event_out


def gain_of_terms(
    ellipses: xr.Dataset,
    terms: Mapping[str, NDArray[np.float64]],
    *,
    threshold: float = 0.05,
    metric: str = "rms",
) -> pd.DataFrame:
    """Gain in held-out log score of the dimensionless law by terms of the motion.

    Each earthquake is held out in turn; the law, with a term times one coefficient for a and one for b, is
    fitted to the others, and the log-density of the held-out (ln a, ln b) is compared with that of the law
    alone. A term is worth having where its gain exceeds twice its standard error.

    Returns one row for each term: gain (nats per motion and structure), standard_error over earthquakes, and
    the shares of the variance between motions that the term explains in a and in b (`explained_a`,
    `explained_b`, at one structure on average, with a coefficient for each structure).

    >>> rng = np.random.default_rng(1)
    >>> dims, length = ("motion", "f", "xi", "threshold", "metric", "curve", "side"), rng.normal(size=60)
    >>> common = 0.7 * length[:, None, None] + rng.normal(0.0, 0.3, (60, 2, 2))
    >>> a = np.exp(common)[..., None, None, None, None]
    >>> dataset = xr.Dataset(
    ...     {"a": (dims, a), "b": (dims, a * np.exp(rng.normal(0.0, 0.1, a.shape)))},
    ...     coords={"f": [1.0, 2.0], "xi": [0.02, 0.05], "threshold": [0.05], "metric": ["rms"],
    ...             "curve": ["ellipse"], "side": ["lag"],
    ...             "event": ("motion", np.repeat(np.arange(20), 3).astype(str))},
    ... )
    >>> gains = gain_of_terms(dataset, {"length": length, "noise": rng.normal(size=60)})
    >>> gains["gain"].gt(2.0 * gains["standard_error"]).to_dict()
    {'length': True, 'noise': False}
    """
    population = Population.from_ellipses(ellipses, threshold=threshold, metric=metric)
    values = np.stack([population.log_alpha, population.log_beta], axis=-1)
    law = np.broadcast_to(
        Dimensionless.terms_of(population.frequencies, population.damping_ratios), (*values.shape[:3], 6)
    )
    base = _scores(values, [law, law], population.events)
    rows = {}
    for name, term in terms.items():
        spread_term = _broadcast_over_structures(name, term, values.shape)
        designs = [np.concatenate([law, spread_term[..., k, None]], axis=-1) for k in range(2)]
        difference = _scores(values, designs, population.events) - base
        explained = _correlate_terms(values, spread_term)
        rows[name] = {
            "gain": np.nanmean(difference),
            "standard_error": _error(difference, population.events),
            "explained_a": explained[..., 0].mean(),
            "explained_b": explained[..., 1].mean(),
        }
    return pd.DataFrame.from_dict(rows, orient="index")


def _broadcast_over_structures(
    name: str, term: NDArray[np.float64], shape: tuple[int, ...]
) -> NDArray[np.float64]:
    if term.shape == shape:
        return term
    if term.shape == shape[:1]:
        return np.broadcast_to(term[:, None, None, None], shape)
    raise InputError(
        "A term must have one value for each motion, or one for each motion, structure and parameter",
        value=f"{name} of shape {term.shape}, motions {shape}",
    )


def _scores(
    values: NDArray[np.float64], designs: list[NDArray[np.float64]], events: NDArray[np.str_]
) -> NDArray[np.float64]:
    """Held-out log-densities, shape (motions, F, X); motions without an ellipse are left out as NaN."""
    finite = np.isfinite(values).all(axis=-1)
    score = np.full(finite.shape, np.nan)
    for held_out in leave_one_event_out(events):
        learned = finite & ~held_out[:, None, None]
        residual = np.empty_like(values)
        for k, design in enumerate(designs):
            fitted = np.linalg.lstsq(design[learned], values[..., k][learned], rcond=None)[0]
            residual[..., k] = values[..., k] - design @ fitted
        covariance = np.cov(residual[learned].T, bias=True)
        judged = finite & held_out[:, None, None]
        score[judged] = scipy.stats.multivariate_normal([0.0, 0.0], covariance).logpdf(residual[judged])
    return score


def _correlate_terms(values: NDArray[np.float64], term: NDArray[np.float64]) -> NDArray[np.float64]:
    """Squared correlation over motions at each structure, shape (F, X, 2)."""
    finite = np.isfinite(values)
    deviations = [
        np.where(finite, array - np.nanmean(np.where(finite, array, np.nan), axis=0), 0.0)
        for array in (values, term)
    ]
    product, own_power, term_power = (
        (first * two).sum(axis=0) for first, two in (deviations, (deviations[0],) * 2, (deviations[1],) * 2)
    )
    return np.asarray(product**2 / (own_power * term_power))


def _error(difference: NDArray[np.float64], events: NDArray[np.str_]) -> float:
    """Find the standard error of the mean over earthquakes."""
    deviation = np.nan_to_num(difference - np.nanmean(difference))
    sums = np.array([deviation[event].sum() for event in leave_one_event_out(events)])
    return float(np.sqrt((sums**2).sum()) / np.isfinite(difference).sum())
