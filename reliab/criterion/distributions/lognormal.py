"""Lognormal distribution, the paper's choice for a and b."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.stats import norm

from reliab.criterion.distributions.distribution import Distribution


@dataclass(frozen=True, kw_only=True)
class Lognormal(Distribution):
    """Normal distribution of the logarithm.

    Parameters
    ----------
    mu, sigma : float
        Mean and standard deviation of the logarithm; the fit divides by n, as maximum likelihood does.

    Examples
    --------
    >>> fitted = Lognormal.fit([1.0, 2.0, 4.0])
    >>> round(fitted.mu, 4), round(fitted.sigma, 4), round(float(fitted.quantile(0.05)), 4)
    (0.6931, 0.566, 0.7884)
    """

    name: ClassVar[str] = "lognormal"

    mu: float
    sigma: float

    @classmethod
    def _of_maximum_likelihood(cls, values: NDArray[np.float64]) -> Self:
        logarithms = np.log(values)
        return cls(mu=float(logarithms.mean()), sigma=float(logarithms.std()))

    def log_density(self, values: ArrayLike) -> NDArray[np.float64]:
        """Natural logarithm of the density."""
        logarithms = np.log(values)
        return np.asarray(norm.logpdf(logarithms, self.mu, self.sigma) - logarithms)

    def cumulative(self, values: ArrayLike) -> NDArray[np.float64]:
        """Probability of being at most each value."""
        return np.asarray(norm.cdf(np.log(values), self.mu, self.sigma))

    def quantile(self, probability: ArrayLike) -> NDArray[np.float64]:
        """Value that is not exceeded with the given probability."""
        return np.asarray(np.exp(self.mu + self.sigma * norm.ppf(probability)))
