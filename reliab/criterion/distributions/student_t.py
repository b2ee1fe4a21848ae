"""Student's t distribution of the logarithm: heavier tails than the lognormal."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.criterion.distributions.distribution import maximise_likelihood
from reliab.criterion.distributions.scipy_family import OfLogarithm

_DEGREES = (1.0, 500.0)  # Cauchy to all but normal


@dataclass(frozen=True, kw_only=True)
class LogStudentT(OfLogarithm):
    """Student's t distribution of the logarithm.

    >>> fitted = LogStudentT(mu=0.0, sigma=1.0, degrees_of_freedom=3.0)
    >>> round(float(fitted.quantile(0.05)), 4)
    0.095
    """

    name: ClassVar[str] = "student_t"
    family_name: ClassVar[str] = "t"

    mu: float  # mu, sigma: Location and scale of the logarithm
    sigma: float
    degrees_of_freedom: float  # From 1 (Cauchy) to 500 (all but normal)

    @classmethod
    def _of_maximum_likelihood(cls, values: NDArray[np.float64]) -> Self:
        logarithms = np.log(values)
        mean, spread = logarithms.mean(), logarithms.std()
        standardised = (logarithms - mean) / spread

        def log_likelihood(parameters: NDArray[np.float64]) -> float:
            location, log_scale, log_degrees = parameters
            return float(
                scipy.stats.t.logpdf(standardised, np.exp(log_degrees), location, np.exp(log_scale)).sum()
            )

        location, log_scale, log_degrees = maximise_likelihood(
            log_likelihood, (0.0, 0.0, np.log(10.0)), ((-3.0, 3.0), (-6.0, 2.0), tuple(np.log(_DEGREES)))
        )
        return cls(
            mu=float(mean + spread * location),
            sigma=float(spread * np.exp(log_scale)),
            degrees_of_freedom=float(np.exp(log_degrees)),
        )

    @property
    def parameters(self) -> tuple[float, ...]:
        """Parameters in scipy's order."""
        return self.degrees_of_freedom, self.mu, self.sigma
