"""Weibull distribution."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.criterion.distributions.scipy_family import OfQuantity

_REACH = 1e3


@dataclass(frozen=True, kw_only=True)
class Weibull(OfQuantity):
    """Weibull distribution of the quantity itself, from zero.

    >>> round(float(Weibull(shape=1.0, scale=2.0).quantile(0.5)), 4)  # exponential: 2 ln 2
    1.3863
    """

    name: ClassVar[str] = "weibull"
    family_name: ClassVar[str] = "weibull_min"

    shape: float  # shape, scale: Shape [-] and scale (in the quantity's unit)
    scale: float

    @classmethod
    def _of_maximum_likelihood(cls, values: NDArray[np.float64]) -> Self:
        logarithms = np.log(values)

        def score(shape: float) -> float:
            # Derivative of the likelihood along its ridge: Σ xᵏ ln x / Σ xᵏ − 1/k − mean ln x.
            return float(
                scipy.special.softmax(shape * logarithms) @ logarithms - 1.0 / shape - logarithms.mean()
            )

        # The logarithm of a Weibull variable has the standard deviation π/(√6 shape).
        guess = np.pi / np.sqrt(6.0) / logarithms.std()
        shape = scipy.optimize.brentq(score, guess / _REACH, guess * _REACH)
        log_scale = (scipy.special.logsumexp(shape * logarithms) - np.log(values.size)) / shape
        return cls(shape=float(shape), scale=float(np.exp(log_scale)))

    @property
    def parameters(self) -> tuple[float, ...]:
        """Parameters in scipy's order."""
        return self.shape, 0.0, self.scale
