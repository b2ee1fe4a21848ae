"""One motion of a further earthquake at each structure: its distribution and quantiles in closed form."""

from dataclasses import dataclass
from typing import Self

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from reliab.criterion.methods.hierarchical.model import Hierarchical
from reliab.criterion.methods.hierarchical.strata import weights_of_motion, weights_of_motion_mean
from reliab.criterion.methods.joint import Scatter

_NODES = 24  # normal distributions that make up a Student's t
_WIDER = 1e-9  # of a bracket, so that rounding leaves the root inside
_TINY = 1e-300  # in place of zero, where a ratio would have no sign


@dataclass(frozen=True, kw_only=True, eq=False)
class FurtherMotions:
    """Normal ln α and ln β of one motion at each structure, or mixtures that differ in their spread."""

    mean: NDArray[np.float64]  # Means, for each vector of parameters, shape (vectors, F, X, 2)
    # Variance of ln α, variance of ln β and covariance of each part of the mixture, shape (vectors, F, X,
    # parts, 3)
    covariance: NDArray[np.float64]
    weights: NDArray[np.float64]  # Shares of the mixture, shape (parts,)

    @classmethod
    def from_draws(cls, model: Hierarchical, theta: NDArray[np.float64]) -> Self:
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
            of_mean = np.einsum("k,wkc->wc", weights_of_motion_mean(model.grid), effects)
            covariance = covariance + ((stretch[..., None] - 1.0) * of_mean[:, None])[:, None, None]
        return cls(mean=mean, covariance=covariance, weights=weights)

    def depth(self, share: float, scatter: Scatter, *, joint: bool) -> NDArray[np.float64]:
        """Standardised logarithms that a share of the motions exceeds.

        Returns (vectors, F, X, 2).
        """
        mean = scatter.standard(self.mean)[..., None, :]
        spread = np.sqrt(self.covariance[..., :2]) / scatter.spread[:, :, None]
        correlation = self.covariance[..., 2] / np.sqrt(self.covariance[..., :2].prod(axis=-1))
        if joint:
            depth = _depth(share, self.weights, mean, spread, correlation)
            return np.stack([depth, depth], axis=-1)
        alone = (slice(0, 1), slice(1, 2))
        return np.stack(
            [_depth(share, self.weights, mean[..., k], spread[..., k], correlation) for k in alone], axis=-1
        )


def _depth(
    share: float,
    weights: NDArray[np.float64],
    mean: NDArray[np.float64],
    spread: NDArray[np.float64],
    correlation: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Depth that one variable exceeds, or two together; last axes of mean and spread (parts, variables)."""
    from scipy.optimize import elementwise

    variables, shape = mean.shape[-1], correlation.shape[:-1]
    means = mean.reshape(-1, 1, variables)
    spreads, correlations = spread.reshape(-1, weights.size, variables), correlation.reshape(-1, weights.size)

    def excess(depth: NDArray[np.float64], cell: NDArray[np.float64]) -> NDArray[np.float64]:
        these = cell.astype(np.int64)
        above = np.moveaxis((means[these] - depth[:, None, None]) / spreads[these], -1, 0)
        shares = (
            scipy.special.ndtr(above[0])
            if variables == 1
            else both_below(above[0], above[1], correlations[these])
        )
        return np.asarray(shares @ weights - share)

    # One of both lies below its own quantile, and at least half of the rest is below the lower one's.
    low = (means + spreads * scipy.special.ndtri((1.0 - share) / variables)).min(axis=(1, 2))
    high = (means + spreads * scipy.special.ndtri(1.0 - share)).max(axis=1).min(axis=-1)
    root = elementwise.find_root(
        excess, (low - _WIDER, np.maximum(high, low) + _WIDER), args=(np.arange(low.size, dtype=np.float64),)
    )
    return np.asarray(root.x.reshape(shape))


def both_below(first: ArrayLike, second: ArrayLike, correlation: ArrayLike) -> NDArray[np.float64]:
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
