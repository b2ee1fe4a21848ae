"""Lognormal distribution, the paper's choice for a and b."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from reliab.criterion.distributions.scipy_family import OfLogarithm


@dataclass(frozen=True, kw_only=True)
class Lognormal(OfLogarithm):
    """Normal distribution of the logarithm.

    >>> fitted = Lognormal.fit([1.0, 2.0, 4.0])
    >>> round(fitted.mu, 4), round(fitted.sigma, 4), round(float(fitted.quantile(0.05)), 4)
    (0.6931, 0.566, 0.7884)
    """

    name: ClassVar[str] = "lognormal"
    family_name: ClassVar[str] = "norm"

    # mu, sigma: Mean and standard deviation of the logarithm; the fit divides by n, as maximum likelihood
    # does
    mu: float
    sigma: float

    @classmethod
    def _of_maximum_likelihood(cls, values: NDArray[np.float64]) -> Self:
        logarithms = np.log(values)
        return cls(mu=float(logarithms.mean()), sigma=float(logarithms.std()))

    @property
    def parameters(self) -> tuple[float, ...]:
        """Parameters in scipy's order."""
        return self.mu, self.sigma
