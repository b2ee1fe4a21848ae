"""Mixture of two normal distributions of the logarithm."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.criterion.distributions.normal_kernels import NormalKernels, log_mixture

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
