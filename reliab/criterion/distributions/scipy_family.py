"""Distributions whose functions are those of a family of scipy, of the quantity or of its logarithm."""

from abc import abstractmethod
from typing import Any, ClassVar

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from reliab.criterion.distributions.distribution import Distribution


class OfQuantity(Distribution):
    """A family of scipy for the quantity itself."""

    family_name: ClassVar[str]  # Name of the family in `scipy.stats`

    @property
    def family(self) -> Any:  # noqa: ANN401 - scipy has no types
        """The family, a `scipy.stats.rv_continuous`."""
        return getattr(scipy.stats, self.family_name)

    @property
    @abstractmethod
    def parameters(self) -> tuple[float, ...]:
        """Parameters in scipy's order: shapes, location, scale."""

    def log_density(self, values: ArrayLike) -> NDArray[np.float64]:
        """Natural logarithm of the density."""
        return np.asarray(self.family.logpdf(values, *self.parameters))

    def cumulative(self, values: ArrayLike) -> NDArray[np.float64]:
        """Probability of being at most each value."""
        return np.asarray(self.family.cdf(values, *self.parameters))

    def quantile(self, probability: ArrayLike) -> NDArray[np.float64]:
        """Value that is not exceeded with the given probability."""
        return np.asarray(self.family.ppf(probability, *self.parameters))


class OfLogarithm(OfQuantity):
    """A family of scipy for the natural logarithm of the quantity."""

    def log_density(self, values: ArrayLike) -> NDArray[np.float64]:
        """Natural logarithm of the density of the quantity itself."""
        logarithms = np.log(values)
        return super().log_density(logarithms) - logarithms

    def cumulative(self, values: ArrayLike) -> NDArray[np.float64]:
        """Probability of being at most each value."""
        return super().cumulative(np.log(values))

    def quantile(self, probability: ArrayLike) -> NDArray[np.float64]:
        """Value that is not exceeded with the given probability."""
        return np.exp(super().quantile(probability))
