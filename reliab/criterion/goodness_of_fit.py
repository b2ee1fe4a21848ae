"""Whether a lognormal distribution fits: tests, a plain sentence, the points of a Q-Q plot."""

from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import ArrayLike

from reliab.core.arrays import Array
from reliab.core.significant_digits import significant
from reliab.criterion.distributions import Distribution

SIGNIFICANCE = 0.05
"""Lognormality is rejected below this p-value."""

_SIMULATIONS = 1999
_SEED = 2017


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


def lognormality(values: ArrayLike) -> dict[str, float]:
    """Test whether values over motions are lognormal.

    `values`: positive values, shape (motions,), at least three. Returns p-values of the Kolmogorov-Smirnov,
    Anderson-Darling and Shapiro-Wilk tests. Those of the first two are simulated, since mean and spread are
    fitted to the same motions; all three count the motions as independent.

    >>> round(lognormality(np.random.default_rng(1).pareto(2.0, size=80) + 1.0)["anderson_darling"], 3)
    0.001
    """
    logarithms = np.log(values)
    simulated = {
        test: float(
            scipy.stats.goodness_of_fit(
                scipy.stats.norm,
                logarithms,
                statistic=name,
                n_mc_samples=_SIMULATIONS,
                rng=np.random.default_rng(_SEED),
            ).pvalue
        )
        for test, name in (("kolmogorov_smirnov", "ks"), ("anderson_darling", "ad"))
    }
    return {**simulated, "shapiro_wilk": float(scipy.stats.shapiro(logarithms).pvalue)}


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
