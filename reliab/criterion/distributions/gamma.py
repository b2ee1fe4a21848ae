"""Gamma distribution."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.stats import gamma

from reliab.criterion.distributions.distribution import Distribution


@dataclass(frozen=True, kw_only=True)
class Gamma(Distribution):
    """Gamma distribution of the quantity itself, from zero.

    Parameters
    ----------
    shape, scale : float
        Shape [-] and scale (in the quantity's unit).

    Examples
    --------
    >>> round(float(Gamma(shape=1.0, scale=2.0).quantile(0.5)), 4)  # exponential: 2 ln 2
    1.3863
    """

    name: ClassVar[str] = "gamma"

    shape: float
    scale: float

    @classmethod
    def _of_maximum_likelihood(cls, values: NDArray[np.float64]) -> Self:
        unit = float(values.mean())
        shape, _, scale = gamma.fit(values / unit, floc=0.0)
        return cls(shape=float(shape), scale=float(scale) * unit)

    def log_density(self, values: ArrayLike) -> NDArray[np.float64]:
        """Natural logarithm of the density."""
        return np.asarray(gamma.logpdf(values, self.shape, scale=self.scale))

    def cumulative(self, values: ArrayLike) -> NDArray[np.float64]:
        """Probability of being at most each value."""
        return np.asarray(gamma.cdf(values, self.shape, scale=self.scale))

    def quantile(self, probability: ArrayLike) -> NDArray[np.float64]:
        """Value that is not exceeded with the given probability."""
        return np.asarray(gamma.ppf(probability, self.shape, scale=self.scale))
