"""From ellipses through the posterior of the hierarchical model to limits.

A boundary that reaches beyond where ellipses describe it leaves a motion without one, at high damping and
large errors. Such a motion tolerates more than others. To leave it out everywhere would shift and narrow what
is learned of all motions, which is optimistic at some structures and pessimistic at others: what it would
have there is drawn from the model itself.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Self

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.progress import Progress, silent
from reliab.core.significant_digits import percent
from reliab.core.vocabulary import Side
from reliab.criterion.laws.law import scales
from reliab.criterion.methods.hierarchical.model import Hierarchical
from reliab.criterion.methods.hierarchical.strata import (
    EVENT,
    FREQUENCY,
    FREQUENCY_SLOPE,
    MOTION,
    MOTION_SLOPE,
    REMAINDER,
    ComparedStructures,
    weights_of_motion,
    weights_of_motion_mean,
)
from reliab.criterion.methods.method import LearnedLimits, Scatter, validate_share
from reliab.criterion.population import FEWEST_MOTIONS, Population, SampleGrid
from reliab.sampling.ensembles import Ensembles, Laplace, draw, width_of
from reliab.sampling.posterior_sample import PosteriorSample

_NODES = 24  # normal distributions that make up a Student's t
_WIDER = 1e-9  # of a bracket, so that rounding leaves the root inside
_TINY = 1e-300  # in place of zero, where a ratio would have no sign


@dataclass(frozen=True, kw_only=True, eq=False)
class FurtherMotions:
    """Normal ln α and ln β of one motion at each structure, or mixtures that differ in their spread."""

    mean: Array  # Means, for each vector of parameters, shape (vectors, F, X, 2)
    # Variance of ln α, variance of ln β and covariance of each part of the mixture, shape (vectors, F, X,
    # parts, 3)
    covariance: Array
    weights: Array  # Shares of the mixture, shape (parts,)

    @classmethod
    def from_draws(cls, model: Hierarchical, theta: Array) -> Self:
        """Integrate out every effect of a motion and of its earthquake.

        `theta` (vectors, parameters).
        """
        effects = model.covariances(theta)
        mean = np.einsum("wtq,fxt->wfxq", model.coefficients(theta), model.terms)
        single = np.einsum("xk,wkc->wxc", weights_of_motion(model.grid), effects)
        covariance = np.broadcast_to(single[:, None, :, None], (*mean.shape[:-1], 1, 3))
        weights = np.ones(1)
        if model.robust:
            places, lengths = np.polynomial.legendre.leggauss(_NODES)
            weights = 0.5 * lengths
            degrees = np.exp(theta[:, -1])[:, None]
            stretch = degrees / scipy.special.chdtri(degrees, 0.5 + 0.5 * places)
            mean_effects = np.einsum("k,wkc->wc", weights_of_motion_mean(model.grid), effects)
            covariance = covariance + ((stretch[..., None] - 1.0) * mean_effects[:, None])[:, None, None]
        return cls(mean=mean, covariance=covariance, weights=weights)

    def depth(self, share: float, scatter: Scatter, *, joint: bool) -> Array:
        """Standardised logarithms that a share of the motions exceeds.

        Returns (vectors, F, X, 2).
        """
        mean = scatter.standard(self.mean)[..., None, :]
        spread = np.sqrt(self.covariance[..., :2]) / scatter.spread[:, :, None]
        correlation = self.covariance[..., 2] / np.sqrt(self.covariance[..., :2].prod(axis=-1))
        if joint:
            depth = _depth(share, self.weights, mean, spread, correlation)
            return np.stack([depth, depth], axis=-1)
        sides = (slice(0, 1), slice(1, 2))
        return np.stack(
            [_depth(share, self.weights, mean[..., k], spread[..., k], correlation) for k in sides], axis=-1
        )


def _depth(
    share: float,
    weights: Array,
    mean: Array,
    spread: Array,
    correlation: Array,
) -> Array:
    """Depth that one variable exceeds, or two together; last axes of mean and spread (parts, variables)."""
    from scipy.optimize import elementwise

    variables, shape = mean.shape[-1], correlation.shape[:-1]
    means = mean.reshape(-1, 1, variables)
    spreads, correlations = spread.reshape(-1, weights.size, variables), correlation.reshape(-1, weights.size)

    def excess(depth: Array, cell: Array) -> Array:
        these = cell.astype(np.int64)
        standard_excess = np.moveaxis((means[these] - depth[:, None, None]) / spreads[these], -1, 0)
        shares = (
            scipy.special.ndtr(standard_excess[0])
            if variables == 1
            else both_below(standard_excess[0], standard_excess[1], correlations[these])
        )
        return np.asarray(shares @ weights - share)

    # One of both lies below its own quantile, and at least half of the rest is below the lower one's.
    low = (means + spreads * scipy.special.ndtri((1.0 - share) / variables)).min(axis=(1, 2))
    high = (means + spreads * scipy.special.ndtri(1.0 - share)).max(axis=1).min(axis=-1)
    root = elementwise.find_root(
        excess, (low - _WIDER, np.maximum(high, low) + _WIDER), args=(np.arange(low.size, dtype=np.float64),)
    )
    return np.asarray(root.x.reshape(shape))


def both_below(first: ArrayLike, second: ArrayLike, correlation: ArrayLike) -> Array:
    """Distribution function of the standard bivariate normal distribution, by two of Owen's T functions.

    D. B. Owen, Tables for computing bivariate normal probabilities, Annals of Mathematical Statistics 27
    (1956), eq. (2.1).

    >>> both_below(0.0, 0.0, [0.0, 0.5]).round(6).tolist()
    [0.25, 0.333333]
    """
    h, k, r = np.broadcast_arrays(
        *(np.asarray(value, dtype=np.float64) for value in (first, second, correlation))
    )
    h, k = (np.where(limit == 0.0, _TINY, limit) for limit in (h, k))
    root = np.sqrt((1.0 - r) * (1.0 + r))
    owen = scipy.special.owens_t(h, (k / h - r) / root) + scipy.special.owens_t(k, (h / k - r) / root)
    opposite = np.where((h > 0.0) == (k > 0.0), 0.0, 0.5)
    return np.asarray(0.5 * (scipy.special.ndtr(h) + scipy.special.ndtr(k)) - owen - opposite)


_ROUNDS = 2


def impute_missing(model: Hierarchical, lacking: Array, events: NDArray[np.str_]) -> Hierarchical:
    """Add motions that lack some structures to a model of motions that have all.

    What is missing is drawn once, given what the motion has at its other structures, at the mode of the
    posterior; this is done again with the mode of the filled model.

    `lacking` (motions, F, X, 2); `events` (motions,).
    """
    if not len(lacking):
        return model
    model_with_values = model
    for _ in range(_ROUNDS):
        theta = Laplace.about_mode(model_with_values).mode[None]
        law = np.einsum("tq,fxt->fxq", model_with_values.coefficients(theta)[0], model_with_values.terms)
        covariance = _covariance(model_with_values.grid, model_with_values.covariances(theta)[0])
        rng = np.random.default_rng(2017)  # the same draws in every round
        imputed_motions = np.stack([_draw_missing(motion, law, covariance, rng) for motion in lacking])
        model_with_values = replace(
            model,
            values=np.concatenate([model.values, imputed_motions]),
            events=np.concatenate([model.events, events]),
        )
    return model_with_values


def _covariance(grid: ComparedStructures, covariances: Array) -> Array:
    """Covariance of all values of one motion, shape (F·X·2, F·X·2), from those of the effects."""
    f_count, xi_count = grid.shape
    everywhere, identity = np.ones((f_count, f_count)), np.eye(f_count)
    level, slope = np.ones((xi_count, xi_count)), np.outer(grid.eta, grid.eta)
    structure_factors = {
        EVENT: np.kron(everywhere, level),
        MOTION: np.kron(everywhere, level),
        MOTION_SLOPE: np.kron(everywhere, slope),
        FREQUENCY: np.kron(identity, level),
        FREQUENCY_SLOPE: np.kron(identity, slope),
        REMAINDER: np.eye(f_count * xi_count),
    }
    pairs = [np.array([[aa, ab], [ab, bb]]) for aa, bb, ab in covariances]
    parts = (np.kron(structure_factors[name], pair) for name, pair in zip(grid.effects, pairs, strict=True))
    return np.asarray(sum(parts))


def _draw_missing(
    values: Array,
    law: Array,
    covariance: Array,
    rng: np.random.Generator,
) -> Array:
    """Draw what one motion lacks given what it has, shape (F, X, 2)."""
    y, centre = values.ravel().copy(), law.ravel()
    gone = np.isnan(y)
    has = covariance[np.ix_(~gone, ~gone)]
    weight = np.linalg.solve(has, covariance[np.ix_(~gone, gone)]).T
    mean = centre[gone] + weight @ (y[~gone] - centre[~gone])
    remaining = covariance[np.ix_(gone, gone)] - weight @ covariance[np.ix_(~gone, gone)]
    y[gone] = rng.multivariate_normal(mean, remaining, method="eigh")
    return y.reshape(values.shape)


_DRAWS_OF_LIMITS = 2000
_MOTIONS = 40  # for each draw, each of an earthquake of its own
_POPULATIONS = 400  # draws of the posterior whose own quantile is found


def posterior_limits(
    posterior: PosteriorSample,
    model: Hierarchical,
    confidence: float,
    *,
    joint: bool,
    assurance: float | None = None,
    seed: int = 2017,
) -> Array:
    """Limits that the stated share of motions of further earthquakes exceeds.

    Returns (F, X, 2).
    """
    rng = np.random.default_rng(seed)
    motion_draws = model.draw_motions(posterior.spread_out(_DRAWS_OF_LIMITS), np.arange(_MOTIONS), rng)
    motions = motion_draws.reshape(-1, *motion_draws.shape[2:])
    scatter = Scatter.from_logarithms(motions)

    if assurance is None:
        standing = scatter.worse(motions)[..., None] if joint else scatter.standard(motions)
        depth = np.quantile(standing, 1.0 - confidence, axis=0)
    else:
        populations = FurtherMotions.from_draws(model, posterior.spread_out(_POPULATIONS))
        depth = np.quantile(populations.depth(confidence, scatter, joint=joint), 1.0 - assurance, axis=0)
    logarithms = scatter.centre + scatter.spread * depth
    scale = scales(model.frequencies[:, None], model.damping_ratios[None, :])
    return np.asarray(np.stack(scale, axis=-1) * np.exp(logarithms))


_THIN = 2
_DRAWS = 112_000  # steps of all walkers of an ensemble, for 1,000 effective draws of each parameter
_FEWEST_STEPS = 800
_LONGEST = 4  # times as many steps where these were too few


@dataclass(frozen=True, kw_only=True, eq=False)
class HierarchicalFit(LearnedLimits):
    """A posterior of the hierarchical model, and what it was fitted to."""

    grid: SampleGrid  # The motions
    method: str  # Name of the method
    assurance: float | None  # Posterior probability of the promise; predictive limits by default
    model: Hierarchical  # The model with its data
    posterior: PosteriorSample  # Its draws

    def limits(self, confidence: float, *, joint: bool) -> Array:
        """Limits of every structure, shape (F, X, 2)."""
        return posterior_limits(
            self.posterior,
            self.model,
            validate_share(confidence, "confidence"),
            joint=joint,
            assurance=self.assurance,
        )

    @property
    def posterior_sample(self) -> PosteriorSample:
        """Draws of the posterior."""
        return self.posterior

    @property
    def diagnostics(self) -> Mapping[str, Any]:
        """Convergence of the run and of each parameter, ready for JSON."""
        diagnostics = self.posterior.diagnostics
        draws = self.posterior.draws
        return {
            "threshold": self.grid.threshold,
            "metric": self.grid.metric,
            "side": self.grid.side,
            "method": self.method,
            "converged": self.posterior.has_converged,
            "complaints": list(diagnostics.complaints),
            "ensembles": diagnostics.ensembles,
            "walkers": draws.shape[2],
            "steps": 2 * draws.shape[1] * self.posterior.thin,
            "thin": self.posterior.thin,
            "accepted": self.posterior.accepted,
            "parameters": [
                {str(key): _finite_or_none(value) for key, value in row.items()}
                for row in self.posterior.table().reset_index().to_dict(orient="records")
            ],
        }

    @property
    def settings(self) -> Mapping[str, Any]:
        """Law inside, and whether the posterior can be relied on."""
        diagnostics = self.posterior.diagnostics
        return {
            "curved": self.model.has_curvature,
            "converged": self.posterior.has_converged,
            "largest_r_hat": _finite_or_none(diagnostics.r_hat.max()),
            "least_effective_size": _finite_or_none(
                min(diagnostics.bulk_size.min(), diagnostics.tail_size.min())
            ),
            "longest_autocorrelation_time": _finite_or_none(diagnostics.autocorrelation_time.max()),
            "ensembles": diagnostics.ensembles,
        }

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is wrong with the posterior, and what motions lacked."""
        complaints = self.posterior.diagnostics.complaints
        unreliable = "THIS POSTERIOR HAS NOT CONVERGED and must not be relied on." if complaints else ""
        return tuple(sentence for sentence in (unreliable, *complaints, self._imputation_note) if sentence)

    @property
    def _imputation_note(self) -> str:
        values = _values(self.grid.population)
        is_known = np.asarray(np.isfinite(values).all(axis=-1)).reshape(len(values), -1)
        lacking, left_out = int((~is_known).any(axis=1).sum()), len(is_known) - len(self.model.values)
        if not lacking:
            return ""
        dropped_text = f"; {left_out} with none at all were left out" if left_out else ""
        return (
            f"{lacking} of {len(is_known)} motions have no ellipse at some structure, "
            f"{percent((~is_known).mean(), decimals=1)} of "
            f"all values; these were drawn from the model given the motion's other structures{dropped_text}."
        )


def fit_hierarchical(
    grid: SampleGrid,
    *,
    method: str,
    assurance: float | None = None,
    steps: int | None = None,
    has_curvature: bool = True,
    robust: bool = False,
    chains: Path | None = None,
    progress: Progress = silent,
) -> HierarchicalFit:
    """Sample the posterior of the hierarchical model of ellipses."""
    model = hierarchical_model(grid.population, has_curvature=has_curvature, robust=robust)
    length = steps or _steps_for(model)
    ensembles = Ensembles(steps=length, thin=_THIN, longest=0 if steps else _LONGEST * length)
    side = "" if grid.side == Side.LAG else f"_{grid.side}"
    posterior = draw(
        model,
        ensembles,
        file=chains,
        group=f"{grid.metric}_{grid.threshold:g}{side}",
        progress=progress,
    )
    return HierarchicalFit(grid=grid, method=method, assurance=assurance, model=model, posterior=posterior)


def hierarchical_model(
    population: Population, *, has_curvature: bool = True, robust: bool = False
) -> Hierarchical:
    """Make the hierarchical model of motions."""
    values = _values(population)
    is_known = np.isfinite(values)
    complete = is_known.all(axis=(1, 2, 3))
    if complete.sum() < FEWEST_MOTIONS:
        raise InputError(
            f"Too few motions with an ellipse at every structure: this method needs {FEWEST_MOTIONS}",
            value=int(complete.sum()),
            remedy="Give more motions, a smaller threshold or less damping",
        )
    model = Hierarchical(
        values=values[complete],
        events=population.events[complete],
        frequencies=population.frequencies,
        damping_ratios=population.damping_ratios,
        has_curvature=has_curvature,
        robust=robust,
    )
    partial = ~complete & is_known.any(axis=(1, 2, 3))
    return impute_missing(model, values[partial], population.events[partial])


def _values(population: Population) -> Array:
    """Ln α and ln β, shape (motions, F, X, 2)."""
    return np.stack([population.log_alpha, population.log_beta], axis=-1)


def _finite_or_none(value: object) -> object:
    """Take a number for JSON; None where too short a run has none."""
    if isinstance(value, float | np.floating):
        return float(value) if np.isfinite(value) else None
    return value


def _steps_for(model: Hierarchical) -> int:
    """So many steps that small models, with few walkers, make as many draws as large ones."""
    unit = 2 * _THIN
    return max(_FEWEST_STEPS, -(-_DRAWS // width_of(model) // unit) * unit)
