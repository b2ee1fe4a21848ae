"""A weighted sum of normal distributions of the logarithm: what the mixture and the empirical one share."""

from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from reliab.criterion.distributions.distribution import Distribution

_REACH = 40.0  # standard deviations from the outermost mean within which every quantile lies


@dataclass(frozen=True, kw_only=True, eq=False)
class NormalKernels(Distribution):
    """Weighted normal distributions of the logarithm."""

    # weights, means, spreads: Weight, mean and standard deviation of the logarithm of each, shape (k,)
    weights: NDArray[np.float64]
    means: NDArray[np.float64]
    spreads: NDArray[np.float64]

    def log_density(self, values: ArrayLike) -> NDArray[np.float64]:
        """Natural logarithm of the density."""
        logarithms = np.log(values)
        return log_mixture(logarithms, self.weights, self.means, self.spreads) - logarithms

    def cumulative(self, values: ArrayLike) -> NDArray[np.float64]:
        """Probability of being at most each value."""
        return self._cumulative_of_logarithm(np.log(values))

    def quantile(self, probability: ArrayLike) -> NDArray[np.float64]:
        """Value that is not exceeded with the given probability."""
        from scipy.optimize import elementwise

        wanted = np.asarray(probability, dtype=np.float64)
        low = np.full_like(wanted, (self.means - _REACH * self.spreads).min())
        high = np.full_like(wanted, (self.means + _REACH * self.spreads).max())
        root = elementwise.find_root(
            lambda x, p: self._cumulative_of_logarithm(x) - p, (low, high), args=(wanted,)
        )
        return np.asarray(np.exp(root.x))

    def _cumulative_of_logarithm(self, logarithms: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(
            scipy.stats.norm.cdf(logarithms[..., None], self.means, self.spreads) @ self.weights
        )


def log_mixture(
    logarithms: NDArray[np.float64],
    weights: NDArray[np.float64],
    means: NDArray[np.float64],
    spreads: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Logarithm of a mixture's density of the logarithm, shape of `logarithms`."""
    by_kernel = scipy.stats.norm.logpdf(logarithms[..., None], means, spreads)
    return np.asarray(scipy.special.logsumexp(by_kernel, b=weights, axis=-1))
