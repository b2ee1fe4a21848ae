"""Distributions of a and b over ground motions, by their names.

The paper takes the lognormal one for a and b; skew-normal: Azzalini (1985).
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import astuple, dataclass
from typing import Any, ClassVar, Final, Self, cast

import numpy as np
import scipy
from numpy.typing import ArrayLike

from reliab.core.arrays import Array
from reliab.core.errors import InputError

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

    @abstractmethod
    def log_density(self, values: ArrayLike) -> Array:
        """Natural logarithm of the density of the quantity itself (not of its logarithm)."""

    @abstractmethod
    def cumulative(self, values: ArrayLike) -> Array:
        """Probability of being at most each value."""

    @abstractmethod
    def quantile(self, probability: ArrayLike) -> Array:
        """Value that is not exceeded with the given probability, in (0, 1)."""


class FamilyDistribution(Distribution):
    """A family of scipy for the natural logarithm of the quantity; its fields are scipy's parameters."""

    family_name: ClassVar[str]  # Name of the family in `scipy.stats`
    of_logarithm: ClassVar[bool] = True  # Else it is one for the quantity itself

    @property
    def family(self) -> Any:  # noqa: ANN401 - scipy has no types
        """The family, a `scipy.stats.rv_continuous`."""
        return getattr(scipy.stats, self.family_name)

    @property
    def parameters(self) -> tuple[float, ...]:
        """Parameters in scipy's order: shapes, location, scale."""
        return astuple(cast("Any", self))

    def log_density(self, values: ArrayLike) -> Array:
        """Natural logarithm of the density of the quantity itself."""
        if not self.of_logarithm:
            return np.asarray(self.family.logpdf(values, *self.parameters))
        logarithms = np.log(values)
        return np.asarray(self.family.logpdf(logarithms, *self.parameters) - logarithms)

    def cumulative(self, values: ArrayLike) -> Array:
        """Probability of being at most each value."""
        return np.asarray(self.family.cdf(np.log(values) if self.of_logarithm else values, *self.parameters))

    def quantile(self, probability: ArrayLike) -> Array:
        """Value that is not exceeded with the given probability."""
        quantile = np.asarray(self.family.ppf(probability, *self.parameters))
        return np.exp(quantile) if self.of_logarithm else quantile


def _fit_shaped(
    family: Any,  # noqa: ANN401 - scipy has no types
    values: Array,
    start: Sequence[float],
    bounds: Sequence[tuple[float, float]],
    to_shape: Callable[[float], float] = float,
) -> tuple[float, float, float]:
    """Fit shape, location and scale to the logarithms of values.

    `start`, `bounds`: of the location and the logarithm of the scale of standardised logarithms, and of what
    `to_shape` makes the shape of.
    """
    logarithms = np.log(values)
    mean, spread = float(logarithms.mean()), float(logarithms.std())
    z = (logarithms - mean) / spread
    optimum = scipy.optimize.minimize(
        lambda p: -float(family.logpdf(z, to_shape(p[2]), p[0], np.exp(p[1])).sum()),
        np.asarray(start),
        bounds=bounds,
        method="L-BFGS-B",
    )
    location, log_scale, shape = (float(parameter) for parameter in optimum.x)
    return float(to_shape(shape)), mean + spread * location, spread * float(np.exp(log_scale))


@dataclass(frozen=True, kw_only=True)
class Lognormal(FamilyDistribution):
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
    def _maximise_likelihood(cls, values: Array) -> Self:
        logarithms = np.log(values)
        return cls(mu=float(logarithms.mean()), sigma=float(logarithms.std()))


@dataclass(frozen=True, kw_only=True)
class ShapeScaleDistribution(FamilyDistribution):
    """A family of scipy for the quantity itself, from zero."""

    of_logarithm: ClassVar[bool] = False

    shape: float  # Shape [-]
    location: float = 0.0
    scale: float  # Scale, in the quantity's unit


@dataclass(frozen=True, kw_only=True)
class Gamma(ShapeScaleDistribution):
    """Gamma distribution of the quantity itself, from zero.

    >>> round(float(Gamma(shape=1.0, scale=2.0).quantile(0.5)), 4)  # exponential: 2 ln 2
    1.3863
    """

    name: ClassVar[str] = "gamma"
    family_name: ClassVar[str] = "gamma"

    @classmethod
    def _maximise_likelihood(cls, values: Array) -> Self:
        unit = float(values.mean())
        shape, _, scale = scipy.stats.gamma.fit(values / unit, floc=0.0)
        return cls(shape=float(shape), scale=float(scale) * unit)


_REACH = 1e3


@dataclass(frozen=True, kw_only=True)
class Weibull(ShapeScaleDistribution):
    """Weibull distribution of the quantity itself, from zero.

    >>> round(float(Weibull(shape=1.0, scale=2.0).quantile(0.5)), 4)  # exponential: 2 ln 2
    1.3863
    """

    name: ClassVar[str] = "weibull"
    family_name: ClassVar[str] = "weibull_min"

    @classmethod
    def _maximise_likelihood(cls, values: Array) -> Self:
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


_DEGREES = (1.0, 500.0)  # Cauchy to all but normal


@dataclass(frozen=True, kw_only=True)
class LogStudentT(FamilyDistribution):
    """Student's t distribution of the logarithm.

    >>> fitted = LogStudentT(mu=0.0, sigma=1.0, degrees_of_freedom=3.0)
    >>> round(float(fitted.quantile(0.05)), 4)
    0.095
    """

    name: ClassVar[str] = "student_t"
    family_name: ClassVar[str] = "t"

    degrees_of_freedom: float  # From 1 (Cauchy) to 500 (all but normal)
    mu: float  # mu, sigma: Location and scale of the logarithm
    sigma: float

    @classmethod
    def _maximise_likelihood(cls, values: Array) -> Self:
        start, bounds = (0.0, 0.0, np.log(10.0)), ((-3.0, 3.0), (-6.0, 2.0), tuple(np.log(_DEGREES)))
        degrees, mu, sigma = _fit_shaped(scipy.stats.t, values, start, bounds, np.exp)
        return cls(degrees_of_freedom=degrees, mu=mu, sigma=sigma)


_STEEPEST = 20.0  # beyond, the distribution is a half-normal to within a sample's resolution


@dataclass(frozen=True, kw_only=True)
class LogSkewNormal(FamilyDistribution):
    """Skew-normal distribution of the logarithm, density 2/ω φ(z) Φ(αz), z = (ln x − ξ)/ω.

    Azzalini, A. (1985). A class of distributions which includes the normal ones. *Scandinavian
    Journal of Statistics* 12(2), 171-178.

    >>> fitted = LogSkewNormal(location=0.0, scale=1.0, shape=0.0)
    >>> round(float(fitted.quantile(0.05)), 4)  # the lognormal's
    0.193
    """

    name: ClassVar[str] = "skew_normal"
    family_name: ClassVar[str] = "skewnorm"

    shape: float  # α, between −20 and 20; 0 is the lognormal, a positive one has the longer tail above
    location: float  # location, scale: ξ and ω of the logarithm
    scale: float

    @classmethod
    def _maximise_likelihood(cls, values: Array) -> Self:
        # α = 0 is a stationary point of the likelihood, so the search starts on the side of the skewness.
        lean = 1.0 if scipy.stats.skew(np.log(values)) >= 0.0 else -1.0
        start, bounds = (-lean, 0.4, 2.0 * lean), ((-4.0, 4.0), (-4.0, 2.0), (-_STEEPEST, _STEEPEST))
        shape, location, scale = _fit_shaped(scipy.stats.skewnorm, values, start, bounds)
        return cls(shape=shape, location=location, scale=scale)


_OUTERMOST = 40.0  # standard deviations from the outermost mean within which every quantile lies


@dataclass(frozen=True, kw_only=True, eq=False)
class NormalKernels(Distribution):
    """Weighted normal distributions of the logarithm."""

    # weights, means, spreads: Weight, mean and standard deviation of the logarithm of each, shape (k,)
    weights: Array
    means: Array
    spreads: Array

    def log_density(self, values: ArrayLike) -> Array:
        """Natural logarithm of the density."""
        logarithms = np.log(values)
        return log_mixture(logarithms, self.weights, self.means, self.spreads) - logarithms

    def cumulative(self, values: ArrayLike) -> Array:
        """Probability of being at most each value."""
        return self._cumulative_of_logarithm(np.log(values))

    def quantile(self, probability: ArrayLike) -> Array:
        """Value that is not exceeded with the given probability."""
        from scipy.optimize import elementwise

        target = np.asarray(probability, dtype=np.float64)
        low = np.full_like(target, (self.means - _OUTERMOST * self.spreads).min())
        high = np.full_like(target, (self.means + _OUTERMOST * self.spreads).max())
        root = elementwise.find_root(
            lambda x, p: self._cumulative_of_logarithm(x) - p, (low, high), args=(target,)
        )
        return np.asarray(np.exp(root.x))

    def _cumulative_of_logarithm(self, logarithms: Array) -> Array:
        return np.asarray(
            scipy.stats.norm.cdf(logarithms[..., None], self.means, self.spreads) @ self.weights
        )


def log_mixture(
    logarithms: Array,
    weights: Array,
    means: Array,
    spreads: Array,
) -> Array:
    """Logarithm of a mixture's density of the logarithm, shape of `logarithms`."""
    kernel_densities = scipy.stats.norm.logpdf(logarithms[..., None], means, spreads)
    return np.asarray(scipy.special.logsumexp(kernel_densities, b=weights, axis=-1))


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
    def _maximise_likelihood(cls, values: Array) -> Self:
        logarithms = np.log(values)
        quartiles = scipy.stats.iqr(logarithms) / _NORMAL_QUARTILES
        spread = min(logarithms.std(), quartiles) if quartiles > 0.0 else logarithms.std()
        bandwidth = 0.9 * spread * values.size**-0.2
        return cls(
            weights=np.full(values.size, 1.0 / values.size),
            means=logarithms,
            spreads=np.full(values.size, bandwidth),
        )


_ITERATIONS = 500
_TOLERANCE = 1e-6
_NARROWEST = 0.1  # share of the sample's spread; a component narrower than that would chase single values


@dataclass(frozen=True, kw_only=True, eq=False)
class LogGaussianMixture(NormalKernels):
    """Two normal distributions of the logarithm, fitted by expectation and maximisation.

    No component is narrower than a tenth of the sample's spread: the likelihood has no maximum otherwise.

    >>> two = np.exp(np.concatenate([np.linspace(-1.0, 1.0, 50), np.linspace(9.0, 11.0, 50)]))
    >>> np.sort(LogGaussianMixture.fit(two).means).round(2) + 0.0
    array([ 0., 10.])
    """

    name: ClassVar[str] = "gaussian_mixture"

    @classmethod
    def _maximise_likelihood(cls, values: Array) -> Self:
        logarithms = np.log(values)
        floor = _NARROWEST * logarithms.std()
        weights = np.array([0.5, 0.5])
        means, spreads = np.quantile(logarithms, [0.25, 0.75]), np.full(2, logarithms.std())
        last_likelihood = -np.inf
        for _ in range(_ITERATIONS):
            density = log_mixture(logarithms, weights, means, spreads)
            if density.sum() - last_likelihood < _TOLERANCE:
                break
            last_likelihood = density.sum()
            component_densities = np.log(weights) + scipy.stats.norm.logpdf(
                logarithms[:, None], means, spreads
            )
            share = np.exp(component_densities - density[:, None])
            total = np.maximum(share.sum(axis=0), 1e-12)
            weights, means = total / total.sum(), (share * logarithms[:, None]).sum(axis=0) / total
            variance = (share * (logarithms[:, None] - means) ** 2).sum(axis=0) / total
            spreads = np.maximum(np.sqrt(variance), floor)
        return cls(weights=weights, means=means, spreads=spreads)


DISTRIBUTIONS: Final[dict[str, type[Distribution]]] = {
    family.name: family
    for family in (Lognormal, LogStudentT, LogSkewNormal, Gamma, Weibull, LogGaussianMixture, Empirical)
}
"""Every distribution by its name."""
