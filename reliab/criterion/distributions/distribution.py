"""What every distribution of an ellipse parameter over ground motions can do."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import ClassVar, Self

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from reliab.errors import InputError

FEWEST_VALUES = 3
"""A distribution is fitted to no fewer values."""


class Distribution(ABC):
    """Distribution of a positive quantity, fitted by maximum likelihood."""

    name: ClassVar[str]  # How the distribution is called on the command line and in tables

    @classmethod
    def fit(cls, values: ArrayLike) -> Self:
        """Fit the distribution."""
        sample = np.asarray(values, dtype=np.float64)
        if sample.size < FEWEST_VALUES:
            raise InputError(
                f"A distribution is fitted to at least {FEWEST_VALUES} values",
                value=sample.size,
                remedy="Give more ground motions",
            )
        wrong = ~(np.isfinite(sample) & (sample > 0.0))
        if wrong.any():
            raise InputError("Values of a distribution must be positive and finite", value=sample[wrong][0])
        if (sample == sample[0]).all():
            raise InputError(
                "Values of a distribution must differ",
                value=f"{sample.size} times {sample[0]:g}",
                remedy="Give different ground motions",
            )
        return cls._of_maximum_likelihood(sample)

    @classmethod
    @abstractmethod
    def _of_maximum_likelihood(cls, values: NDArray[np.float64]) -> Self:
        """Fit to checked values, shape (n,)."""

    @abstractmethod
    def log_density(self, values: ArrayLike) -> NDArray[np.float64]:
        """Natural logarithm of the density of the quantity itself (not of its logarithm)."""

    @abstractmethod
    def cumulative(self, values: ArrayLike) -> NDArray[np.float64]:
        """Probability of being at most each value."""

    @abstractmethod
    def quantile(self, probability: ArrayLike) -> NDArray[np.float64]:
        """Value that is not exceeded with the given probability, in (0, 1)."""


def maximise_likelihood(
    log_likelihood: Callable[[NDArray[np.float64]], float],
    start: Sequence[float],
    bounds: Sequence[tuple[float, float]],
) -> NDArray[np.float64]:
    """Find the parameters of greatest log-likelihood within bounds."""
    optimum = scipy.optimize.minimize(
        lambda p: -log_likelihood(p), np.asarray(start), bounds=bounds, method="L-BFGS-B"
    )
    return np.asarray(optimum.x, dtype=np.float64)
