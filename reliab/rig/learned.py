"""One quantity of a rig, learned from its tests: what it will be in a test under an earthquake not seen.

Tests are predicted without their earthquake by one inverse P of the covariance of all. With u = P y, the
residual of tests e that are left out together is P_ee⁻¹ u_e and its covariance P_ee⁻¹ (Rasmussen and Williams
2006, 5.4.2). Where an earthquake g is not there at all, P_ee − P_eg P_gg⁻¹ P_ge and u_e − P_eg P_gg⁻¹ u_g
take their places.

A test scatters about its prediction normally, unless the tests say otherwise. Residuals that are standardised
by their predicted spread follow Student's t distribution, perhaps wider on one side than on the other
(Fernández and Steel 1998), whose mean is zero. Its degrees of freedom, skewness and scale have a posterior on
a grid, and a further residual follows the mean of all of them. Before any test is seen, 95 in 100 are normal
and 2 in 100 skewed, and the logarithm of the scale is wholly unknown: then few tests give wide intervals,
many ordinary ones the normal distribution, and odd tests or a skewed scatter have to show themselves. Tests
of one earthquake are alike, so that all together count as their effective number, less the one that the level
takes.

Fernández, C., Steel, M. F. J. (1998). On Bayesian modeling of fat tails and skewness. *Journal of the
American Statistical Association* 93(441), 359-371.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Final

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from reliab.core.arrays import Array
from reliab.criterion.motion_predictive import event_components
from reliab.rig.covariates import LEVEL, Covariates, Kernels, Variances, covariance, fit_variances, inverse_of

_DEGREES: Final = (2.5, 4.0, 8.0, 1e4)
_DEGREES_COEFFICIENTS: Final = (0.0075, 0.0125, 0.03, 0.95)
_SKEWNESS: Final = tuple(np.exp(0.23 * np.arange(-3, 4)).tolist())
_SKEWNESS_COEFFICIENTS: Final = (0.0014, 0.0034, 0.0052, 0.98, 0.0052, 0.0034, 0.0014)
_LOG_SCALES: Final = np.arange(-1.2, 2.51, 0.05)  # predicted spreads are hardly much too large
_KNOTS: Final = np.sinh(np.linspace(-10.0, 10.0, 601))
_NEGLIGIBLE = 1e-7
_FEWEST_COUNTED = 2.0  # independent tests that any three are worth at least


@dataclass(frozen=True, kw_only=True, eq=False)
class ResidualDistribution:
    """Distribution of a further standardised residual: a mean of skewed t distributions."""

    weights: Array  # Of each distribution, with a sum of 1
    degrees: Array
    skewness: Array  # Spread above the mode over that below it, the root of it
    scale: Array

    @classmethod
    def fit(cls, residuals: Array, events: NDArray[np.str_]) -> "ResidualDistribution":
        """Learn from residuals of tests whose earthquake was left out."""
        effective_number = float(event_components(residuals[:, None], events).effective_number[0])
        share = (max(effective_number, _FEWEST_COUNTED) - 1.0) / residuals.size
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
        lower_part = scipy.special.stdtr(self.degrees, np.minimum(z, 0.0) * side)
        upper_part = scipy.special.stdtr(self.degrees, np.maximum(z, 0.0) / side) - 0.5
        return np.asarray(2.0 / (1.0 + side**2) * (lower_part + side**2 * upper_part) @ self.weights)

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
    prior = np.log(np.multiply.outer(_DEGREES_COEFFICIENTS, _SKEWNESS_COEFFICIENTS))[:, :, None] + np.zeros(
        _LOG_SCALES.size
    )
    grid = np.stack([place.ravel() for place in places])
    return grid, _log_densities(_KNOTS, *grid), prior.ravel()


def _counts_at_knots(residuals: Array) -> Array:
    """Weights of the knots that interpolate the sum of a function over residuals, linearly."""
    clipped_residuals = np.clip(residuals, _KNOTS[0], _KNOTS[-1])
    right = np.clip(np.searchsorted(_KNOTS, clipped_residuals), 1, _KNOTS.size - 1)
    share = (clipped_residuals - _KNOTS[right - 1]) / (_KNOTS[right] - _KNOTS[right - 1])
    size = _KNOTS.size
    return np.asarray(np.bincount(right, share, size) + np.bincount(right - 1, 1.0 - share, size))


_LAST = 10
_FEWEST = 3

Baseline = Callable[[Array], "StudentPrediction"]
"""Predicts a further value from values in the order of tests."""


@dataclass(frozen=True, kw_only=True)
class StudentPrediction:
    """A scaled Student t distribution."""

    centre: float
    scale: float
    degrees: float

    def log_density(self, value: float) -> float:
        """Logarithm of the density."""
        return float(scipy.stats.t.logpdf(value, self.degrees, self.centre, self.scale))


def pool(values: Array) -> StudentPrediction:
    """Predict from all tests, as if they were independent and normal.

    >>> pool(np.array([1.0, 2.0, 3.0])).centre
    2.0
    """
    spread = max(float(values.std(ddof=1)), 1e-9)
    return StudentPrediction(
        centre=float(values.mean()),
        scale=spread * np.sqrt(1.0 + 1.0 / values.size),
        degrees=values.size - 1.0,
    )


def last_ten(values: Array) -> StudentPrediction:
    """Predict from the last ten tests."""
    return pool(values[-_LAST:])


def score_left_out_events(
    values: Array, events: NDArray[np.str_], baseline: Baseline, *, only_earlier: bool
) -> Array:
    """Log scores of a baseline for each test, its earthquake left out.

    `only_earlier`: whether only tests before each are known; NaN where there are fewer than three.
    """
    scores = np.full(values.size, np.nan)
    for place, event in enumerate(events):
        usable = events != event
        if only_earlier:
            usable[place:] = False
        if usable.sum() >= _FEWEST:
            scores[place] = baseline(values[usable]).log_density(values[place])
    return scores


_SMALLEST = 1e-9

_DRAWS_USED = 20


@dataclass(frozen=True, kw_only=True, eq=False)
class LeaveOneEventOut:
    """Residuals of tests that are predicted without their earthquake."""

    inverse: Array  # Of the covariance of all tests
    inverse_values: Array  # Times their values
    ordinary: Array  # Variance of an ordinary test less that of each, which the odd ones have more of
    events: NDArray[np.str_]

    @classmethod
    def from_tests(
        cls, standard: Array, among: Array, variances: Variances, events: NDArray[np.str_]
    ) -> "LeaveOneEventOut":
        """Leave out each earthquake at the most probable variances."""
        noise = np.exp(2.0 * variances.mode[-1])
        matrix = covariance(among, variances.mode)
        matrix[np.diag_indices(standard.size)] += noise / variances.weights
        inverse, _ = inverse_of(matrix)
        return cls(
            inverse=inverse,
            inverse_values=inverse @ standard,
            ordinary=noise * (1.0 - 1.0 / variances.weights),
            events=events,
        )

    @cached_property
    def members(self) -> list[NDArray[np.intp]]:
        """Places of the tests of each earthquake."""
        _, event_index = np.unique(self.events, return_inverse=True)
        order = np.argsort(event_index, kind="stable")
        return np.split(order, np.flatnonzero(np.diff(event_index[order])) + 1)

    @property
    def residuals(self) -> Array:
        """Residual of each test over its predicted spread."""
        return self._complete_prediction[0]

    @property
    def spreads(self) -> Array:
        """Predicted spread of each test, if it is an ordinary one."""
        return self._complete_prediction[1]

    def residuals_without(self, absent: NDArray[np.intp]) -> Array:
        """Return the same residuals if an earthquake had never been; zeros for its own tests."""
        projection = self.inverse[:, absent] @ np.linalg.inv(self.inverse[np.ix_(absent, absent)])
        return self._leave_out(absent, projection)[0]

    @cached_property
    def _complete_prediction(self) -> tuple[Array, Array]:
        return self._leave_out(np.empty(0, dtype=np.intp), np.empty((self.inverse_values.size, 0)))

    @cached_property
    def _events_by_size(self) -> list[NDArray[np.intp]]:
        """Places of the tests of all earthquakes of a size, shape (earthquakes, size) each."""
        sizes = np.array([places.size for places in self.members])
        return [
            np.array([self.members[index] for index in np.flatnonzero(sizes == size)])
            for size in np.unique(sizes)
        ]

    def _leave_out(self, absent: NDArray[np.intp], projection: Array) -> tuple[Array, Array]:
        """Residuals over their spreads, and these, where what absent tests teach is taken away."""
        residuals, squares = np.zeros_like(self.inverse_values), np.ones_like(self.inverse_values)
        reduced_values = self.inverse_values - projection @ self.inverse_values[absent]
        for same_size_events in self._events_by_size:
            places = same_size_events[~np.isin(same_size_events[:, 0], absent)]
            block = self.inverse[places[:, :, None], places[:, None, :]]
            cross_inverse = self.inverse[:, absent][places]
            conditional = np.linalg.inv(block - projection[places] @ cross_inverse.swapaxes(1, 2))
            residuals[places] = np.einsum("eij,ej->ei", conditional, reduced_values[places])
            squares[places] = np.einsum("eii->ei", conditional) + self.ordinary[places]
        spreads = np.sqrt(np.maximum(squares, _SMALLEST))
        return residuals / spreads, spreads


@dataclass(frozen=True, kw_only=True, eq=False)
class FittedQuantity:
    """What the tests teach of one quantity."""

    values: Array  # Of the tests
    events: NDArray[np.str_]
    centre: float
    spread: float  # By which values are standardised
    kernels: Kernels
    variances: Variances
    left_out: LeaveOneEventOut  # Each test, of standardised values, predicted without its earthquake

    def predict(self, targets: Covariates) -> tuple[Array, Array]:
        """Mean and standard deviation of tests under earthquakes not seen, shape (others,) each.

        The spread is that of an ordinary test; :attr:`scatter` says how far a test may stray.
        """
        standard = (self.values - self.centre) / self.spread
        covariances, priors = (self.kernels.covariances(targets), self.kernels.prior_variances(targets))
        among = self.kernels.among_learned()
        noise = np.exp(2.0 * self.variances.mode[-1])
        mean, variance = self._conditional_moments(self.variances.mode, standard, among, covariances)
        rows = np.linspace(0, len(self.variances.draws) - 1, _DRAWS_USED).astype(int)
        means = [
            self._conditional_moments(theta, standard, among, covariances)[0]
            for theta in self.variances.draws[rows]
        ]
        prior = sum(
            (
                np.exp(2.0 * log_spread) * kernel
                for kernel, log_spread in zip(priors, self.variances.mode, strict=False)
            ),
            np.full(len(targets), LEVEL + noise),
        )
        deviation = np.sqrt(np.maximum(prior - variance + np.var(means, axis=0), _SMALLEST))
        return self.centre + self.spread * mean, self.spread * deviation

    def _conditional_moments(
        self, theta: Array, standard: Array, among: Array, kernels_to_targets: Array
    ) -> tuple[Array, Array]:
        """Mean of other tests, and the variance that the learned ones take off, at given variances."""
        size = standard.size
        matrix = covariance(among, theta)
        matrix[np.diag_indices(size)] += np.exp(2.0 * theta[-1]) / self.variances.weights
        factor = scipy.linalg.cho_factor(matrix, lower=True, check_finite=False)
        cross_covariance = covariance(kernels_to_targets, theta)
        weights = scipy.linalg.cho_solve(factor, cross_covariance.T, check_finite=False)
        return weights.T @ standard, np.einsum("ij,ji->i", cross_covariance, weights)

    @cached_property
    def scatter(self) -> ResidualDistribution:
        """Distribution of the standardised residual of a further test, wider where few tests are known."""
        return ResidualDistribution.fit(self.left_out.residuals, self.events)

    def quantiles(self, targets: Covariates, probabilities: tuple[float, ...]) -> Array:
        """Quantiles of tests, shape (probabilities, others)."""
        mean, deviation = self.predict(targets)
        return np.stack([mean + deviation * self.scatter.quantile(share) for share in probabilities])

    def cumulative(self, targets: Covariates, value: float) -> Array:
        """Probability that the quantity is at most a value, shape (others,)."""
        mean, deviation = self.predict(targets)
        return self.scatter.cumulative((value - mean) / deviation)

    @cached_property
    def log_score(self) -> float:
        """Mean log score of tests whose earthquake is left out."""
        return float(self.score_left_out_events.mean())

    @cached_property
    def score_left_out_events(self) -> Array:
        """Log score of each test when its earthquake is left out."""
        scores = np.empty_like(self.values)
        for members, scatter in self.scatters_without_earthquakes():
            scores[members] = scatter.log_density(self.left_out.residuals[members])
        return scores - np.log(self.spread * self.left_out.spreads)

    def scatters_without_earthquakes(self) -> Iterator[tuple[NDArray[np.intp], ResidualDistribution]]:
        """Places of the tests of each earthquake, and how tests scatter by what all others teach."""
        for members in self.left_out.members:
            other_indices = np.delete(np.arange(self.values.size), members)
            residuals = self.left_out.residuals_without(members)[other_indices]
            yield members, ResidualDistribution.fit(residuals, self.events[other_indices])

    @cached_property
    def scores_of_baselines(self) -> dict[str, float | None]:
        """Mean log score of each baseline on the same tests."""
        everything = score_left_out_events(self.values, self.events, pool, only_earlier=False)
        latest = score_left_out_events(self.values, self.events, last_ten, only_earlier=True)
        return {
            "all tests pooled": _mean_of_known(everything),
            "the last ten": _mean_of_known(latest),
        }


def learn(values: Array, covariates: Covariates, events: NDArray[np.str_]) -> FittedQuantity:
    """Learn one quantity.

    `values`, shape (tests,), at least three; `events`, the earthquake of each, a name of its own where it is
    not known.
    """
    centre = float(np.median(values))
    smallest = _SMALLEST * (1.0 + abs(centre))
    if np.ptp(values) < smallest:  # the same in all tests: taken as if it scattered by so little
        values = centre + smallest * np.random.default_rng(0).standard_normal(values.size)
    spread = max(_median_spread(values, centre), 0.3 * float(values.std()), 0.3 * smallest)
    kernels = Kernels.among(covariates, values.size)
    among = kernels.among_learned()
    standard = (values - centre) / spread
    variances = fit_variances(standard, among, kernels.respects)
    return FittedQuantity(
        values=values,
        events=events,
        centre=centre,
        spread=spread,
        kernels=kernels,
        variances=variances,
        left_out=LeaveOneEventOut.from_tests(standard, among, variances, events),
    )


def _mean_of_known(scores: Array) -> float | None:
    return float(np.nanmean(scores)) if np.isfinite(scores).any() else None


def _median_spread(values: Array, centre: float) -> float:
    """Estimate a standard deviation by the median distance from the centre, which odd tests do not move."""
    return 1.4826 * float(np.median(np.abs(values - centre)))
