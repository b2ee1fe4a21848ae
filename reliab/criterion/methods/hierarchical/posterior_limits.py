"""Limits from draws of the hierarchical model: predictive, or with an assurance."""

import numpy as np
from numpy.typing import NDArray

from reliab.criterion.methods.hierarchical.further_motions import FurtherMotions
from reliab.criterion.methods.hierarchical.model import Hierarchical
from reliab.criterion.methods.joint import Scatter
from reliab.criterion.scaling import scales
from reliab.sampling import PosteriorSample

_DRAWS = 2000
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
) -> NDArray[np.float64]:
    """Limits that the stated share of motions of further earthquakes exceeds.

    Returns (F, X, 2).
    """
    rng = np.random.default_rng(seed)
    drawn = model.draw_motions(posterior.spread_out(_DRAWS), np.arange(_MOTIONS), rng)
    motions = drawn.reshape(-1, *drawn.shape[2:])
    scatter = Scatter.of(motions)

    if assurance is None:
        standing = scatter.worse(motions)[..., None] if joint else scatter.standard(motions)
        depth = np.quantile(standing, 1.0 - confidence, axis=0)
    else:
        every = FurtherMotions.of(model, posterior.spread_out(_POPULATIONS))
        depth = np.quantile(every.depth(confidence, scatter, joint=joint), 1.0 - assurance, axis=0)
    logarithms = scatter.centre + scatter.spread * depth
    scale = scales(model.frequencies[:, None], model.damping_ratios[None, :])
    return np.asarray(np.stack(scale, axis=-1) * np.exp(logarithms))
