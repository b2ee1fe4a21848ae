"""From draws of the hierarchical model to a criterion."""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from reliab.criterion.bayes.hierarchical import Hierarchical
from reliab.criterion.bayes.posterior_sample import PosteriorSample
from reliab.criterion.cautions import few_events
from reliab.criterion.criterion import Criterion
from reliab.criterion.laws import Table
from reliab.criterion.methods.method import checked_share
from reliab.criterion.population import Population
from reliab.criterion.provenance import Provenance, records_checksum
from reliab.criterion.scaling import scales

METHOD = "hierarchical"
"""What the confidence of such a criterion is called."""

_DRAWS = 2000
_MOTIONS = 40  # for each draw, each of an earthquake of its own


def hierarchical_model(
    ellipses: xr.Dataset, *, threshold: float, metric: str, curved: bool = True, robust: bool = False
) -> Hierarchical:
    """Make the hierarchical model of a dataset of ellipses.

    Parameters
    ----------
    ellipses : xarray.Dataset
        Ellipses over motions, f and ξ; motions that lack one somewhere are left out, which is on the
        safe side.
    threshold, metric
        Which error.
    curved, robust : bool, optional
        See :class:`reliab.criterion.bayes.Hierarchical`.

    Returns
    -------
    Hierarchical
        The model with its data.
    """
    population = Population.of(ellipses, threshold=threshold, metric=metric)
    values = np.stack([population.log_alpha, population.log_beta], axis=-1)
    complete = np.isfinite(values).all(axis=(1, 2, 3))
    return Hierarchical(
        values=values[complete],
        events=population.events[complete],
        frequencies=population.frequencies,
        damping_ratios=population.damping_ratios,
        curved=curved,
        robust=robust,
    )


def posterior_criterion(
    ellipses: xr.Dataset,
    posterior: PosteriorSample,
    model: Hierarchical,
    *,
    threshold: float,
    metric: str,
    confidence: float = 0.95,
    joint: bool = True,
    seed: int = 2017,
    source: str = "ellipses of ground motions",
) -> Criterion:
    """Derive a criterion from a posterior of the hierarchical model.

    Definition: given all these motions at all structures, the probability that a motion of a further
    earthquake contains the ellipse is the stated confidence, for a alone and b alone, or `joint`. The law
    with its uncertainty, events, motions and structures are all drawn anew.

    Parameters
    ----------
    ellipses : xarray.Dataset
        What the model was made of.
    posterior : PosteriorSample
        Draws of the model.
    model : Hierarchical
        The model.
    threshold, metric
        Which error.
    confidence : float, optional
        Stated probability.
    joint : bool, optional
        Whether a and b hold together.
    seed : int, optional
        Seed of the predictive draws.
    source : str, optional
        Where the ellipses came from, in words.

    Returns
    -------
    Criterion
        A table over the structures, with the diagnostics in its provenance and a warning there if the
        posterior has not converged.
    """
    depth = 1.0 - checked_share(confidence, "confidence")
    a, b = predictive_limits(posterior, model, depth, joint=joint, seed=seed)
    diagnostics = posterior.diagnostics
    events = np.unique(model.events).size
    cautions = [*diagnostics.complaints, few_events(events)]
    return Criterion(
        law=Table.fit(model.frequencies, model.damping_ratios, a, b),
        threshold=threshold,
        metric=metric,
        confidence=confidence,
        method=METHOD,
        joint=joint,
        population=Population.of(ellipses, threshold=threshold, metric=metric),
        provenance=Provenance(
            source=source,
            n_motions=len(model.values),
            n_events=events,
            records_checksum=records_checksum(ellipses),
            window=str(ellipses.attrs.get("window", "unknown")),
            settings={
                "curved": model.curved,
                "robust": model.robust,
                "converged": posterior.converged,
                "largest_r_hat": float(diagnostics.r_hat.max()),
                "least_effective_size": float(min(diagnostics.bulk_size.min(), diagnostics.tail_size.min())),
            },
            warnings=tuple(each for each in cautions if each),
        ),
    )


def predictive_limits(
    posterior: PosteriorSample, model: Hierarchical, depth: float, *, joint: bool, seed: int = 2017
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Limits that a further motion exceeds with the probability 1 − depth.

    Parameters
    ----------
    posterior : PosteriorSample
        Draws of the model.
    model : Hierarchical
        The model.
    depth : float
        Probability of falling below, in (0, 1).
    joint : bool
        Whether a and b hold together: the worse of the two, each in its own spreads, stands for the motion.
    seed : int, optional
        Seed of the predictive draws.

    Returns
    -------
    a, b : array of float, shape (F, X)
        Limits [-] and [ms²].
    """
    theta = posterior.spread_out(_DRAWS)
    drawn = model.draw_motions(theta, np.arange(_MOTIONS), np.random.default_rng(seed))
    motions = drawn.reshape(-1, *drawn.shape[2:])
    if joint:
        centre, spread = motions.mean(axis=0), motions.std(axis=0)
        worse = ((motions - centre) / spread).min(axis=-1)
        limits = centre + spread * np.quantile(worse, depth, axis=0)[..., None]
    else:
        limits = np.quantile(motions, depth, axis=0)
    scale_a, scale_b = scales(model.frequencies[:, None], model.damping_ratios[None, :])
    return scale_a * np.exp(limits[..., 0]), scale_b * np.exp(limits[..., 1])
