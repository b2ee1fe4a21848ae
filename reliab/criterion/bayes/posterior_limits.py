"""Limits from draws of the hierarchical model: predictive, or with an assurance."""

import numpy as np
from numpy.typing import NDArray

from reliab.criterion.bayes.hierarchical import Hierarchical
from reliab.criterion.bayes.posterior_sample import PosteriorSample
from reliab.criterion.scaling import scales

_DRAWS = 2000
_MOTIONS = 40  # for each draw, each of an earthquake of its own
_POPULATIONS = 400  # draws of the posterior whose own quantile is found ...
_POPULATION = 4000  # ... from so many motions


def posterior_limits(
    posterior: PosteriorSample,
    model: Hierarchical,
    confidence: float,
    *,
    joint: bool,
    assurance: float | None = None,
    seed: int = 2017,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Limits that the stated share of motions of further earthquakes exceeds.

    Parameters
    ----------
    posterior : PosteriorSample
        Draws of the model.
    model : Hierarchical
        The model.
    confidence : float
        Share of the motions, in (0, 1).
    joint : bool
        Whether a and b hold together: the worse of the two, each in its own spreads, stands for the motion.
    assurance : float, optional
        Posterior probability that at least that share of all motions exceeds the limits; without it the
        limits are predictive, and a further motion exceeds them with the probability `confidence`.
    seed : int, optional
        Seed of the draws of motions.

    Returns
    -------
    a, b : array of float, shape (F, X)
        Limits [-] and [ms²].
    """
    rng = np.random.default_rng(seed)
    drawn = model.draw_motions(posterior.spread_out(_DRAWS), np.arange(_MOTIONS), rng)
    motions = drawn.reshape(-1, *drawn.shape[2:])
    centre, spread = motions.mean(axis=0), motions.std(axis=0)

    def quantile(values: NDArray[np.float64]) -> NDArray[np.float64]:
        standard = (values - centre) / spread
        standing = standard.min(axis=-1, keepdims=True) if joint else standard
        return np.asarray(np.quantile(standing, 1.0 - confidence, axis=0))

    if assurance is None:
        depth = quantile(motions)
    else:
        # The quantile of a finite population scatters by itself, which makes the bound a little lower.
        each = np.arange(_POPULATION)
        populations = (
            model.draw_motions(theta[None], each, rng)[0] for theta in posterior.spread_out(_POPULATIONS)
        )
        depth = np.quantile(np.stack([quantile(one) for one in populations]), 1.0 - assurance, axis=0)
    limits = centre + spread * depth
    scale_a, scale_b = scales(model.frequencies[:, None], model.damping_ratios[None, :])
    return scale_a * np.exp(limits[..., 0]), scale_b * np.exp(limits[..., 1])
