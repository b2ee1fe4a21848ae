"""The one rule by which a and b hold together."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, kw_only=True, eq=False)
class Scatter:
    """Mean and spread of ln a and ln b over motions, in which the worse of the two is found.

    The smaller of the two standardised logarithms represents the motion. A lower bound of it, carried back to
    a and b, holds for both together, and both lie equally deep in their own distributions.

    >>> pairs = np.array([[0.0, 0.0], [1.0, 4.0], [2.0, 2.0]])
    >>> scatter = Scatter.from_logarithms(pairs)
    >>> scatter.worse(pairs).round(3).tolist()
    [-1.225, 0.0, 0.0]
    >>> scatter.at(np.array(-1.0)).round(3).tolist()
    [0.184, 0.367]
    """

    # centre, spread: Mean and standard deviation over the motions, shape (..., 2)
    centre: NDArray[np.float64]
    spread: NDArray[np.float64]

    @classmethod
    def from_logarithms(cls, logarithms: NDArray[np.float64]) -> Self:
        """Take mean and spread of ln a and ln b over motions, shape (motions, ..., 2)."""
        return cls(centre=logarithms.mean(axis=0), spread=logarithms.std(axis=0))

    def standard(self, logarithms: NDArray[np.float64]) -> NDArray[np.float64]:
        """Standardise ln a and ln b, shape (motions, ..., 2)."""
        return np.asarray((logarithms - self.centre) / self.spread)

    def worse(self, logarithms: NDArray[np.float64]) -> NDArray[np.float64]:
        """Take the smaller of the two standardised logarithms, shape (motions, ...)."""
        return np.asarray(self.standard(logarithms).min(axis=-1))

    def at(self, depth: NDArray[np.float64]) -> NDArray[np.float64]:
        """Carry a depth of both, shape (...), back to ln a and ln b, shape (..., 2)."""
        return np.asarray(self.centre + self.spread * depth[..., None])
