"""One quantity of a rig, learned from its tests: what it will be in a test under an earthquake not seen."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.arrays import Array
from reliab.criterion import MotionPredictive
from reliab.rig.learning.baselines import last_ten, left_out_scores, pooled
from reliab.rig.learning.circumstances import Circumstances, Likeness
from reliab.rig.learning.variances import LEVEL, Variances, covariance, fit_variances, inverse_of

_DEGREES = (2.5, 4.0, 8.0, 30.0)
_DRAWS_USED = 20
_SMALLEST = 1e-9
_STRAYED = 4.0  # spreads, beyond which a test counts as so far off
_FEWEST_FOR_ODD, _MOST_ODD = 10, 0.2  # tests, and share of them, that may be odd


@dataclass(frozen=True, kw_only=True, eq=False)
class Learned:
    """What the tests teach of one quantity."""

    values: Array  # Of the tests
    events: NDArray[np.str_]
    centre: float
    spread: float  # By which values are standardised
    likeness: Likeness
    variances: Variances
    left_out: Array  # Residual of each test when its earthquake is left out, over its predicted spread
    left_out_spreads: Array  # That spread, of standardised values

    def predict(self, others: Circumstances) -> tuple[Array, Array]:
        """Mean and standard deviation of tests under earthquakes not seen, shape (others,) each.

        The spread is that of an ordinary test; :attr:`shape` says how far a test may stray.
        """
        standard = (self.values - self.centre) / self.spread
        between, alone = self.likeness.between(others), self.likeness.of_each_alone(others)
        among = self.likeness.among_learned()
        noise = np.exp(2.0 * self.variances.mode[-1])
        mean, variance = self._at(self.variances.mode, standard, among, between)
        chosen = np.linspace(0, len(self.variances.draws) - 1, _DRAWS_USED).astype(int)
        means = [self._at(theta, standard, among, between)[0] for theta in self.variances.draws[chosen]]
        prior = sum(
            (
                np.exp(2.0 * log_spread) * alike
                for alike, log_spread in zip(alone, self.variances.mode, strict=False)
            ),
            np.full(len(others), LEVEL + noise),
        )
        deviation = np.sqrt(np.maximum(prior - variance + np.var(means, axis=0), _SMALLEST))
        return self.centre + self.spread * mean, self.spread * deviation

    def _at(self, theta: Array, standard: Array, among: Array, between: Array) -> tuple[Array, Array]:
        """Mean of other tests, and the variance that the learned ones take off, at given variances."""
        size = standard.size
        matrix = covariance(among, theta)
        matrix[np.diag_indices(size)] += np.exp(2.0 * theta[-1]) / self.variances.weights
        factor = scipy.linalg.cho_factor(matrix, lower=True, check_finite=False)
        across = covariance(between, theta)
        solved = scipy.linalg.cho_solve(factor, across.T, check_finite=False)
        return solved.T @ standard, np.einsum("ij,ji->i", across, solved)

    @cached_property
    def shape(self) -> MotionPredictive:
        """Distribution of the standardised residual of a further test, wider where few tests are known."""
        return shape_of(self.left_out, self.events)

    def quantiles(self, others: Circumstances, probabilities: tuple[float, ...]) -> Array:
        """Quantiles of tests, shape (probabilities, others)."""
        mean, deviation = self.predict(others)
        return np.stack([mean + deviation * self.shape.quantile(share)[0] for share in probabilities])

    def cumulative(self, others: Circumstances, value: float) -> Array:
        """Probability that the quantity is at most a value, shape (others,)."""
        mean, deviation = self.predict(others)
        standard = (value - mean) / deviation
        return np.array([float(self.shape.cumulative([residual])[0]) for residual in standard])

    @cached_property
    def log_score(self) -> float:
        """Mean log score of tests whose earthquake is left out."""
        return float(self.left_out_scores.mean())

    @cached_property
    def left_out_scores(self) -> Array:
        """Log score of each test when its earthquake is left out, by Student's t fitted to the residuals."""
        best = max((self._scores(degrees) for degrees in _DEGREES), key=lambda scores: float(scores.sum()))
        return np.asarray(best)

    def _scores(self, degrees: float) -> Array:
        _, _, scale = scipy.stats.t.fit(self.left_out, fdf=degrees, floc=0.0)
        spreads = self.spread * self.left_out_spreads
        return np.asarray(scipy.stats.t.logpdf(self.left_out, degrees, 0.0, scale) - np.log(spreads))

    @cached_property
    def scores_of_baselines(self) -> dict[str, float | None]:
        """Mean log score of each baseline on the same tests."""
        everything = left_out_scores(self.values, self.events, pooled, before=False)
        latest = left_out_scores(self.values, self.events, last_ten, before=True)
        return {
            "all tests pooled": _mean_of_known(everything),
            "the last ten": _mean_of_known(latest),
        }


def learn(values: Array, circumstances: Circumstances, events: NDArray[np.str_], *, seed: int = 0) -> Learned:
    """Learn one quantity.

    `values`, shape (tests,), at least three; `events`, the earthquake of each, a name of its own where it is
    not known.
    """
    centre = float(np.median(values))
    smallest = _SMALLEST * (1.0 + abs(centre))
    if np.ptp(values) < smallest:  # the same in all tests: taken as if it scattered by so little
        values = centre + smallest * np.random.default_rng(seed).standard_normal(values.size)
    spread = max(_median_spread(values, centre), 0.3 * float(values.std()), 0.3 * smallest)
    likeness = Likeness.among(circumstances, values.size)
    among = likeness.among_learned()
    standard = (values - centre) / spread
    variances = fit_variances(standard, among, likeness.respects, seed=seed)
    residuals, spreads = _left_out(standard, among, variances, events)
    return Learned(
        values=values,
        events=events,
        centre=centre,
        spread=spread,
        likeness=likeness,
        variances=variances,
        left_out=residuals / spreads,
        left_out_spreads=spreads,
    )


def shape_of(residuals: Array, events: NDArray[np.str_]) -> MotionPredictive:
    """Distribution of a further standardised residual, from those of tests whose earthquake was left out.

    One test far off does not widen the fitted shape, which nine of ten follow. Of fewer tests than ten, or
    where many are far off, nobody can tell which are the odd ones.
    """
    centre = float(np.median(residuals))
    reach = _STRAYED * _median_spread(residuals, centre)
    near = np.clip(residuals, centre - reach, centre + reach)
    if residuals.size >= _FEWEST_FOR_ODD and np.mean(near != residuals) <= _MOST_ODD:
        residuals = near
    return MotionPredictive.fit(residuals[:, None], events)


def _mean_of_known(scores: Array) -> float | None:
    return float(np.nanmean(scores)) if np.isfinite(scores).any() else None


def _median_spread(values: Array, centre: float) -> float:
    """Estimate a standard deviation by the median distance from the centre, which odd tests do not move."""
    return 1.4826 * float(np.median(np.abs(values - centre)))


def _left_out(
    standard: Array, among: Array, variances: Variances, events: NDArray[np.str_]
) -> tuple[Array, Array]:
    """Residual of each test, and spread of an ordinary test, predicted without its earthquake."""
    noise = np.exp(2.0 * variances.mode[-1])
    matrix = covariance(among, variances.mode)
    matrix[np.diag_indices(standard.size)] += noise / variances.weights
    inverse, _ = inverse_of(matrix)
    solved = inverse @ standard
    residuals, squares = np.empty_like(standard), np.empty_like(standard)
    for event in np.unique(events):
        members = np.flatnonzero(events == event)
        conditional = np.linalg.inv(inverse[np.ix_(members, members)])
        residuals[members] = conditional @ solved[members]
        squares[members] = np.diag(conditional) + noise * (1.0 - 1.0 / variances.weights[members])
    return residuals, np.sqrt(np.maximum(squares, _SMALLEST))
