"""The distribution of a further motion's value, and how much of the scatter lies between earthquakes.

A Dirichlet process with a skew-normal base measure (Ferguson 1973): its predictive distribution is the
weighted mean of the empirical distribution and of the base. The empirical distribution has the weight of as
many independent motions as the earthquakes are worth, the base that of twenty. With many earthquakes the
data determine the tail, with few the fitted shape does.

The base is skew-normal for two reasons: logarithms of a and b are skewed, since a resonant response
cannot be more sensitive than a steady one; and the smaller of two correlated normal variables, on which
a joint bound rests, is exactly skew-normal (Azzalini 1985). Its moments are the sample's, and its spread
is widened as Student's t widens the normal distribution of a further value.

References
----------
Ferguson, T. S. (1973). A Bayesian analysis of some nonparametric problems. *Annals of Statistics* 1(2),
209-230.
Chandrupatla, T. R. (1997). A new hybrid quadratic/bisection algorithm for finding the zero of a nonlinear
function without using derivatives. *Advances in Engineering Software* 28, 145-149.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from reliab.core.arrays import Array

_FEWEST_EFFECTIVE = 2.0


@dataclass(frozen=True, kw_only=True, eq=False)
class EventComponents:
    """Components of variance of values over motions, by analysis of variance."""

    # between, within: Variance between earthquakes and between motions of one earthquake
    between: Array
    within: Array
    # Number of independent motions that would leave the mean as uncertain
    effective_number: Array

    @property
    def event_share(self) -> Array:
        """Share of the variance that lies between earthquakes [-], the intraclass correlation."""
        total = self.between + self.within
        return np.asarray(self.between / np.where(total > 0.0, total, 1.0))


def event_components(values: Array, events: NDArray[np.str_]) -> EventComponents:
    """Divide the variance of values between and within earthquakes.

    Unbiased for any numbers of motions in the earthquakes; a negative variance between earthquakes
    counts as none. The share of the *variance of observed event means*, which includes what the
    motions themselves scatter, is larger and no measure of how alike motions of one earthquake are.
    With one earthquake, or one motion from each, the two cannot be separated, and the motions count as
    independent.

    `values` (motions, ...); `events` (motions,).

    Searle, S. R., Casella, G. and McCulloch, C. E. (1992). *Variance components*, section 3.6.

    >>> values = np.array([1.0, 1.2, 3.0, 3.2, 5.0, 5.2])
    >>> components = event_components(values, np.array(["a", "a", "b", "b", "c", "c"]))
    >>> float(components.event_share.round(3)), float(components.effective_number.round(1))
    (0.995, 3.0)
    """
    squares = SumsOfSquares.from_values(values, events)
    n = values.shape[0]
    if not squares.separate:
        inner = np.asarray(squares.total / (n - 1))
        return EventComponents(
            between=np.zeros_like(inner),
            within=inner,
            effective_number=np.full_like(inner, n),
        )
    inner = squares.within / squares.degrees_within
    outer = np.maximum((squares.between / squares.degrees_between - inner) / squares.mean_size, 0.0)
    inner = np.where(outer > 0.0, inner, squares.total / (n - 1))
    variance_of_mean = outer * squares.concentration + inner / n
    varies = variance_of_mean > 0.0  # equal values are worth as many motions as there are
    effective = np.where(varies, (outer + inner) / np.where(varies, variance_of_mean, 1.0), float(n))
    effective = np.maximum(effective, _FEWEST_EFFECTIVE)
    return EventComponents(
        between=np.asarray(outer),
        within=np.asarray(inner),
        effective_number=np.asarray(effective),
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class SumsOfSquares:
    """Sums of squares of an analysis of variance by earthquake, of values of shape (motions, ...)."""

    between: Array  # Of the means of earthquakes about the mean of all motions, shape (...)
    within: Array  # Of motions about the means of their earthquakes
    degrees_between: int
    degrees_within: int
    mean_size: float  # Motions of an earthquake, as they count for the variance between earthquakes
    concentration: float  # Part of the variance between earthquakes in that of the mean of all motions

    @classmethod
    def from_values(cls, values: Array, events: NDArray[np.str_]) -> Self:
        """Divide the squares of values by the earthquakes of their motions."""
        _, group, sizes = np.unique(events, return_inverse=True, return_counts=True)
        n, k = values.shape[0], sizes.size
        deviation = values - values.mean(axis=0)
        sums = np.zeros((k, *values.shape[1:]))
        np.add.at(sums, group, deviation)
        between_squares = (sums**2 / sizes.reshape(-1, *(1,) * (values.ndim - 1))).sum(axis=0)
        concentration = float((sizes**2).sum()) / n**2
        return cls(
            between=np.asarray(between_squares),
            within=np.asarray((deviation**2).sum(axis=0) - between_squares),
            degrees_between=k - 1,
            degrees_within=n - k,
            mean_size=n * (1.0 - concentration) / max(k - 1, 1),
            concentration=concentration,
        )

    @property
    def separate(self) -> bool:
        """Whether the two can be told apart: several earthquakes, one of them with several motions."""
        return self.degrees_between > 0 and self.degrees_within > 0

    @property
    def total(self) -> Array:
        """Sum of the squares about the mean of all motions."""
        return np.asarray(self.between + self.within)


_MOST_STEPS = 200
_RESOLUTION = 4.0 * float(np.finfo(np.float64).eps)


def roots_of_increasing(function: Callable[[Array], Array], low: Array, high: Array) -> Array:
    """Find the root of each of several increasing functions to rounding; NaN where there is none.

    `function` takes and returns one value for each of them, shape (functions,); `low` and `high`: interval in
    which to begin, which is widened where it holds no root, shape (functions,).

    >>> cubes = np.array([8.0, 27.0])
    >>> roots_of_increasing(lambda x: x**3 - cubes, np.zeros(2), np.ones(2)).round(12).tolist()
    [2.0, 3.0]
    """
    low, high = _bracket(function, low, high)
    newest, opposite, last = low.copy(), high.copy(), high.copy()
    f_newest, f_opposite = function(newest), function(opposite)
    f_last, share = f_opposite.copy(), np.full(low.shape, 0.5)
    for _ in range(_MOST_STEPS):
        trial = newest + share * (opposite - newest)
        f_trial = function(trial)
        agrees = np.sign(f_trial) == np.sign(f_newest)
        last, f_last = (np.where(agrees, newest, opposite), np.where(agrees, f_newest, f_opposite))
        opposite, f_opposite = (np.where(agrees, opposite, newest), np.where(agrees, f_opposite, f_newest))
        newest, f_newest = trial, f_trial
        best = np.where(np.abs(f_newest) < np.abs(f_opposite), newest, opposite)
        width = np.abs(opposite - newest)
        least = 0.5 * _RESOLUTION * np.abs(best) / np.where(width > 0.0, width, 1.0)
        is_final = (width <= _RESOLUTION * np.abs(best)) | (f_newest == 0.0) | (f_opposite == 0.0)
        if (is_final | ~np.isfinite(width)).all():
            break
        share = np.clip(
            _interpolate_root(newest, opposite, last, f_newest, f_opposite, f_last),
            least,
            1.0 - least,
        )
    return np.where(np.isfinite(width), best, np.nan)


def _bracket(function: Callable[[Array], Array], low: Array, high: Array) -> tuple[Array, Array]:
    """Widen intervals, each step twice as far as the one before, until their ends have opposite signs."""
    low, high, reach = low.astype(np.float64), high.astype(np.float64), high - low
    for _ in range(_MOST_STEPS):
        is_above, is_below = function(low) > 0.0, function(high) < 0.0
        if not (is_above | is_below).any():
            return low, high
        low, high, reach = (
            np.where(is_above, low - reach, low),
            np.where(is_below, high + reach, high),
            2.0 * reach,
        )
    return np.where(is_above | is_below, np.nan, low), high


def _interpolate_root(a: Array, b: Array, c: Array, value_a: Array, value_b: Array, value_c: Array) -> Array:
    """Share of the way from a to b of the root by inverse quadratic interpolation; a half where unsafe."""
    with np.errstate(divide="ignore", invalid="ignore"):
        place, height = (a - b) / (c - b), (value_a - value_b) / (value_c - value_b)
        safe = (1.0 - np.sqrt(1.0 - place) < height) & (height < np.sqrt(place))
        quadratic = value_a / (value_b - value_a) * value_c / (value_b - value_c)
        quadratic += (c - a) / (b - a) * value_a / (value_c - value_a) * value_b / (value_c - value_b)
    return np.where(safe & np.isfinite(quadratic), quadratic, 0.5)


CONCENTRATION = 20.0
"""Weight of the fitted shape, as a number of motions."""

_STEEPEST_SKEWNESS = 0.99  # a skew-normal distribution has less than 0.9953
_EXTREME = 1e-300
_TAIL = 6.0  # standard deviations beyond which a tail is continued by its asymptote
_NARROWEST = 1e-9  # spread of equal values, which have none


@dataclass(frozen=True, kw_only=True, eq=False)
class MotionPredictive:
    """Predictive distributions of several quantities, each over the same motions.

    >>> values = np.random.default_rng(1).normal(size=(400, 1))
    >>> predictive = MotionPredictive.fit(values, np.arange(400).astype(str))
    >>> predictive.quantile(0.05).round(2), predictive.cumulative([0.0]).round(2)
    (array([-1.62]), array([0.53]))
    """

    sorted_values: Array  # The values in increasing order
    location: Array  # location, scale, shape: Skew-normal base
    scale: Array
    shape: Array
    effective_number: Array  # Number of independent motions that the sample is worth
    concentration: float = CONCENTRATION  # Weight of the base, as a number of motions

    @classmethod
    def fit(
        cls, values: Array, events: NDArray[np.str_], concentration: float = CONCENTRATION
    ) -> "MotionPredictive":
        """Learn from motions.

        `concentration`: weight of the fitted shape, as a number of motions.
        """
        location, scale, shape = _skew_normal_of_moments(values)
        return cls(
            sorted_values=np.sort(values, axis=0),
            location=location,
            scale=scale,
            shape=shape,
            effective_number=event_components(values, events).effective_number,
            concentration=concentration,
        )

    def cumulative(self, x: ArrayLike) -> Array:
        """Probability that a further motion's value is at most x.

        Returns probabilities, shape (quantities,).
        """
        points = np.broadcast_to(np.asarray(x, dtype=np.float64), self.location.shape)
        base, upper_base = self._base(points)
        weight = self.effective_number / (self.effective_number + self.concentration)
        return np.asarray(weight * self._empirical(points, base, upper_base) + (1.0 - weight) * base)

    def quantile(self, probability: float) -> Array:
        """Value that a further motion stays below with the given probability, shape (quantities,).

        Returns finite values, shape (quantities,); a larger probability never gives a smaller one.
        """
        roots = roots_of_increasing(
            lambda x: self.cumulative(x) - probability,
            self.sorted_values[0] - self.scale,
            self.sorted_values[-1] + self.scale,
        )
        if not np.isfinite(roots).all():
            raise ArithmeticError(f"No quantile at the probability {probability} of {self}.")
        return roots

    @cached_property
    def _tails(self) -> tuple[Array, Array]:
        """Probability of the base below the smallest and above the greatest value."""
        lower_tail, upper_tail = self._base(self.sorted_values[0])[0], self._base(self.sorted_values[-1])[1]
        return np.maximum(lower_tail, _EXTREME), np.maximum(upper_tail, _EXTREME)

    def _base(self, x: Array) -> tuple[Array, Array]:
        """Share of the base below x, and above it."""
        normal = _normal_score((x - self.location) / self.scale, self.shape)
        degrees = self.effective_number - 1.0
        # The sample's own spread lacks that of its mean, which a further value has twice (t of a further
        # value).
        student = normal / np.sqrt((self.effective_number + 1.0) / degrees)
        return np.asarray(scipy.special.stdtr(degrees, student)), np.asarray(
            scipy.special.stdtr(degrees, -student)
        )

    def _empirical(self, x: Array, base: Array, upper_base: Array) -> Array:
        """Ranks over n + 1, linear between motions and in proportion to the base beyond them."""
        n = self.sorted_values.shape[0]
        smaller = (self.sorted_values <= x).sum(axis=0)
        left_value, right = (
            np.take_along_axis(self.sorted_values, np.clip(rank, 0, n - 1)[None], axis=0)[0]
            for rank in (smaller - 1, smaller)
        )
        gap = np.where(right > left_value, right - left_value, 1.0)
        inner = smaller + np.clip((x - left_value) / gap, 0.0, 1.0)
        least, upper_tail = self._tails
        lower, upper = np.minimum(base / least, 1.0), n + 1.0 - np.minimum(upper_base / upper_tail, 1.0)
        return np.asarray(np.where(smaller == 0, lower, np.where(smaller == n, upper, inner)) / (n + 1.0))


def _normal_score(x: Array, shape: Array) -> Array:
    """Find the standard normal value that is as probable to be exceeded as a standard skew-normal x.

    Where a tail of the skew-normal distribution is too small to be computed, its asymptote is used: it falls
    as that of a normal distribution with the spread 1/sqrt(1 + shape²) on the short side, and with
    the spread 1 on the long side.
    """
    steepness = [np.hypot(1.0, np.maximum(sign * shape, 0.0)) for sign in (1.0, -1.0)]
    low, high = -_TAIL / steepness[0], _TAIL / steepness[1]
    inner = np.clip(x, low, high)
    turn = 2.0 * scipy.special.owens_t(inner, shape)
    lower_tail, upper_tail = scipy.special.ndtr(inner) - turn, scipy.special.ndtr(-inner) + turn
    score = np.where(
        lower_tail < upper_tail,
        scipy.special.ndtri(np.minimum(lower_tail, 0.5)),
        -scipy.special.ndtri(np.minimum(upper_tail, 0.5)),
    )
    excess = steepness[0] * np.minimum(x - low, 0.0) + steepness[1] * np.maximum(x - high, 0.0)
    return np.asarray(score + excess)


def _skew_normal_of_moments(
    values: Array,
) -> tuple[Array, Array, Array]:
    """Location, scale and shape of the skew-normal distribution with the sample's first three moments."""
    deviation = values - values.mean(axis=0)
    spread = np.maximum(deviation.std(axis=0), _NARROWEST)
    skewness = ((deviation / spread) ** 3).mean(axis=0).clip(-_STEEPEST_SKEWNESS, _STEEPEST_SKEWNESS)
    ratio = (2.0 * np.abs(skewness) / (4.0 - np.pi)) ** (2.0 / 3.0)
    delta = np.sign(skewness) * np.sqrt(np.pi / 2.0 * ratio / (1.0 + ratio))
    scale = spread / np.sqrt(1.0 - 2.0 * delta**2 / np.pi)
    location = values.mean(axis=0) - scale * delta * np.sqrt(2.0 / np.pi)
    return location, scale, delta / np.sqrt(1.0 - delta**2)
