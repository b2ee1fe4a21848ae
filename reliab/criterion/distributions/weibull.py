"""Weibull distribution."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.stats import weibull_min

from reliab.criterion.distributions.distribution import Distribution, maximise_likelihood


@dataclass(frozen=True, kw_only=True)
class Weibull(Distribution):
    """Weibull distribution of the quantity itself, from zero.

    Parameters
    ----------
    shape, scale : float
        Shape [-] and scale (in the quantity's unit).

    Examples
    --------
    >>> round(float(Weibull(shape=1.0, scale=2.0).quantile(0.5)), 4)  # exponential: 2 ln 2
    1.3863
    """

    name: ClassVar[str] = "weibull"

    shape: float
    scale: float

    @classmethod
    def _of_maximum_likelihood(cls, values: NDArray[np.float64]) -> Self:
        unit = float(np.exp(np.log(values).mean()))
        relative = values / unit

        def log_likelihood(parameters: NDArray[np.float64]) -> float:
            return float(
                weibull_min.logpdf(relative, np.exp(parameters[0]), scale=np.exp(parameters[1])).sum()
            )

        # The logarithm of a Weibull variable has the standard deviation π/(√6 shape).
        start = np.log(np.pi / np.sqrt(6.0) / np.log(values).std())
        log_shape, log_scale = maximise_likelihood(log_likelihood, (start, 0.2), ((-3.0, 5.0), (-3.0, 5.0)))
        return cls(shape=float(np.exp(log_shape)), scale=float(np.exp(log_scale)) * unit)

    def log_density(self, values: ArrayLike) -> NDArray[np.float64]:
        """Natural logarithm of the density."""
        return np.asarray(weibull_min.logpdf(values, self.shape, scale=self.scale))

    def cumulative(self, values: ArrayLike) -> NDArray[np.float64]:
        """Probability of being at most each value."""
        return np.asarray(weibull_min.cdf(values, self.shape, scale=self.scale))

    def quantile(self, probability: ArrayLike) -> NDArray[np.float64]:
        """Value that is not exceeded with the given probability."""
        return np.asarray(weibull_min.ppf(probability, self.shape, scale=self.scale))
