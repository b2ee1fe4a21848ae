"""Skew-normal distribution of the logarithm: one tail lighter than the other (Azzalini 1985)."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.criterion.distributions.distribution import maximise_likelihood
from reliab.criterion.distributions.scipy_family import OfLogarithm

_STEEPEST = 20.0  # beyond, the distribution is a half-normal to within a sample's resolution


@dataclass(frozen=True, kw_only=True)
class LogSkewNormal(OfLogarithm):
    """Skew-normal distribution of the logarithm, density 2/ω φ(z) Φ(αz), z = (ln x − ξ)/ω.

    Azzalini, A. (1985). A class of distributions which includes the normal ones. *Scandinavian
    Journal of Statistics* 12(2), 171-178.

    >>> fitted = LogSkewNormal(location=0.0, scale=1.0, shape=0.0)
    >>> round(float(fitted.quantile(0.05)), 4)  # the lognormal's
    0.193
    """

    name: ClassVar[str] = "skew_normal"
    family_name: ClassVar[str] = "skewnorm"

    location: float  # location, scale: ξ and ω of the logarithm
    scale: float
    shape: float  # α, between −20 and 20; 0 is the lognormal, a positive one has the longer tail above

    @classmethod
    def _of_maximum_likelihood(cls, values: NDArray[np.float64]) -> Self:
        logarithms = np.log(values)
        mean, spread = logarithms.mean(), logarithms.std()
        standardised = (logarithms - mean) / spread

        def log_likelihood(parameters: NDArray[np.float64]) -> float:
            location, log_scale, shape = parameters
            return float(scipy.stats.skewnorm.logpdf(standardised, shape, location, np.exp(log_scale)).sum())

        # α = 0 is a stationary point of the likelihood, so the search starts on the side of the skewness.
        lean = 1.0 if scipy.stats.skew(standardised) >= 0.0 else -1.0
        location, log_scale, shape = maximise_likelihood(
            log_likelihood, (-lean, 0.4, 2.0 * lean), ((-4.0, 4.0), (-4.0, 2.0), (-_STEEPEST, _STEEPEST))
        )
        return cls(
            location=float(mean + spread * location),
            scale=float(spread * np.exp(log_scale)),
            shape=float(shape),
        )

    @property
    def parameters(self) -> tuple[float, ...]:
        """Parameters in scipy's order."""
        return self.shape, self.location, self.scale
