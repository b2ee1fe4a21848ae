"""Methods that take each structure for itself: a lower bound of one quantity over ground motions.

Here stands the one rule by which a and b hold together.
"""

from abc import abstractmethod
from dataclasses import dataclass
from pathlib import Path
from typing import Self

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.progress import Progress, silent
from reliab.criterion.ellipse_sample import EllipseSample
from reliab.criterion.methods.method import Learned, Method, checked_share
from reliab.criterion.population import SampleGrid


@dataclass(frozen=True, kw_only=True, eq=False)
class Scatter:
    """Mean and spread of ln a and ln b over motions, in which the worse of the two is found.

    The smaller of the two standardised logarithms represents the motion. A lower bound of it, carried back to
    a and b, holds for both together, and both lie equally deep in their own distributions.

    >>> pairs = np.array([[0.0, 0.0], [1.0, 4.0], [2.0, 2.0]])
    >>> scatter = Scatter.from_logarithms(pairs)
    >>> scatter.worse(pairs).round(3).tolist()
    [-1.225, 0.0, 0.0]
    >>> scatter.at(np.array(-1.0)).round(3).tolist()
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

    def at(self, depth: Array) -> Array:
        """Carry a depth of both, shape (...), back to ln a and ln b, shape (..., 2)."""
        return np.asarray(self.centre + self.spread * depth[..., None])


class BoundMethod(Method):
    """A lower bound of the logarithm of a, of b, or of the worse of the two."""

    def lower_bound(self, logarithms: Array, events: NDArray[np.str_], confidence: float) -> float:
        """Bound that the stated share of the motions exceeds.

        `logarithms`, `events` (motions,).
        Returns logarithm of the bound; minus infinity when the motions are too few for the promise.
        """
        return self._lower_bound(logarithms, events, checked_share(confidence, "confidence"))

    @abstractmethod
    def _lower_bound(self, logarithms: Array, events: NDArray[np.str_], confidence: float) -> float:
        """Bound for a checked confidence."""

    def learn(
        self, grid: SampleGrid, *, law: str, chains: Path | None = None, progress: Progress = silent
    ) -> Learned:
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
        checked_share(self.assurance, "assurance")


@dataclass(frozen=True, kw_only=True, eq=False)
class _Bounds(Learned):
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
    (:class:`~reliab.criterion.methods.bound.Scatter`).

    Returns `a, b`: the limits [-] and [ms²], finite; zero where the motions are too few for the method's
    promise (:meth:`Method.carried_confidence`).

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
    if not method.carries(checked_share(confidence, "confidence"), sample.n_motions, sample.n_events):
        return 0.0, 0.0
    logarithms = np.stack([sample.log_a, sample.log_b], axis=-1)
    if not joint:
        bounds = [method.lower_bound(values, sample.events, confidence) for values in logarithms.T]
        return float(np.exp(bounds[0])), float(np.exp(bounds[1]))
    scatter = Scatter.from_logarithms(logarithms)
    depth = method.lower_bound(scatter.worse(logarithms), sample.events, confidence)
    a, b = np.exp(scatter.at(np.asarray(depth)))
    return float(a), float(b)
