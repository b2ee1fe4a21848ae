"""Weighted sums of normal distributions of the logarithm: a mixture of two, and the smoothed motions."""

from dataclasses import dataclass
from typing import ClassVar, Self

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


_NORMAL_QUARTILES = 1.349  # interquartile range of the standard normal distribution


@dataclass(frozen=True, kw_only=True, eq=False)
class Empirical(NormalKernels):
    """Kernel estimate of the logarithm's density with Silverman's bandwidth.

    Where half of the values or more are equal, the quartiles show no spread, and the standard deviation is
    used alone.

    Silverman, B. W. (1986). *Density estimation for statistics and data analysis*, equation (3.31).

    >>> fitted = Empirical.fit(np.exp(np.linspace(-1.0, 1.0, 101)))
    >>> round(float(fitted.quantile(0.5)), 4)
    1.0
    """

    name: ClassVar[str] = "empirical"

    @classmethod
    def _of_maximum_likelihood(cls, values: NDArray[np.float64]) -> Self:
        logarithms = np.log(values)
        quartiles = scipy.stats.iqr(logarithms) / _NORMAL_QUARTILES
        spread = min(logarithms.std(), quartiles) if quartiles > 0.0 else logarithms.std()
        bandwidth = 0.9 * spread * values.size**-0.2
        return cls(
            weights=np.full(values.size, 1.0 / values.size),
            means=logarithms,
            spreads=np.full(values.size, bandwidth),
        )


_ITERATIONS = 500
_TOLERANCE = 1e-6
_NARROWEST = 0.1  # share of the sample's spread; a component narrower than that would chase single values


@dataclass(frozen=True, kw_only=True, eq=False)
class LogGaussianMixture(NormalKernels):
    """Two normal distributions of the logarithm, fitted by expectation and maximisation.

    No component is narrower than a tenth of the sample's spread: the likelihood has no maximum otherwise.

    >>> two = np.exp(np.concatenate([np.linspace(-1.0, 1.0, 50), np.linspace(9.0, 11.0, 50)]))
    >>> np.sort(LogGaussianMixture.fit(two).means).round(2) + 0.0
    array([ 0., 10.])
    """

    name: ClassVar[str] = "gaussian_mixture"

    @classmethod
    def _of_maximum_likelihood(cls, values: NDArray[np.float64]) -> Self:
        logarithms = np.log(values)
        floor = _NARROWEST * logarithms.std()
        weights = np.array([0.5, 0.5])
        means, spreads = np.quantile(logarithms, [0.25, 0.75]), np.full(2, logarithms.std())
        before = -np.inf
        for _ in range(_ITERATIONS):
            density = log_mixture(logarithms, weights, means, spreads)
            if density.sum() - before < _TOLERANCE:
                break
            before = density.sum()
            by_component = np.log(weights) + scipy.stats.norm.logpdf(logarithms[:, None], means, spreads)
            share = np.exp(by_component - density[:, None])
            total = np.maximum(share.sum(axis=0), 1e-12)
            weights, means = total / total.sum(), (share * logarithms[:, None]).sum(axis=0) / total
            variance = (share * (logarithms[:, None] - means) ** 2).sum(axis=0) / total
            spreads = np.maximum(np.sqrt(variance), floor)
        return cls(weights=weights, means=means, spreads=spreads)
