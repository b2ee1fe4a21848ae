"""Weibull distribution."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq
from scipy.special import logsumexp, softmax
from scipy.stats import weibull_min

from reliab.criterion.distributions.distribution import Distribution

_REACH = 1e3


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
        logarithms = np.log(values)

        def score(shape: float) -> float:
            # Derivative of the likelihood along its ridge: Σ xᵏ ln x / Σ xᵏ − 1/k − mean ln x.
            return float(softmax(shape * logarithms) @ logarithms - 1.0 / shape - logarithms.mean())

        # The logarithm of a Weibull variable has the standard deviation π/(√6 shape).
        guess = np.pi / np.sqrt(6.0) / logarithms.std()
        shape = brentq(score, guess / _REACH, guess * _REACH)
        log_scale = (logsumexp(shape * logarithms) - np.log(values.size)) / shape
        return cls(shape=float(shape), scale=float(np.exp(log_scale)))

    def log_density(self, values: ArrayLike) -> NDArray[np.float64]:
        """Natural logarithm of the density."""
        return np.asarray(weibull_min.logpdf(values, self.shape, scale=self.scale))

    def cumulative(self, values: ArrayLike) -> NDArray[np.float64]:
        """Probability of being at most each value."""
        return np.asarray(weibull_min.cdf(values, self.shape, scale=self.scale))

    def quantile(self, probability: ArrayLike) -> NDArray[np.float64]:
        """Value that is not exceeded with the given probability."""
        return np.asarray(weibull_min.ppf(probability, self.shape, scale=self.scale))
