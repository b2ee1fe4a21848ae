"""Gamma distribution."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.criterion.distributions.scipy_family import OfQuantity


@dataclass(frozen=True, kw_only=True)
class Gamma(OfQuantity):
    """Gamma distribution of the quantity itself, from zero.

    >>> round(float(Gamma(shape=1.0, scale=2.0).quantile(0.5)), 4)  # exponential: 2 ln 2
    1.3863
    """

    name: ClassVar[str] = "gamma"
    family_name: ClassVar[str] = "gamma"

    shape: float  # shape, scale: Shape [-] and scale (in the quantity's unit)
    scale: float

    @classmethod
    def _of_maximum_likelihood(cls, values: NDArray[np.float64]) -> Self:
        unit = float(values.mean())
        shape, _, scale = scipy.stats.gamma.fit(values / unit, floc=0.0)
        return cls(shape=float(shape), scale=float(scale) * unit)

    @property
    def parameters(self) -> tuple[float, ...]:
        """Parameters in scipy's order."""
        return self.shape, 0.0, self.scale
