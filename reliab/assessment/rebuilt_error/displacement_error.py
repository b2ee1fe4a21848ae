"""The error of one measured interface displacement, of a test with any number of them."""

from dataclasses import dataclass

from reliab.arrays import Array
from reliab.assessment.rebuilt_error.spread import HALF_WIDTH, Estimate, Spread
from reliab.vocabulary import Metric


@dataclass(frozen=True, kw_only=True, eq=False)
class DisplacementError:
    """The rebuilt error of an interface displacement with its uncertainty."""

    error: Array  # x_m − x_I [m] sample by sample as the sensor reads x_m, its offset taken away, shape (n,)
    smooth_error: Array  # The same without the sensor's noise above the band of the motion [m], shape (n,)
    reference: Array  # x_I [m], what the undisturbed structure would have done, shape (n,)
    rms: Estimate  # rms, mte: RMS^R and MTE^R [-] with their 90 % intervals
    mte: Estimate
    draws: Spread  # RMS^R and MTE^R of the draws behind the intervals

    @property
    def low(self) -> Array:
        """Lower end of the 90 % band of x_m − x_I at each sample [m], shape (n,)."""
        return self.draws.mean - HALF_WIDTH * self.draws.deviation

    @property
    def high(self) -> Array:
        """Upper end of the 90 % band of x_m − x_I at each sample [m], shape (n,)."""
        return self.draws.mean + HALF_WIDTH * self.draws.deviation

    def estimate(self, metric: Metric) -> Estimate:
        """RMS^R or MTE^R with its interval."""
        return self.rms if Metric(metric) is Metric.RMS else self.mte

    def errors(self, metric: Metric) -> Array:
        """RMS^R or MTE^R of the draws [-], shape (draws,)."""
        return self.draws.errors(metric)

    def probability(self, threshold: float, metric: Metric = Metric.RMS) -> float:
        """Probability that the error is below a threshold.

        `threshold` [-].
        """
        return self.draws.probability_below(threshold, metric)
