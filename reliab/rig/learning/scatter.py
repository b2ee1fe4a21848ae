"""How a test scatters about its prediction: normally, unless the tests say otherwise.

Residuals that are standardised by their predicted spread follow Student's t distribution, perhaps wider on
one side than on the other (Fernández and Steel 1998), whose mean is zero. Its degrees of freedom, skewness
and scale have a posterior on a grid, and a further residual follows the mean of all of them. Before any test
is seen, 95 in 100 are normal and 2 in 100 skewed, and the logarithm of the scale is wholly unknown: then few
tests give wide intervals, many ordinary ones the normal distribution, and odd tests or a skewed scatter have
to show themselves. Tests of one earthquake are alike, so that all together count as their effective number,
less the one that the level takes.

Fernández, C., Steel, M. F. J. (1998). On Bayesian modeling of fat tails and skewness. *Journal of the
American Statistical Association* 93(441), 359-371.
"""

from dataclasses import dataclass
from functools import cache, cached_property
from typing import Final

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from reliab.core.arrays import Array
from reliab.criterion.event_components import event_components

_DEGREES: Final = (2.5, 4.0, 8.0, 1e4)
_OF_DEGREES: Final = (0.0075, 0.0125, 0.03, 0.95)
_SKEWNESS: Final = tuple(np.exp(0.23 * np.arange(-3, 4)).tolist())
_OF_SKEWNESS: Final = (0.0014, 0.0034, 0.0052, 0.98, 0.0052, 0.0034, 0.0014)
_LOG_SCALES: Final = np.arange(-1.2, 2.51, 0.05)  # predicted spreads are hardly much too large
_KNOTS: Final = np.sinh(np.linspace(-10.0, 10.0, 601))
_NEGLIGIBLE = 1e-7
_FEWEST_COUNTED = 2.0  # independent tests that any three are worth at least


@dataclass(frozen=True, kw_only=True, eq=False)
class Scatter:
    """Distribution of a further standardised residual: a mean of skewed t distributions."""

    weights: Array  # Of each distribution, with a sum of 1
    degrees: Array
    skewness: Array  # Spread above the mode over that below it, the root of it
    scale: Array

    @classmethod
    def learned(cls, residuals: Array, events: NDArray[np.str_]) -> "Scatter":
        """Learn from residuals of tests whose earthquake was left out."""
        counted = float(event_components(residuals[:, None], events).effective_number[0])
        share = (max(counted, _FEWEST_COUNTED) - 1.0) / residuals.size
        grid, table, prior = _grid()
        logarithms = prior + share * (_counts_at_knots(residuals) @ table)
        weights = np.exp(logarithms - logarithms.max())
        probable = weights > _NEGLIGIBLE
        degrees, skewness, scale = grid[:, probable]
        shares = weights[probable] / weights[probable].sum()
        return cls(weights=shares, degrees=degrees, skewness=skewness, scale=scale)

    def log_density(self, residuals: ArrayLike) -> Array:
        """Logarithm of the density of residuals, shape (residuals,)."""
        densities = _log_densities(np.asarray(residuals), self.degrees, self.skewness, self.scale)
        return np.asarray(scipy.special.logsumexp(densities, b=self.weights, axis=1))

    def cumulative(self, residuals: ArrayLike) -> Array:
        """Probability that a further residual is at most each of these, shape (residuals,)."""
        side = self.skewness
        z = np.asarray(residuals)[:, None] / self.scale + _means(self.degrees, side)
        below = scipy.special.stdtr(self.degrees, np.minimum(z, 0.0) * side)
        above = scipy.special.stdtr(self.degrees, np.maximum(z, 0.0) / side) - 0.5
        return np.asarray(2.0 / (1.0 + side**2) * (below + side**2 * above) @ self.weights)

    def quantile(self, probability: float) -> float:
        """Residual that a further one stays below with a probability."""
        reach = 10.0 * self._widest
        while self.cumulative([-reach])[0] > probability or self.cumulative([reach])[0] < probability:
            reach *= 10.0
        root = scipy.optimize.brentq(lambda x: self.cumulative([x])[0] - probability, -reach, reach)
        return float(root)

    @cached_property
    def _widest(self) -> float:
        return float((self.scale * np.maximum(self.skewness, 1.0 / self.skewness)).max())


def _means(degrees: Array, skewness: Array) -> Array:
    """Mean of the standard skewed t distribution, whose mode is 0."""
    ratio = np.exp(scipy.special.gammaln(0.5 * (degrees + 1.0)) - scipy.special.gammaln(0.5 * degrees))
    return np.asarray(2.0 * ratio * np.sqrt(degrees / np.pi) / (degrees - 1.0) * (skewness - 1.0 / skewness))


def _log_densities(residuals: Array, degrees: Array, skewness: Array, scale: Array) -> Array:
    """Logarithm of the density of each residual in each distribution, shape (residuals, distributions)."""
    z = residuals[:, None] / scale + _means(degrees, skewness)
    standard = np.where(z > 0.0, z / skewness, z * skewness)
    constant = scipy.special.gammaln(0.5 * (degrees + 1.0)) - scipy.special.gammaln(0.5 * degrees)
    constant -= 0.5 * np.log(degrees * np.pi) + np.log(0.5 * (skewness + 1.0 / skewness) * scale)
    return np.asarray(constant - 0.5 * (degrees + 1.0) * np.log1p(standard**2 / degrees))


@cache
def _grid() -> tuple[Array, Array, Array]:
    """Degrees, skewness and scale of all distributions, their log densities at the knots, and log prior."""
    places = np.meshgrid(_DEGREES, _SKEWNESS, np.exp(_LOG_SCALES), indexing="ij")
    prior = np.log(np.multiply.outer(_OF_DEGREES, _OF_SKEWNESS))[:, :, None] + np.zeros(_LOG_SCALES.size)
    grid = np.stack([place.ravel() for place in places])
    return grid, _log_densities(_KNOTS, *grid), prior.ravel()


def _counts_at_knots(residuals: Array) -> Array:
    """Weights of the knots that interpolate the sum of a function over residuals, linearly."""
    within = np.clip(residuals, _KNOTS[0], _KNOTS[-1])
    right = np.clip(np.searchsorted(_KNOTS, within), 1, _KNOTS.size - 1)
    share = (within - _KNOTS[right - 1]) / (_KNOTS[right] - _KNOTS[right - 1])
    size = _KNOTS.size
    return np.asarray(np.bincount(right, share, size) + np.bincount(right - 1, 1.0 - share, size))
