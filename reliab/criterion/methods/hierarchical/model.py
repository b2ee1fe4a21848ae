"""Events, motions, frequencies and damping ratios in one model, with the law inside."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.criterion.methods.hierarchical.covariance import (
    covariance_of,
    covariance_parameters,
    factor_of,
)
from reliab.criterion.methods.hierarchical.motion_means import MotionMeans
from reliab.criterion.methods.hierarchical.strata import (
    EVENT,
    FREQUENCY,
    FREQUENCY_SLOPE,
    MOTION,
    MOTION_SLOPE,
    REMAINDER,
    Grid,
    Strata,
    divide,
    weights_of_motion_mean,
)
from reliab.sampling.model import Model, Parameter

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
    curved: bool = False  # Whether the law has squares and products of its terms
    robust: bool = False  # Whether motions are Student-t

    def __post_init__(self) -> None:
        if not np.isfinite(self.values).all():
            raise InputError(
                "The hierarchical model needs an ellipse of every motion at every structure",
                value=f"{np.isnan(self.values).any(axis=(1, 2, 3)).sum()} motions without",
                remedy="Leave these motions out, or choose a smaller threshold",
            )

    @cached_property
    def grid(self) -> Grid:
        """The structures."""
        return Grid(frequencies=self.frequencies, damping_ratios=self.damping_ratios)

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """Coefficients of a, coefficients of b, covariances of the effects, degrees of freedom."""
        names = tuple(self._terms)
        coefficients = (
            Parameter(
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
        degrees = (Parameter(name="log degrees of freedom", mean=float(np.log(10.0)), spread=0.8),)
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
        if self.curved:
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
        within = np.einsum("k,wkc->wc", self._weights_of_mean, covariances)
        below = self._strata.log_likelihood(coefficients, covariances)
        if self.robust:
            return below + self._means.robust(centre, covariances[:, 0], within, np.exp(theta[:, -1]))
        return below + self._means.normal(centre, covariances[:, 0], within)

    def simulate(self, theta: Array, rng: np.random.Generator) -> Self:
        """Draw as many motions of as many earthquakes at the same structures."""
        groups = np.unique(self.events, return_inverse=True)[1]
        drawn = self.draw_motions(theta[None, :], groups, rng)[0]
        return replace(self, values=drawn)

    def draw_motions(self, theta: Array, groups: NDArray[np.int64], rng: np.random.Generator) -> Array:
        """Draw motions of further earthquakes.

        `theta` (vectors, parameters); `groups` (motions,); returns (vectors, motions, F, X, 2).
        """
        along_f, along_xi = self.grid.shape
        eta = self.grid.eta[:, None]
        every = factor_of(self.covariances(theta))
        factors = {name: every[:, k] for k, name in enumerate(self.grid.effects)}

        def effect(name: str, *shape: int) -> Array:
            if name not in factors:
                return np.zeros((1,) * (len(shape) + 2))
            normal = rng.standard_normal((len(theta), *shape, 2))
            return np.asarray(np.einsum("wij,w...j->w...i", factors[name], normal))

        count = groups.size
        about = (
            effect(MOTION, count, 1, 1)
            + effect(MOTION_SLOPE, count, 1, 1) * eta
            + effect(FREQUENCY, count, along_f, 1)
            + effect(FREQUENCY_SLOPE, count, along_f, 1) * eta
            + effect(REMAINDER, count, along_f, along_xi)
        )
        about = about * np.ones((along_f, along_xi, 1))
        if self.robust:
            degrees = np.exp(theta[:, -1])[:, None]
            longer = np.sqrt(degrees / rng.chisquare(degrees, (len(theta), count)))
            mean = about.mean(axis=(2, 3), keepdims=True)
            about = about + (longer[..., None, None, None] - 1.0) * mean
        event = effect(EVENT, int(groups.max()) + 1, 1, 1)[:, groups]
        law = np.einsum("wtq,fxt->wfxq", self.coefficients(theta), self.terms)
        return np.asarray(law[:, None] + event + about)
