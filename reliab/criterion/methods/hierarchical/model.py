"""Events, motions, frequencies and damping ratios in one model, with the law inside."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar, Final, Self

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.compiled import compiled
from reliab.core.errors import InputError
from reliab.criterion.methods.hierarchical.strata import (
    EVENT,
    FREQUENCY,
    FREQUENCY_SLOPE,
    MOTION,
    MOTION_SLOPE,
    REMAINDER,
    ComparedStructures,
    Strata,
    covariance_of,
    covariance_parameters,
    divide,
    factor_of,
    normal_log_density,
    squares_of,
    weights_of_motion_mean,
)
from reliab.sampling.ensembles import Model, SampledParameter


@compiled
def log_distances(
    residuals: Array,
    effects: Array,
    groups: NDArray[np.int64],
    degrees: Array,
) -> Array:
    """Sum ln(1 + d²/ν) over the motions of each earthquake."""
    vectors, events, nodes, _ = effects.shape
    sums = np.zeros((vectors, events, nodes))
    for vector in range(vectors):
        share = 1.0 / degrees[vector]
        for motion in range(groups.size):
            event = groups[motion]
            first, second = residuals[vector, motion, 0], residuals[vector, motion, 1]
            for node in range(nodes):
                first_residual = first - effects[vector, event, node, 0]
                second_residual = second - effects[vector, event, node, 1]
                sums[vector, event, node] += np.log(
                    1.0 + share * (first_residual * first_residual + second_residual * second_residual)
                )
    return sums


_NODES: Final = 7  # Gauss-Hermite nodes along each of two directions
_ROUNDS: Final = 6  # reweighted means that place them


@dataclass(frozen=True, kw_only=True, eq=False)
class MotionMeans:
    """Means of ln α and ln β of each motion over all structures, grouped by earthquake."""

    means: Array  # The means, shape (motions, 2)
    groups: NDArray[np.int64]  # Number of each motion's earthquake, from zero, shape (motions,)

    def normal(
        self,
        centre: Array,
        between_covariance: Array,
        within_covariance: Array,
    ) -> Array:
        """Log-likelihood with normal event and motion effects.

        `centre` (vectors, 2); `between_covariance`, `within_covariance` (vectors, 3); returns (vectors,).
        """
        sizes, event_means, scatter = self._event_statistics
        within_density = normal_log_density(within_covariance, scatter, float(self.groups.size - sizes.size))
        mean_covariance = between_covariance[:, None, :] + within_covariance[:, None, :] / sizes[:, None]
        mean_squares = squares_of(event_means - centre[:, None, :])
        return np.asarray(within_density + normal_log_density(mean_covariance, mean_squares, 1.0).sum(axis=1))

    def robust(
        self,
        centre: Array,
        between_covariance: Array,
        inner: Array,
        degrees: Array,
    ) -> Array:
        """Log-likelihood with normal event effects and bivariate Student-t motions about them.

        The event effects are integrated out by Gauss–Hermite quadrature about their conditional mode,
        which is found by reweighting.

        `degrees` (vectors,); returns (vectors,).
        """
        # In coordinates in which the scale is the identity, distances are Euclidean.
        whitening = _inverse_of_triangle(_cholesky(_matrix(inner)))
        whitened_residuals = np.einsum("wij,wmj->wmi", whitening, self.means - centre[:, None, :])
        prior = whitening @ _matrix(between_covariance) @ whitening.swapaxes(-1, -2)
        mode, precision = self._conditional(whitened_residuals, _inverse(prior), degrees)
        directions = _inverse_of_triangle(_cholesky(precision)).swapaxes(-1, -2)
        nodes, weights = _nodes()
        effects = mode[:, :, None, :] + nodes @ directions.swapaxes(-1, -2)
        log_weights = weights + 0.5 * (nodes**2).sum(axis=1)
        integrand = self._integrand(whitened_residuals, effects, prior, degrees) + log_weights
        peak = integrand.max(axis=2)
        area = np.log(np.exp(integrand - peak[..., None]).sum(axis=2))
        densities = (peak + area - 0.5 * np.log(_determinant(precision))).sum(axis=1)
        return np.asarray(densities - 0.5 * self.groups.size * np.log(_determinant(_matrix(inner))))

    @cached_property
    def _event_statistics(self) -> tuple[NDArray[np.int64], Array, Array]:
        """Sizes of the earthquakes, their means, and the squares about these."""
        sizes = np.bincount(self.groups)
        event_means = self._event_sums(self.means) / sizes[:, None]
        return sizes, event_means, squares_of(self.means - event_means[self.groups]).sum(axis=0)

    def _event_sums(self, values: Array) -> Array:
        """Sum motions of each earthquake along the last axis but one."""
        order = np.argsort(self.groups, kind="stable")
        starts = np.flatnonzero(np.diff(self.groups[order], prepend=-1))
        return np.asarray(np.add.reduceat(values[..., order, :], starts, axis=-2))

    def _conditional(self, residuals: Array, prior: Array, degrees: Array) -> tuple[Array, Array]:
        """Mode (vectors, events, 2) of the event effects and precision (vectors, events, 2, 2) about it."""
        weight = np.ones((*residuals.shape[:2], 1))
        for _ in range(_ROUNDS):
            precision = prior[:, None] + self._event_sums(weight)[..., None] * np.eye(2)
            pull = self._event_sums(weight * residuals)
            mode = (_inverse(precision) @ pull[..., None])[..., 0]
            distance_squared = ((residuals - mode[:, self.groups]) ** 2).sum(axis=2, keepdims=True)
            weight = (degrees[:, None, None] + 2.0) / (degrees[:, None, None] + distance_squared)
        return np.asarray(mode), np.asarray(precision, dtype=np.float64)

    def _integrand(
        self,
        residuals: Array,
        effects: Array,
        prior: Array,
        degrees: Array,
    ) -> Array:
        """Log-density of effects and motions in whitened coordinates, shape (vectors, events, nodes)."""
        motions = log_distances(residuals, effects, self.groups, degrees)
        factor = _inverse_of_triangle(_cholesky(prior))
        standard = effects @ factor.swapaxes(-1, -2)[:, None]
        events = -0.5 * (standard**2).sum(axis=-1) + np.log(_determinant(factor))[:, None, None]
        return np.asarray(events - 0.5 * (degrees[:, None, None] + 2.0) * motions)


def _matrix(covariance: Array) -> Array:
    """Covariances (..., 3) as matrices (..., 2, 2)."""
    aa, bb, ab = np.moveaxis(covariance, -1, 0)
    return np.stack([np.stack([aa, ab], axis=-1), np.stack([ab, bb], axis=-1)], axis=-2)


# Two by two and in closed form, so that a covariance that is singular to rounding gives NaN, and with it no
# probability, instead of an exception for all vectors.
def _determinant(matrix: Array) -> Array:
    return np.asarray(matrix[..., 0, 0] * matrix[..., 1, 1] - matrix[..., 0, 1] * matrix[..., 1, 0])


def _inverse(matrix: Array) -> Array:
    """Inverse of symmetric matrices."""
    aa, bb, ab = matrix[..., 0, 0], matrix[..., 1, 1], matrix[..., 0, 1]
    adjugate = _matrix(np.stack([bb, aa, -ab], axis=-1))
    return np.asarray(adjugate / _determinant(matrix)[..., None, None])


def _cholesky(matrix: Array) -> Array:
    """Lower factors; NaN where there is none."""
    first = np.sqrt(matrix[..., 0, 0])
    off_diagonal = matrix[..., 1, 0] / first
    return _triangle(first, off_diagonal, np.sqrt(matrix[..., 1, 1] - off_diagonal**2))


def _inverse_of_triangle(factor: Array) -> Array:
    """Inverse of lower triangular matrices."""
    first, off_diagonal, second = factor[..., 0, 0], factor[..., 1, 0], factor[..., 1, 1]
    return _triangle(1.0 / first, -off_diagonal / (first * second), 1.0 / second)


def _triangle(first: Array, off_diagonal: Array, second: Array) -> Array:
    rows = [np.stack([first, np.zeros_like(first)], axis=-1), np.stack([off_diagonal, second], axis=-1)]
    return np.stack(rows, axis=-2)


def _nodes() -> tuple[Array, Array]:
    """Nodes (nodes, 2) and logarithms of weights of the two-dimensional standard normal density."""
    x, w = np.polynomial.hermite_e.hermegauss(_NODES)
    grid = np.stack(np.meshgrid(x, x, indexing="ij"), axis=-1).reshape(-1, 2)
    return grid, np.log(np.outer(w, w)).ravel()


_TYPICAL = {EVENT: 0.3, MOTION: 0.4, MOTION_SLOPE: 0.2, FREQUENCY: 0.4, FREQUENCY_SLOPE: 0.2, REMAINDER: 0.1}
_PAIR = 2


@dataclass(frozen=True, kw_only=True, eq=False)
class Hierarchical(Model):
    """ln α and ln β of motions m of earthquakes e at structures (f, ξ).

    .. math:: y_{m f ξ} = c·t(f, ξ) + u_e + v_m + v'_m η + w_{m f} + w'_{m f} η + ε_{m f ξ}

    with η = ln ξ about its mean over the grid. Every effect is a pair (for α and β), normal with a covariance
    of its own; all of them are integrated out exactly, and 2 × terms coefficients and three parameters
    for each effect are sampled. The law's terms t are 1, ln f and ln(ξ/0.05) (linear), and with `curved`
    their squares and product too, as in the dimensionless law. Effects that the grid cannot separate are
    left out.

    With `robust`, a motion's mean over all structures is bivariate Student-t about its earthquake instead
    of normal, with the same scale and unknown degrees of freedom, so that a few outlying records do not
    widen what is learned from the others.

    Priors: intercepts N(−1, 1.5²), other coefficients N(0, 0.5²); logarithms of spreads normal with
    standard deviation 0.8 about ln 0.3 (event), ln 0.4 (motion, motion at a frequency), ln 0.2
    (slopes), ln 0.1 (remainder); Fisher's z of correlations N(1.5, 0.75²); ln ν ~ N(ln 10, 0.8²).

    >>> model = Hierarchical(
    ...     values=np.zeros((4, 2, 2, 2)), events=np.array(["K", "K", "L", "L"]),
    ...     frequencies=np.array([1.0, 2.0]), damping_ratios=np.array([0.02, 0.05]),
    ... )
    >>> len(model.parameters), model.grid.effects[:2]
    (21, ('event', 'motion'))
    """

    name: ClassVar[str] = "hierarchical"

    values: Array  # ln α and ln β, all finite, shape (motions, F, X, 2)
    events: NDArray[np.str_]  # Earthquake of each motion, shape (motions,)
    frequencies: Array  # frequencies, damping_ratios: The grid [Hz, -], shape (F,) and (X,)
    damping_ratios: Array
    has_curvature: bool = False  # Whether the law has squares and products of its terms
    robust: bool = False  # Whether motions are Student-t

    def __post_init__(self) -> None:
        if not np.isfinite(self.values).all():
            raise InputError(
                "The hierarchical model needs an ellipse of every motion at every structure",
                value=f"{np.isnan(self.values).any(axis=(1, 2, 3)).sum()} motions without",
                remedy="Leave these motions out, or choose a smaller threshold",
            )

    @cached_property
    def grid(self) -> ComparedStructures:
        """The structures."""
        return ComparedStructures(frequencies=self.frequencies, damping_ratios=self.damping_ratios)

    @cached_property
    def parameters(self) -> tuple[SampledParameter, ...]:
        """Coefficients of a, coefficients of b, covariances of the effects, degrees of freedom."""
        names = tuple(self._terms)
        coefficients = (
            SampledParameter(
                name=f"{name}: {term}",
                mean=-1.0 if term == "constant" else 0.0,
                spread=1.5 if term == "constant" else 0.5,
            )
            for name in "ab"
            for term in names
        )
        covariances = (
            parameter
            for effect in self.grid.effects
            for parameter in covariance_parameters(effect, _TYPICAL[effect])
        )
        degrees = (SampledParameter(name="log degrees of freedom", mean=float(np.log(10.0)), spread=0.8),)
        return (*coefficients, *covariances, *(degrees if self.robust else ()))

    @property
    def data(self) -> Array:
        """The values."""
        return self.values

    @cached_property
    def terms(self) -> Array:
        """Terms of the law on the grid, shape (F, X, terms)."""
        return np.stack(list(self._terms.values()), axis=-1)

    @cached_property
    def _terms(self) -> dict[str, Array]:
        phi, eta = np.meshgrid(np.log(self.frequencies), np.log(self.damping_ratios / 0.05), indexing="ij")
        fits = {"constant": True, "ln f": phi.shape[0] > 1, "ln ξ": phi.shape[1] > 1}
        terms = {"constant": np.ones_like(phi), "ln f": phi, "ln ξ": eta}
        if self.has_curvature:
            terms.update({"ln² f": phi**2, "ln f ln ξ": phi * eta, "ln² ξ": eta**2})
            fits.update(
                {
                    "ln² f": phi.shape[0] > _PAIR,
                    "ln f ln ξ": min(phi.shape) > 1,
                    "ln² ξ": phi.shape[1] > _PAIR,
                }
            )
        return {name: term for name, term in terms.items() if fits[name]}

    @cached_property
    def _strata(self) -> Strata:
        return divide(self.grid, self.values, self.terms)

    @cached_property
    def _weights_of_mean(self) -> Array:
        return weights_of_motion_mean(self.grid)

    @cached_property
    def _means(self) -> MotionMeans:
        groups = np.unique(self.events, return_inverse=True)[1]
        return MotionMeans(means=self.values.mean(axis=(1, 2)), groups=groups)

    def coefficients(self, theta: Array) -> Array:
        """Coefficients of the law, shape (vectors, terms, 2)."""
        count = len(self._terms)
        return theta[:, : 2 * count].reshape(-1, 2, count).swapaxes(1, 2)

    def covariances(self, theta: Array) -> Array:
        """Covariance of each effect of the grid, shape (vectors, effects, 3)."""
        begin, count = 2 * len(self._terms), len(self.grid.effects)
        return covariance_of(theta[:, begin : begin + 3 * count].reshape(-1, count, 3))

    def log_likelihood(self, theta: Array) -> Array:
        """Likelihood of all strata; event and motion effects are integrated out."""
        coefficients, covariances = self.coefficients(theta), self.covariances(theta)
        centre = np.einsum("wtq,t->wq", coefficients, self.terms.mean(axis=(0, 1)))
        scatter = np.einsum("k,wkc->wc", self._weights_of_mean, covariances)
        strata_density = self._strata.log_likelihood(coefficients, covariances)
        if self.robust:
            return strata_density + self._means.robust(
                centre, covariances[:, 0], scatter, np.exp(theta[:, -1])
            )
        return strata_density + self._means.normal(centre, covariances[:, 0], scatter)

    def simulate(self, theta: Array, rng: np.random.Generator) -> Self:
        """Draw as many motions of as many earthquakes at the same structures."""
        groups = np.unique(self.events, return_inverse=True)[1]
        motions = self.draw_motions(theta[None, :], groups, rng)[0]
        return replace(self, values=motions)

    def draw_motions(self, theta: Array, groups: NDArray[np.int64], rng: np.random.Generator) -> Array:
        """Draw motions of further earthquakes.

        `theta` (vectors, parameters); `groups` (motions,); returns (vectors, motions, F, X, 2).
        """
        f_count, xi_count = self.grid.shape
        eta = self.grid.eta[:, None]
        covariance_factors = factor_of(self.covariances(theta))
        factors = {name: covariance_factors[:, k] for k, name in enumerate(self.grid.effects)}

        def effect(name: str, *shape: int) -> Array:
            if name not in factors:
                return np.zeros((1,) * (len(shape) + 2))
            normal = rng.standard_normal((len(theta), *shape, 2))
            return np.asarray(np.einsum("wij,w...j->w...i", factors[name], normal))

        count = groups.size
        about = (
            effect(MOTION, count, 1, 1)
            + effect(MOTION_SLOPE, count, 1, 1) * eta
            + effect(FREQUENCY, count, f_count, 1)
            + effect(FREQUENCY_SLOPE, count, f_count, 1) * eta
            + effect(REMAINDER, count, f_count, xi_count)
        )
        about = about * np.ones((f_count, xi_count, 1))
        if self.robust:
            degrees = np.exp(theta[:, -1])[:, None]
            longer = np.sqrt(degrees / rng.chisquare(degrees, (len(theta), count)))
            mean = about.mean(axis=(2, 3), keepdims=True)
            about = about + (longer[..., None, None, None] - 1.0) * mean
        event = effect(EVENT, int(groups.max()) + 1, 1, 1)[:, groups]
        law = np.einsum("wtq,fxt->wfxq", self.coefficients(theta), self.terms)
        return np.asarray(law[:, None] + event + about)
