"""Distributions whose functions are those of a family of scipy, of the quantity or of its logarithm.

The paper takes the lognormal one for a and b; skew-normal: Azzalini (1985).
"""

from abc import abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from reliab.criterion.distributions.distribution import Distribution, maximise_likelihood


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
