"""Distributions of the logarithms of a and b over ground motions.

The paper takes the normal one, so that a and b are lognormal; skew-normal: Azzalini (1985).
"""

from abc import ABC, abstractmethod
from dataclasses import astuple, dataclass
from typing import Any, ClassVar, Self, cast

import numpy as np
import scipy
from numpy.typing import ArrayLike

from reliab.core.arrays import Array
from reliab.core.errors import InputError

FEWEST_VALUES = 3
"""A distribution is fitted to no fewer values."""


class Distribution(ABC):
    """Distribution of a positive quantity, fitted by maximum likelihood.

    Its fields are the parameters of a family of scipy for the natural logarithm, in scipy's order.
    """

    family_name: ClassVar[str]  # Name of the family in `scipy.stats`

    @classmethod
    def fit(cls, values: ArrayLike) -> Self:
        """Fit the distribution."""
        sample = np.asarray(values, dtype=np.float64)
        if sample.size < FEWEST_VALUES:
            raise InputError(
                f"Too few values: a distribution needs {FEWEST_VALUES}",
                value=sample.size,
                remedy="Give more ground motions",
            )
        wrong = ~(np.isfinite(sample) & (sample > 0.0))
        if wrong.any():
            raise InputError("Values of a distribution must be positive and finite", value=sample[wrong][0])
        if (sample == sample[0]).all():
            raise InputError(
                "All values are equal",
                value=f"{sample.size} times {sample[0]:g}",
                remedy="Give different ground motions",
            )
        return cls._maximise_likelihood(sample)

    @classmethod
    @abstractmethod
    def _maximise_likelihood(cls, values: Array) -> Self:
        """Fit to checked values, shape (n,)."""

    @property
    def _family(self) -> Any:  # noqa: ANN401 - scipy has no types
        return getattr(scipy.stats, self.family_name)

    @property
    def _parameters(self) -> tuple[float, ...]:
        return astuple(cast("Any", self))

    def log_density(self, values: ArrayLike) -> Array:
        """Natural logarithm of the density of the quantity itself (not of its logarithm)."""
        logarithms = np.log(values)
        return np.asarray(self._family.logpdf(logarithms, *self._parameters) - logarithms)

    def cumulative(self, values: ArrayLike) -> Array:
        """Probability of being at most each value."""
        return np.asarray(self._family.cdf(np.log(values), *self._parameters))

    def quantile(self, probability: ArrayLike) -> Array:
        """Value that is not exceeded with the given probability, in (0, 1)."""
        return np.asarray(np.exp(self._family.ppf(probability, *self._parameters)))


@dataclass(frozen=True, kw_only=True)
class Lognormal(Distribution):
    """Normal distribution of the logarithm.

    >>> fitted = Lognormal.fit([1.0, 2.0, 4.0])
    >>> round(fitted.mu, 4), round(fitted.sigma, 4), round(float(fitted.quantile(0.05)), 4)
    (0.6931, 0.566, 0.7884)
    """

    family_name: ClassVar[str] = "norm"

    # mu, sigma: Mean and standard deviation of the logarithm; the fit divides by n, as maximum likelihood
    # does
    mu: float
    sigma: float

    @classmethod
    def _maximise_likelihood(cls, values: Array) -> Self:
        logarithms = np.log(values)
        return cls(mu=float(logarithms.mean()), sigma=float(logarithms.std()))


_STEEPEST = 20.0  # beyond, the distribution is a half-normal to within a sample's resolution


@dataclass(frozen=True, kw_only=True)
class LogSkewNormal(Distribution):
    """Skew-normal distribution of the logarithm, density 2/ω φ(z) Φ(αz), z = (ln x − ξ)/ω.

    Azzalini, A. (1985). A class of distributions which includes the normal ones. *Scandinavian
    Journal of Statistics* 12(2), 171-178.

    >>> fitted = LogSkewNormal(location=0.0, scale=1.0, shape=0.0)
    >>> round(float(fitted.quantile(0.05)), 4)  # the lognormal's
    0.193
    """

    family_name: ClassVar[str] = "skewnorm"

    shape: float  # α, between −20 and 20; 0 is the lognormal, a positive one has the longer tail above
    location: float  # location, scale: ξ and ω of the logarithm
    scale: float

    @classmethod
    def _maximise_likelihood(cls, values: Array) -> Self:
        logarithms = np.log(values)
        mean, spread = float(logarithms.mean()), float(logarithms.std())
        z = (logarithms - mean) / spread
        # α = 0 is a stationary point of the likelihood, so the search starts on the side of the skewness.
        lean = 1.0 if scipy.stats.skew(z) >= 0.0 else -1.0
        optimum = scipy.optimize.minimize(
            lambda p: -float(scipy.stats.skewnorm.logpdf(z, p[2], p[0], np.exp(p[1])).sum()),
            np.array([-lean, 0.4, 2.0 * lean]),
            bounds=((-4.0, 4.0), (-4.0, 2.0), (-_STEEPEST, _STEEPEST)),
            method="L-BFGS-B",
        )
        location, log_scale, shape = (float(parameter) for parameter in optimum.x)
        return cls(shape=shape, location=mean + spread * location, scale=spread * float(np.exp(log_scale)))
