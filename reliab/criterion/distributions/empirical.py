"""The ground motions themselves, smoothed just enough to have a density."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.criterion.distributions.normal_kernels import NormalKernels

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
