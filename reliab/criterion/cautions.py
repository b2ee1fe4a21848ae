"""What a user should know before relying on a criterion: how well distributions fit, and how far it holds."""

from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import ArrayLike

from reliab.core.arrays import Array
from reliab.core.significant_digits import percent, significant
from reliab.core.vocabulary import CurveName, Metric, Side
from reliab.criterion.distributions import Distribution
from reliab.criterion.ellipse_table import EllipseTable, names_along
from reliab.criterion.methods.method import Method
from reliab.criterion.population import SampleGrid

SIGNIFICANCE = 0.05
"""Lognormality is rejected below this p-value."""


def objection(values: ArrayLike, parameter: str) -> str:
    """Say that a lognormal distribution does not fit; return nothing where it does.

    Returns A sentence, or nothing where the test of Shapiro and Wilk does not reject at 5 %.

    >>> objection(np.exp(np.random.default_rng(1).normal(size=80)), "a")
    ''
    """
    p_value = float(scipy.stats.shapiro(np.log(values)).pvalue)
    if p_value >= SIGNIFICANCE:
        return ""
    return (
        f"{parameter} is not lognormal over these motions (Shapiro-Wilk p = {significant(p_value, 2)}), "
        "so that a "
        "lognormal quantile does not keep the stated confidence; the methods dirichlet and "
        "order_statistic do not need it."
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class QuantilePlot:
    """Points of a Q-Q plot with a band for each order statistic."""

    expected: Array  # Quantiles of the distribution at the plotting positions (i − 1/2)/n
    observed: Array  # The motions in increasing order
    low: Array  # low, high: Where 95 % of each order statistic would lie if the distribution were true
    high: Array


def quantile_plot(values: ArrayLike, distribution: Distribution) -> QuantilePlot:
    """Compare motions with a distribution, quantile by quantile.

    `values`: positive values, shape (motions,).

    >>> from reliab.criterion.distributions import Lognormal
    >>> points = quantile_plot([1.0, 4.0, 2.0], Lognormal(mu=0.7, sigma=0.6))
    >>> points.observed.tolist(), float(points.expected[1].round(2))
    ([1.0, 2.0, 4.0], 2.01)
    """
    sorted_values = np.sort(np.asarray(values, dtype=np.float64))
    rank = np.arange(1, sorted_values.size + 1)
    low, high = (scipy.stats.beta.ppf(share, rank, sorted_values.size + 1 - rank) for share in (0.025, 0.975))
    return QuantilePlot(
        expected=distribution.quantile((rank - 0.5) / sorted_values.size),
        observed=sorted_values,
        low=distribution.quantile(low),
        high=distribution.quantile(high),
    )


_FEW_EVENTS = 30
_SHARED_BY = 2  # fewest motions that can be of one earthquake
_SHORTFALL = 0.005  # of a plug-in quantile, from which it is worth a sentence


def cautions_of(
    ellipses: EllipseTable, grid: SampleGrid, method: Method, confidence: float, empty: int
) -> tuple[str, ...]:
    """Say what limits the criterion of a grid of structures."""
    sentences = (
        _promise_caution(grid, method, confidence, empty),
        str(ellipses.attrs.get("caution", "")),
        str(ellipses.attrs.get("copies", "")),
        _too_small(ellipses, confidence),
        _curve_fit_caution(grid, method),
        _omission_caution(grid, method),
        _lengths_together(ellipses, grid),
        few_events(grid.fewest_events),
        _unknown_event_caution(ellipses),
        "" if empty else _extrapolation_caution(grid, method, confidence),
        "" if empty else _shortfall(grid, method, confidence),
        *not_lognormal(grid, method),
    )
    return tuple(sentence for sentence in sentences if sentence)


def few_leads(ellipses: EllipseTable, *, leads: bool) -> tuple[str, ...]:
    """Say why a criterion has no limits for leads; nothing where it has."""
    if leads:
        return ()
    if Side.LEAD not in names_along(ellipses, "side"):
        return ("These ellipses are of lags alone: the criterion has no limits for an actuator that leads.",)
    return (
        "Too few motions have a boundary for leads: the criterion has no limits for an actuator that leads.",
    )


def _promise_caution(grid: SampleGrid, method: Method, confidence: float, empty: int) -> str:
    if not empty:
        return ""
    motions, events = grid.fewest_motions, grid.fewest_events
    highest = method.achievable_confidence(motions, events)
    return (
        f"Too few motions or earthquakes for {method.name} at {confidence:g}: {motions} motions of "
        f"{_earthquakes(events)} support {significant(highest)} at most, so that the limits are zero and no "
        f"test is accepted."
    )


def _too_small(ellipses: EllipseTable, confidence: float) -> str:
    least = float(ellipses.attrs.get("promised_from", 0.0))
    if confidence >= least:
        return ""
    return (
        f"No share below {percent(least)} is promised by a response: limits at 50 % have 7 to 17 % more area "
        "than at 95 %, and populations of ground motions differ by too much of that."
    )


def _lengths_together(ellipses: EllipseTable, grid: SampleGrid) -> str:
    lengths = ellipses.motion_values.get("duration", np.empty(0))
    has_recorded_lengths = "carried_to" not in ellipses.attrs and ellipses.attrs.get("window") == "record"
    if (
        not has_recorded_lengths
        or grid.metric != Metric.RMS
        or grid.curve != CurveName.INSCRIBED
        or lengths.size == 0
    ):
        return ""
    return (
        f"These limits are of records of {lengths.min():.0f} to {lengths.max():.0f} s together, and limits "
        "grow with the length: under short records fewer tests keep the error than stated, under long ones "
        "more. Derive the criterion from real_suite, or from thirty `motions` of ten earthquakes, to protect "
        "each length."
    )


def _curve_fit_caution(grid: SampleGrid, method: Method) -> str:
    if grid.curve == method.curve:
        return ""
    return (
        "These are ellipses fitted to the boundaries, not inscribed in them: a test inside may exceed the "
        "error where the boundary runs inside its ellipse."
    )


def _extrapolation_caution(grid: SampleGrid, method: Method, confidence: float) -> str:
    events = grid.fewest_events
    if confidence <= events / (events + 1.0) + 1e-9 or method.distribution_free:
        return ""
    return (
        f"{_earthquakes(events).capitalize()} support {significant(events / (events + 1.0))}; the limits "
        f"at {confidence:g} extrapolate a fitted distribution."
    )


def _shortfall(grid: SampleGrid, method: Method, confidence: float) -> str:
    share = method.mean_share(confidence, grid.fewest_motions)
    if confidence - share < _SHORTFALL:
        return ""
    return (
        f"The quantile of a distribution fitted to {grid.fewest_motions} motions is exceeded by "
        f"{significant(share)} of further ones on average, not by {confidence:g}; dirichlet and "
        "predictive allow for it."
    )


def _earthquakes(events: int) -> str:
    return "one earthquake" if events == 1 else f"{events} earthquakes"


def _omission_caution(grid: SampleGrid, method: Method) -> str:
    fewest = grid.fewest_motions
    if fewest == grid.n_motions or method.samples_chains:  # a hierarchical model draws what motions lack
        return ""
    consequence = (
        "which narrows the fitted distribution, so that its lower quantile may lie a little too high; "
        "dirichlet and order_statistic stay on the safe side"
        if method.assumes_lognormality
        else "so that this is on the safe side"
    )
    return (
        f"Up to {grid.n_motions - fewest} of {grid.n_motions} motions have no ellipse at some structure "
        "and were left out there: their boundaries reach beyond five damping ratios of amplitude error, "
        f"{consequence}."
    )


def few_events(fewest: int) -> str:
    """Say that there are few earthquakes; nothing from thirty on.

    >>> few_events(1)
    'The motions come from only one earthquake, and motions of one earthquake are alike.'
    """
    if fewest >= _FEW_EVENTS:
        return ""
    return f"The motions come from only {_earthquakes(fewest)}, and motions of one earthquake are alike."


def _unknown_event_caution(ellipses: EllipseTable) -> str:
    unnamed = int((ellipses.coordinates["motion"].astype(np.str_) == ellipses.events.astype(np.str_)).sum())
    if unnamed < _SHARED_BY:
        return ""
    return (
        f"No earthquake is stated for {unnamed} of {ellipses.n_motions} motions: each counts as one "
        "of its own, which promises too much where some are of one earthquake; state them in a column event."
    )


def not_lognormal(grid: SampleGrid, method: Method) -> list[str]:
    """Say where motions are not lognormal, if the promise of a method needs them to be."""
    cells = grid.cells
    if not method.assumes_lognormality:
        return []
    objections = [(objection(sample.a, "a"), objection(sample.b, "b")) for sample in cells]
    rejections = sum(any(pair) for pair in objections)
    if not rejections:
        return []
    sentence = (
        f"a or b is not lognormal over these motions at {rejections} of {len(cells)} structures, so that a "
        "lognormal quantile does not keep the stated confidence there; the methods dirichlet "
        "and order_statistic do not need it."
    )
    sentences = [text for text in objections[0] if text] if len(cells) == 1 else [sentence]
    if method.settings.get("assurance") is not None:
        sentences.append("No assurance is stated: it would need lognormal motions.")
    return sentences
