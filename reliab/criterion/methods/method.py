"""What a stated confidence can mean: the interface of every method."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, ClassVar, Self, cast

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.progress import Progress, silent
from reliab.core.vocabulary import CurveName
from reliab.criterion.population import EllipseSample, SampleGrid
from reliab.sampling.posterior_sample import PosteriorSample


class LearnedLimits(ABC):
    """What a method has learned from the motions of a grid of structures."""

    grid: SampleGrid  # The motions

    @abstractmethod
    def limits(self, confidence: float, *, joint: bool) -> Array:
        """Limits of every structure.

        Returns (F, X, 2).
        """

    @property
    def posterior_sample(self) -> PosteriorSample | None:
        """Draws of a posterior; None for a method that samples none."""
        return None

    @property
    def diagnostics(self) -> Mapping[str, Any] | None:
        """Convergence of a sampled posterior, ready for JSON; None for a method that samples none."""
        return None

    @property
    def settings(self) -> Mapping[str, Any]:
        """What was learned with, beside the method's own settings."""
        return {}

    @property
    def warnings(self) -> tuple[str, ...]:
        """Plain sentences that a user should know."""
        return ()

    def warn_unless_converged(self) -> None:
        """Warn by a `ConvergenceWarning` if a posterior cannot be relied on."""
        if self.posterior_sample is not None:
            self.posterior_sample.warn_unless_converged()


class Method(ABC):
    """What a confidence over ground motions means, and how limits follow from the motions.

    A criterion is safe when it is small: at a confidence of 95 % it is a bound that 95 % of the
    motions exceed, the paper's 5 % quantile. How this is meant is the method's definition.
    """

    name: ClassVar[str]  # How the method is called on the command line
    meaning: ClassVar[str]  # What a confidence stated by the method means, as the end of a sentence
    # Which ellipses it rests on: those inscribed in the boundaries, or the paper's, fitted to them
    curve: ClassVar[str] = CurveName.INSCRIBED
    # Whether a and b hold together unless one says otherwise; in the paper each holds for itself
    joint_by_default: ClassVar[bool] = True
    # Whether the promise needs no shape of the distribution over motions, or needs the lognormal one
    distribution_free: ClassVar[bool] = False
    lognormal: ClassVar[bool] = False
    # Whether it samples a posterior whose chains can be kept in a file
    samples_chains: ClassVar[bool] = False

    @property
    def assumes_lognormality(self) -> bool:
        """Whether the promise needs lognormal motions."""
        return self.lognormal

    @property
    def settings(self) -> dict[str, Any]:
        """Parameters of the method, ready for JSON."""
        return asdict(cast("Any", self))

    def achievable_confidence(self, n_motions: int, n_events: int) -> float:
        """Highest confidence that so many motions can support; beyond it a criterion accepts nothing.

        The lowest value under K earthquakes is exceeded with the probability K/(K + 1), whatever the
        distribution. Beyond that a fitted distribution has to describe the tail. It does so down to an
        exceedance of
        about (2/(K + 1))²: in simulations with normal, skewed and heavy-tailed motions (one to three from
        each earthquake, a and b together) the true exceedance there is about 1.1 to 2.5 times the stated
        one, and the ratio grows further beyond it. One earthquake supports no confidence, since it does not
        show how earthquakes differ.

        >>> from reliab.criterion.methods.dirichlet import Dirichlet
        >>> [round(Dirichlet().achievable_confidence(3 * events, events), 3) for events in (1, 3, 8, 19)]
        [0.0, 0.75, 0.951, 0.99]
        """
        del n_motions
        return 1.0 - (2.0 / (n_events + 1.0)) ** 2

    def carries(self, confidence: float, n_motions: int, n_events: int) -> bool:
        """Whether so many motions and earthquakes support a confidence."""
        return confidence <= self.achievable_confidence(n_motions, n_events) * (1.0 + 1e-12)

    def mean_share(self, confidence: float, n_motions: int) -> float:
        """Share of further motions that really exceed the bound, on average, where it falls short by design.

        Returns the stated share, for every method that allows for how few motions there are.
        """
        del n_motions
        return confidence

    @abstractmethod
    def learn(
        self, grid: SampleGrid, *, law: str, chains: Path | None = None, progress: Progress = silent
    ) -> LearnedLimits:
        """Learn from the motions of a grid of structures."""


def validate_share(share: float, name: str) -> float:
    """Return a share between 0 and 1 (both excluded), or say what is wrong with it."""
    if not 0.0 < share < 1.0:
        raise InputError(
            f"The {name} must lie between 0 and 1",
            value=share,
            remedy="Give a fraction, 0.95 for 95 %",
        )
    return float(share)


@dataclass(frozen=True, kw_only=True, eq=False)
class Scatter:
    """Mean and spread of ln a and ln b over motions, in which the worse of the two is found.

    The smaller of the two standardised logarithms represents the motion. A lower bound of it, carried back to
    a and b, holds for both together, and both lie equally deep in their own distributions.

    >>> pairs = np.array([[0.0, 0.0], [1.0, 4.0], [2.0, 2.0]])
    >>> scatter = Scatter.from_logarithms(pairs)
    >>> scatter.worse(pairs).round(3).tolist()
    [-1.225, 0.0, 0.0]
    >>> scatter.limits_at_depth(np.array(-1.0)).round(3).tolist()
    [0.184, 0.367]
    """

    # centre, spread: Mean and standard deviation over the motions, shape (..., 2)
    centre: Array
    spread: Array

    @classmethod
    def from_logarithms(cls, logarithms: Array) -> Self:
        """Take mean and spread of ln a and ln b over motions, shape (motions, ..., 2)."""
        return cls(centre=logarithms.mean(axis=0), spread=logarithms.std(axis=0))

    def standard(self, logarithms: Array) -> Array:
        """Standardise ln a and ln b, shape (motions, ..., 2)."""
        return np.asarray((logarithms - self.centre) / self.spread)

    def worse(self, logarithms: Array) -> Array:
        """Take the smaller of the two standardised logarithms, shape (motions, ...)."""
        return np.asarray(self.standard(logarithms).min(axis=-1))

    def limits_at_depth(self, depth: Array) -> Array:
        """Carry a depth of both, shape (...), back to ln a and ln b, shape (..., 2)."""
        return np.asarray(self.centre + self.spread * depth[..., None])


class BoundMethod(Method):
    """A lower bound of the logarithm of a, of b, or of the worse of the two."""

    def lower_bound(self, logarithms: Array, events: NDArray[np.str_], confidence: float) -> float:
        """Bound that the stated share of the motions exceeds.

        `logarithms`, `events` (motions,).
        Returns logarithm of the bound; minus infinity when the motions are too few for the promise.
        """
        return self._lower_bound(logarithms, events, validate_share(confidence, "confidence"))

    @abstractmethod
    def _lower_bound(self, logarithms: Array, events: NDArray[np.str_], confidence: float) -> float:
        """Bound for a checked confidence."""

    def learn(
        self, grid: SampleGrid, *, law: str, chains: Path | None = None, progress: Progress = silent
    ) -> LearnedLimits:
        """Take the motions as they are; see :meth:`Method.learn`."""
        del law, progress
        if chains is not None:
            raise InputError(
                "Only the hierarchical methods have chains",
                value=f"chains for {self.name}",
                remedy="Leave them out, or choose a hierarchical method",
            )
        return _Bounds(method=self, grid=grid)


@dataclass(frozen=True, kw_only=True)
class AssuredBound(BoundMethod):
    """A lower bound that keeps its promise with a stated assurance."""

    # Share of suites, or posterior probability, with which the promise is kept; in (0, 1)
    assurance: float = 0.95

    def __post_init__(self) -> None:
        validate_share(self.assurance, "assurance")


@dataclass(frozen=True, kw_only=True, eq=False)
class _Bounds(LearnedLimits):
    method: BoundMethod
    grid: SampleGrid

    def limits(self, confidence: float, *, joint: bool) -> Array:
        """Limits of every structure, shape (F, X, 2)."""
        return np.array(
            [
                [limits(sample, self.method, confidence, joint=joint) for sample in row]
                for row in self.grid.samples
            ]
        )


def limits(
    sample: EllipseSample, method: BoundMethod, confidence: float, *, joint: bool = False
) -> tuple[float, float]:
    """Derive limits a and b at a confidence from the motions of one structure.

    Each for itself, as in the paper, a share `confidence` of the motions has a larger a, and the same
    share, but not the same motions, a larger b. *Jointly*, the share holds for both together
    (:class:`~reliab.criterion.methods.method.Scatter`).

    Returns `a, b`: the limits [-] and [ms²], finite; zero where the motions are too few for the method's
    promise (:meth:`Method.achievable_confidence`).

    >>> from reliab.criterion.methods.quantile import Quantile
    >>> logarithms = np.random.default_rng(1).multivariate_normal([0, 0], [[1.0, 0.5], [0.5, 1.0]], 5000)
    >>> a, b = np.exp(logarithms.T)
    >>> names = np.arange(5000).astype(str)
    >>> sample = EllipseSample(
    ...     a=a, b=b, motions=names, events=names,
    ...     frequency=1.0, damping_ratio=0.02, threshold=0.05, metric="rms",
    ... )
    >>> for joint in (False, True):
    ...     least_a, least_b = limits(sample, Quantile(), 0.9, joint=joint)
    ...     print(round(float(((a >= least_a) & (b >= least_b)).mean()), 2))
    0.84
    0.91
    """
    if not method.carries(validate_share(confidence, "confidence"), sample.n_motions, sample.n_events):
        return 0.0, 0.0
    logarithms = np.stack([sample.log_a, sample.log_b], axis=-1)
    if not joint:
        bounds = [method.lower_bound(values, sample.events, confidence) for values in logarithms.T]
        return float(np.exp(bounds[0])), float(np.exp(bounds[1]))
    scatter = Scatter.from_logarithms(logarithms)
    depth = method.lower_bound(scatter.worse(logarithms), sample.events, confidence)
    a, b = np.exp(scatter.limits_at_depth(np.asarray(depth)))
    return float(a), float(b)
