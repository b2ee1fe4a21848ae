"""Errors of many draws, their intervals and their probabilities."""

from dataclasses import dataclass
from typing import Final

import numpy as np
import scipy

from reliab.assessment.rebuilt_error.noise import LOST_IN_NOISE
from reliab.core.arrays import Array
from reliab.core.plain_values import finite
from reliab.core.significant_digits import percent
from reliab.core.vocabulary import Metric

LEVEL = 0.90
"""Level of the intervals."""

ENDS = 0.5 - 0.5 * LEVEL, 0.5 + 0.5 * LEVEL
"""Shares of the draws below the ends of an interval."""

HALF_WIDTH = float(scipy.special.ndtri(ENDS[1]))
"""Half width of a 90 % interval in standard deviations."""


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """A value with its 90 % interval."""

    value: float  # value, low, high: Relative errors [-]
    low: float
    high: float

    def to_dict(self) -> dict[str, float | None]:
        """Put it into plain values."""
        return {name: finite(value) for name, value in vars(self).items()}


UNKNOWN: Final = Estimate(value=np.nan, low=np.nan, high=np.nan)
"""An error that is not known."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ErrorDraws:
    """Errors of many draws."""

    rms: Array  # rms, mte: RMS^R and MTE^R [-], shape (draws,)
    mte: Array
    weights: Array  # Of the draws, their mean is one, shape (draws,)
    values: tuple[float, float] | None = None  # RMS^R and MTE^R that are stated; the medians by default

    def errors(self, metric: Metric) -> Array:
        """RMS^R or MTE^R of the draws [-], shape (draws,)."""
        return self.rms if Metric(metric) is Metric.RMS else self.mte

    def estimate(self, metric: Metric) -> Estimate:
        """Return RMS^R or MTE^R with its 90 % interval, which holds the value."""
        median, low, high = weighted_quantiles(self.errors(metric), self.weights, 0.5, *ENDS)
        if self.values is None:
            return Estimate(value=median, low=low, high=high)
        value = self.values[Metric(metric) is not Metric.RMS]
        return Estimate(value=value, low=min(low, value), high=max(high, value))

    def probability_below(self, threshold: float, metric: Metric) -> float:
        """Probability of an error below a threshold, no nearer to 0 and 1 than half of a mean draw."""
        weights = self.weights
        return (float(weights[self.errors(metric) < threshold].sum()) + 0.5) / (weights.size + 1.0)


def weighted_quantiles(values: Array, weights: Array, *shares: float) -> tuple[float, ...]:
    """Return quantiles of draws, each with its weight."""
    order = np.argsort(values)
    ordered_weights = weights[order]
    places = (np.cumsum(ordered_weights) - 0.5 * ordered_weights) / ordered_weights.sum()
    return tuple(np.interp(shares, places, values[order]).tolist())


@dataclass(frozen=True, kw_only=True, eq=False)
class DisplacementError:
    """The rebuilt error of an interface displacement with its uncertainty."""

    error: Array  # x_m − x_I [m] sample by sample as the sensor reads x_m, its offset taken away, shape (n,)
    smooth_error: Array  # The same without the sensor's noise above the band of the motion [m], shape (n,)
    reference: Array  # x_I [m], what the undisturbed structure would have done, shape (n,)
    deviation: Array  # Standard deviation of both over the draws [m], shape (n,)
    draws: ErrorDraws  # RMS^R and MTE^R of the draws behind the intervals
    name: str = ""
    noise: float = 0.0  # Standard deviation of x_c − x_m that noise leaves open, over the peak of x_I [-]

    @property
    def judged(self) -> bool:
        """Whether the displacement moves enough for its noise."""
        return bool(self.noise < LOST_IN_NOISE)

    @property
    def refusal_reason(self) -> str:
        """Say why the displacement is not judged."""
        if np.isinf(self.noise):
            return f"{self.name} does not move, and its error is not judged."
        return (
            f"{self.name} moves too little for the noise of its sensors, which leaves "
            f"{percent(self.noise)} of its largest displacement open: its error is not judged."
        )

    @property
    def rms(self) -> Estimate:
        """RMS^R with its 90 % interval."""
        return self.draws.estimate(Metric.RMS)

    @property
    def mte(self) -> Estimate:
        """MTE^R with its 90 % interval."""
        return self.draws.estimate(Metric.MTE)

    @property
    def low(self) -> Array:
        """Lower end of the 90 % band of x_m − x_I at each sample [m], shape (n,)."""
        return self.smooth_error - HALF_WIDTH * self.deviation

    @property
    def high(self) -> Array:
        """Upper end of the 90 % band of x_m − x_I at each sample [m], shape (n,)."""
        return self.smooth_error + HALF_WIDTH * self.deviation

    def estimate(self, metric: Metric) -> Estimate:
        """RMS^R or MTE^R with its interval."""
        return self.draws.estimate(metric)

    def errors(self, metric: Metric) -> Array:
        """RMS^R or MTE^R of the draws [-], shape (draws,)."""
        return self.draws.errors(metric)

    def probability(self, threshold: float, metric: Metric = Metric.RMS) -> float:
        """Probability that the error is below a threshold.

        `threshold` [-].
        """
        return self.draws.probability_below(threshold, metric)
